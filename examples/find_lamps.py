# SPDX-License-Identifier: MIT
"""Finds where two lamps hang, and how rough the floor is, from what a camera measured of the floor.

usage: python examples/find_lamps.py      (pip install scipy)

The measured values are made here from lamps that the search does not know, with one per cent of noise. The search is
scipy.optimize.least_squares with the exact derivatives of `shade_spheres(..., gradient=True)`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

import shlight
from shlight import Bsdf

Array = npt.NDArray[np.float64]
EYE = np.array([0.0, -3.0, 1.5])
RADIUS = 0.15
RADIANCE = 40.0
LAMPS = np.array([[-0.8, 0.4, 1.1], [0.7, 0.9, 1.6]])
ROUGHNESS = 0.45


def floor_points() -> Array:
    x, y = np.meshgrid(np.linspace(-1.5, 1.5, 16), np.linspace(-1.5, 2.5, 20))
    return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)


def floor_radiance(points: Array, lamps: Array, roughness: float) -> tuple[Array, Array]:
    """The radiance of points of the floor towards the eye, and its derivatives by the numbers of `unknowns`."""
    to_eye = EYE - points
    cosines = to_eye[:, 2] / np.linalg.norm(to_eye, axis=1)
    azimuths = np.arctan2(to_eye[:, 1], to_eye[:, 0])
    floor = Bsdf.ggx(roughness, 0.3) + Bsdf.lambert(0.2)
    centers = lamps - points[:, None]  # (points, lamps, 3): each point is the origin of its own frame
    seen, by = shlight.shade_spheres(
        centers, RADIUS, floor, cosines[:, None], phi_o=azimuths[:, None], tolerance=1e-6, gradient=True
    )
    by_lamps = by.center[..., 0, :].reshape(len(points), -1)
    by_roughness = by.roughness[..., 0].sum(axis=1)
    return RADIANCE * seen[..., 0].astype(np.float64).sum(axis=1), RADIANCE * np.column_stack([by_lamps, by_roughness])


def unknowns(lamps: Array, roughness: float) -> Array:
    return np.append(lamps.ravel(), roughness)


def find(points: Array, measured: Array, start: Array) -> Any:
    """scipy's result; its x is as `unknowns` makes it."""

    def radiance(x: Array) -> tuple[Array, Array]:
        return floor_radiance(points, x[:-1].reshape(-1, 3), float(x[-1]))

    highest = np.full(start.size, np.inf)
    lowest = -highest
    lowest[2:-1:3] = 2 * RADIUS  # lamps hang above the floor
    lowest[-1], highest[-1] = 0.05, 1.0
    return least_squares(
        lambda x: radiance(x)[0] - measured,
        start,
        jac=lambda x: radiance(x)[1],
        bounds=(lowest, highest),
        x_scale="jac",
    )


def main() -> None:
    points = floor_points()
    exact = floor_radiance(points, LAMPS, ROUGHNESS)[0]
    measured = exact * (1 + 0.01 * np.random.default_rng(1).normal(size=exact.shape))
    result = find(points, measured, unknowns(np.array([[-0.3, 0.0, 1.5], [0.3, 0.3, 1.5]]), 0.7))
    for lamp, found in zip(LAMPS, result.x[:-1].reshape(-1, 3), strict=True):
        print(f"lamp at {lamp}, found at {found.round(3)}")
    print(f"roughness {ROUGHNESS}, found {result.x[-1]:.3f}, in {result.nfev} steps")


if __name__ == "__main__":
    main()
