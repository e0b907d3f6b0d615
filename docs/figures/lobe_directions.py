# SPDX-License-Identifier: MIT
"""Finds the directions of tools/methods/lobe_directions.cpp; prints them and the condition number of each band.

Band l of the zonal factorization takes the first 2l + 1 directions ω_d. The squares of the singular values of its
matrix Y_lm(ω_d) are, but for a factor, the eigenvalues of the matrix of all P_l(ω_d·ω_e). What is made small is the
sum over the bands of log(largest eigenvalue / smallest) / (l+1): low bands count more, as every order needs them. The
sum is smoothed by powers that grow from stage to stage, and the set grows by two bands at a time: all of it may move
after each, and the best of several random continuations is kept.

    python docs/figures/lobe_directions.py [--seed 0]

takes about two minutes on one core. The seed fixes the random numbers; the last bits of the linear algebra still differ
from library to library, and with them the minimum that is found.
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[Any]

GROWTH = range(2, 33, 2)  # bands
CONTINUATIONS = 12
DESCENT = ((1, 200), (4, 150))  # power of the smoothing, steps
LAST = ((16, 300),)


def weights(bands: int) -> Array:
    return 1 / np.arange(1, bands + 1)


def legendre(x: Array, bands: int) -> tuple[list[Array], list[Array]]:
    """P_l(x) and P_l'(x)."""
    value, slope = [np.ones_like(x), x], [np.zeros_like(x), np.ones_like(x)]
    for n in range(2, bands):
        value.append(((2 * n - 1) * x * value[-1] - (n - 1) * value[-2]) / n)
        slope.append((2 * n - 1) * value[n - 1] + slope[n - 2])
    return value, slope


def unit(flat: Array) -> tuple[Array, Array]:
    vectors = flat.reshape(-1, 3)
    lengths = np.linalg.norm(vectors, axis=1)[:, None]
    return vectors / lengths, lengths


def conditions(directions: Array) -> Array:
    """σ_max / σ_min of each band."""
    value, _ = legendre(np.clip(directions @ directions.T, -1, 1), (len(directions) + 1) // 2)
    spectra = [np.linalg.eigvalsh(v[: 2 * n + 1, : 2 * n + 1]) for n, v in enumerate(value)]
    return np.sqrt([s[-1] / s[0] for s in spectra])


def smoothed_spread(eigenvalues: Array, power: int) -> tuple[float, Array]:
    """log(largest / smallest), from above, and its derivatives."""
    w = np.maximum(eigenvalues, 1e-14)
    low, high = (w / w[0]) ** -power, (w / w[-1]) ** power
    spread = np.log(low.sum() * high.sum()) / power + np.log(w[-1] / w[0])
    return float(spread), (high / high.sum() - low / low.sum()) / w


def objective(flat: Array, bands: int, power: int) -> tuple[float, Array]:
    """The weighted sum over bands, and its gradient by the directions."""
    d, lengths = unit(flat)
    value, slope = legendre(d @ d.T, bands)
    total, gradient = 0.0, np.zeros_like(d)
    for band, weight in enumerate(weights(bands)):
        k = 2 * band + 1
        eigenvalues, vectors = np.linalg.eigh(value[band][:k, :k])
        spread, by_eigenvalue = smoothed_spread(eigenvalues, power)
        by_cosine = (vectors * by_eigenvalue) @ vectors.T * slope[band][:k, :k]
        np.fill_diagonal(by_cosine, 0)
        total += weight * spread
        gradient[:k] += 2 * weight * by_cosine @ d[:k]
    gradient -= np.sum(gradient * d, axis=1)[:, None] * d
    return total, (gradient / lengths).ravel()


def descend(directions: Array, stages: tuple[tuple[int, int], ...]) -> tuple[float, Array]:
    """The weighted logarithms of the condition numbers, and the directions."""
    bands = (len(directions) + 1) // 2
    for power, steps in stages:
        options = {"maxiter": steps, "maxcor": 30}
        found = minimize(objective, directions.ravel(), (bands, power), method="L-BFGS-B", jac=True, options=options)
        directions, _ = unit(found.x)
    return float(weights(bands) @ np.log(conditions(directions))), directions


def search(seed: int) -> Array:
    rng = np.random.default_rng(seed)
    start = time.process_time()
    directions = np.zeros((0, 3))
    for bands in GROWTH:
        missing = 2 * bands - 1 - len(directions)
        tried = [descend(np.vstack([directions, rng.normal(size=(missing, 3))]), DESCENT) for _ in range(CONTINUATIONS)]
        cost, directions = min(tried, key=lambda one: one[0])
        print(f"{bands} bands: {cost:.3f} after {time.process_time() - start:.0f} s", file=sys.stderr, flush=True)
    return descend(directions, LAST)[1]


def main() -> None:
    parser = argparse.ArgumentParser(description="Find lobe directions with small condition numbers.")
    parser.add_argument("--seed", type=int, default=0)
    directions = search(parser.parse_args().seed)
    for x, y, z in directions:
        print(f"        {{{x:.17g}, {y:.17g}, {z:.17g}}},")
    for band, condition in enumerate(conditions(directions)):
        print(f"// band {band}: {condition:.2f}")


if __name__ == "__main__":
    main()
