# SPDX-License-Identifier: MIT
"""shade_disks: against coefficients of the disk itself, and against cubature of f·cos over it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from lobe_cubature import reflected
from strategies import Floats

import shlight

# Centre and half axes: overhead, tilted, cut by the horizon, long, small, close.
DISKS = np.array(
    [
        [(0.2, -0.1, 1.5), (0.6, 0.0, 0.0), (0.0, 0.6, 0.0)],
        [(-1.0, 0.4, 0.9), (0.5, 0.1, 0.3), (-0.2, 0.7, 0.1)],
        [(-1.2, 0.3, 0.2), (0.1, 0.5, 0.4), (0.2, -0.4, 0.7)],
        [(-0.5, 1.0, 0.8), (1.5, 0.2, 0.1), (0.0, 0.05, 0.2)],
        [(-2.0, 0.1, 2.2), (0.1, 0.0, 0.05), (0.0, 0.07, 0.0)],
        [(0.3, 0.2, 0.3), (1.0, 0.0, 0.1), (0.0, 0.8, 0.0)],
    ]
)


def over_disk(bsdf: shlight.Bsdf, cosine: float, disk: Floats) -> Floats:
    """Gauss rules in the square of the radius, in panels, and trapezoids around."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    panels = 10
    squares = np.concatenate([(i + (nodes + 1) / 2) / panels for i in range(panels)])
    turns = 2 * math.pi * (np.arange(1200) + 0.5) / 1200
    radius = np.sqrt(squares)[:, None, None]
    center, u, v = disk
    points = center + radius * (np.cos(turns)[:, None] * u + np.sin(turns)[:, None] * v)
    distance = np.linalg.norm(points, axis=-1)
    area = np.cross(u, v)
    solid = math.pi * np.abs(points @ area) / distance**3 * np.tile(weights / 2 / panels, panels)[:, None] / 1200
    solid[points[..., 2] <= 0] = 0
    directions = points / distance[..., None]
    directions[..., 2] = np.maximum(directions[..., 2], 1e-12)
    return reflected(bsdf, cosine, directions, solid)


def shaded(disks: Floats, bsdf: shlight.Bsdf, cosine: Any, **options: Any) -> Any:
    return shlight.shade_disks(disks[..., 0, :], disks[..., 1, :], disks[..., 2, :], bsdf, cosine, **options)


@pytest.mark.parametrize("order", [4, 16])
def test_lambert_is_the_contracted_coefficients(order: int) -> None:
    bsdf = shlight.Bsdf.lambert((0.2, 0.5, 0.8))
    light = shlight.disk_coefficients(DISKS[:, 0], DISKS[:, 1], DISKS[:, 2], order=order)
    expected = shlight.contract(light[:, None, :], bsdf.coefficients(0.7, order))
    found = shaded(DISKS, bsdf, 0.7, order=order)
    assert (np.abs(found - expected) <= 1e-4 * light[:, :1] / math.sqrt(4 * math.pi)).all()


@pytest.mark.parametrize("cosine", [0.3, 0.8])
@pytest.mark.parametrize("roughness", [0.3, 0.5, 0.9])
def test_glossy_lobes_match_cubature_over_the_disk(roughness: float, cosine: float) -> None:
    bsdf = shlight.Bsdf.ggx(roughness, 1.0)
    expected = np.array([over_disk(bsdf, cosine, disk) for disk in DISKS])
    found = shaded(DISKS, bsdf, cosine, tolerance=3e-4)
    assert (np.abs(found - expected) <= 1e-3).all()


@pytest.mark.parametrize("cosine", [0.5, 1.0])
def test_mirrors_show_disks(cosine: float) -> None:
    mirror = shlight.Bsdf.ggx(0, 1.0)
    way = np.array([-math.sqrt(1 - cosine * cosine), 0.0, cosine])
    u, v = np.array([0.0, 0.3, 0.0]), np.array([0.2, 0.0, 0.1])
    rim = np.array([0.99, 1.01])[:, None] * u  # the mirrored ray passes so far from the centre
    found = shlight.shade_disks(2 * way + rim, u, v, mirror, cosine)
    np.testing.assert_array_equal(found, [[1, 1, 1], [0, 0, 0]])
