# SPDX-License-Identifier: MIT
"""Textures of cells beside the points that their hash gives, among which scipy looks for the nearest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from shlight import nodes
from shlight.nodes.inputs import SOURCES
from shlight.nodes.program import ProgramBuilder
from shlight.nodes.values import Value

COUNT, SIDE = 2000, 5


def evaluated(values: list[Value], positions: Any) -> Any:
    """Values (n, lanes) of a program at positions (lanes, 3)."""
    builder = ProgramBuilder()
    builder.result(values)
    inputs = [((SOURCES["position"], 0, i), np.tile(positions[:, i], (3, 1))) for i in range(3)]
    return builder.program().evaluate(inputs, len(positions))


def pcg(cells: Any) -> Any:
    """Three numbers 0 … 1 of integers (n, 3): Jarzynski & Olano 2020, with the sign bit shifted in and left out."""
    v = (cells.astype(np.int64) * 1664525 + 1013904223).astype(np.int32)
    for is_first in (True, False):
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            v[:, i] += v[:, j] * v[:, k]
        v = v ^ (v >> 16) if is_first else v & 0x7FFFFFFF
    return v / 2.0**31


def test_the_nearest_points_in_space() -> None:
    positions = np.random.default_rng(5).uniform(-SIDE, SIDE, (COUNT, 3)).astype(np.float32)
    cells = np.stack(np.meshgrid(*[np.arange(-SIDE - 3, SIDE + 3)] * 3), axis=-1).reshape(-1, 3)
    points = cells + 0.8 * pcg(cells)
    distances, indices = cKDTree(points).query(positions.astype(np.float64), 2)
    found = [nodes.voronoi(nodes.position(), scale=1.0, feature=f, randomness=0.8) for f in ("f1", "f2")]
    for i, own in enumerate(found):
        distance, *rest = evaluated([own.distance, *own.color, *own.position], positions)
        # Only the cells around a place are searched: a point beyond these is farther away than 1.
        searched = distances[:, i] < 1
        assert searched.mean() >= 0.9
        colors, places = np.array(rest[:3]).T, np.array(rest[3:]).T
        np.testing.assert_allclose(distance[searched], distances[searched, i], atol=2e-6)
        np.testing.assert_allclose(places[searched], points[indices[searched, i]], atol=2e-6)
        np.testing.assert_allclose(colors[searched], pcg(cells[indices[searched, i]]), atol=1e-6)


def test_octaves_sum_up() -> None:
    positions = np.random.default_rng(6).uniform(-SIDE, SIDE, (100, 3)).astype(np.float32)
    # A detail of 1.25 adds a whole octave to the first, and a quarter of another.
    whole = nodes.voronoi(nodes.position(), scale=1.0, detail=1.25, roughness=0.5, lacunarity=2.0)
    parts = [nodes.voronoi(nodes.position() * size, scale=1.0) for size in (1.0, 2.0, 4.0)]
    own, *octaves = evaluated([whole.distance, *(part.distance for part in parts)], positions)
    np.testing.assert_allclose(own, np.array((1.0, 0.5, 0.25 * 0.25)) @ octaves, rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "value"), [("feature", "f3"), ("metric", "taxi"), ("dimensions", 5), ("definition", 2), ("scale", np.nan)]
)
def test_refused(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"^{name} must"):
        nodes.voronoi(nodes.position(), **{name: value})
