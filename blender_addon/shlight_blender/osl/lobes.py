# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of shlight_direct.osl: GGX's coefficients over roughness and view, as the core fits them.

In the boosted frame of docs/theory.md, 6.1 and 6.2, each degree m is a least-squares fit in the height (38).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

import shlight
from shlight.nodes import energy

ORDER = 8
WIDTHS, VIEWS = 32, 32
LEAST_ALPHA, LEAST_COSINE = 1e-3, 0.02
ALPHA_OFFSET = 0.02  # widths are equally spaced in log(α + this), and views in artanh(sinθ)
FIRST_WIDTH = np.log(LEAST_ALPHA + ALPHA_OFFSET)
WIDTH_STEP = (np.log(1.0 + ALPHA_OFFSET) - FIRST_WIDTH) / (WIDTHS - 1)
VIEW_STEP = np.arccosh(1.0 / LEAST_COSINE) / (VIEWS - 1)
RIDGE = 1e-7
NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)  # of heights
AZIMUTHS = np.pi * (np.arange(48) + 0.5) / 48  # over half a turn

Array = NDArray[np.float64]


def parameters() -> str:
    """The text of lobes.h: the shader's parameters that are tables, and the places of their nodes."""
    numbers = {
        "WIDTHS": WIDTHS,
        "VIEWS": VIEWS,
        "LEAST_ALPHA": LEAST_ALPHA,
        "LEAST_COSINE": LEAST_COSINE,
        "FIRST_WIDTH": FIRST_WIDTH,
        "WIDTH_STEP": WIDTH_STEP,
        "VIEW_STEP": VIEW_STEP,
    }
    alphas = np.exp(FIRST_WIDTH + WIDTH_STEP * np.arange(WIDTHS)) - ALPHA_OFFSET
    cosines = 1.0 / np.cosh(VIEW_STEP * np.arange(VIEWS))
    table = [number for alpha in alphas for cosine in cosines for number in ggx_terms(alpha, min(cosine, 1.0))]
    defined = "".join(f"#define {name} {number:.9g}\n" for name, number in numbers.items())
    known = energy.tables()
    bounces = (_parameter(name, known[name].values.ravel()) for name in ("albedo", "mean_albedo"))
    return "".join((defined, _parameter("table", table), *bounces))


def _parameter(name: str, numbers: Iterable[float]) -> str:
    written = [f"{number:.7g}" for number in numbers]
    return f"float {name}[{len(written)}] = {{{','.join(written)}}},\n"


def ggx_terms(alpha: float, cosine: float) -> list[float]:
    """Coefficients of f·cos dω/du of a white GGX lobe, l(l+1)/2 + m, at a view."""
    # The boost (36), (37).
    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    wide = 5.0 * alpha * cosine**0.4
    narrowness = wide / (1.0 + wide**1.5) ** (2.0 / 3.0)
    r = 1.0 - narrowness
    speed, rest = 2.0 * r / (1.0 + r * r), narrowness**2 / (1.0 + r * r)
    gamma = (1.0 + r * r) / (narrowness * (1.0 + r))
    turn = np.array([sine, gamma * cosine]) / np.hypot(sine, gamma * cosine)
    horizon = -speed * turn[1]
    # Directions u above the horizon, and what they are before the boost (34).
    height = horizon + (1.0 - horizon) * 0.5 * (NODES + 1.0)
    weights = (1.0 - horizon) * np.pi * WEIGHTS
    width = np.sqrt((1.0 - height) * (1.0 + height))
    x, y = np.multiply.outer(width, np.cos(AZIMUTHS)), np.multiply.outer(width, np.sin(AZIMUTHS))
    z = height[:, None]
    above = 0.5 * ((x - turn[0]) ** 2 + y**2 + (z + turn[1]) ** 2)
    weight = rest + speed * above
    along, side, y = (above - rest) / weight, (turn[1] * x + turn[0] * z) / (gamma * weight), y / (gamma * weight)
    directions = np.stack([cosine * side - sine * along, y, sine * side + cosine * along], axis=-1)
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    lobe = shlight.Bsdf.ggx(float(np.sqrt(alpha)), 1.0).evaluate(directions, [sine, 0.0, cosine])
    density = lobe / (gamma * weight) ** 2

    terms = np.empty(ORDER * (ORDER + 1) // 2)
    for m, rows in enumerate(_legendre(height, width)):
        wave = (density * np.cos(m * AZIMUTHS)).mean(axis=1) * (np.sqrt(2.0) if m else 1.0)
        gram = (rows * weights) @ rows.T + RIDGE * np.eye(len(rows))
        bands = np.arange(m, ORDER)
        terms[bands * (bands + 1) // 2 + m] = np.linalg.solve(gram, rows @ (weights * wave))
    return list(terms)


def _legendre(z: Array, sine: Array) -> list[Array]:
    """For each degree m the normalised functions of the bands m … ORDER-1."""
    sectoral, made = np.full_like(z, np.sqrt(0.25 / np.pi)), []
    for m in range(ORDER):
        if m:
            sectoral = sectoral * sine * np.sqrt((2 * m + 1) / (2 * m))
        rows, before = [sectoral], np.zeros_like(z)
        for l in range(m + 1, ORDER):  # noqa: E741  the field's letter for a band
            factor = np.sqrt((4 * l * l - 1) / (l * l - m * m))
            less = np.sqrt(((l - 1) ** 2 - m * m) / (4 * (l - 1) ** 2 - 1))
            rows.append(factor * (z * rows[-1] - less * before))
            before = rows[-2]
        made.append(np.array(rows))
    return made
