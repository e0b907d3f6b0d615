# SPDX-License-Identifier: MIT
"""Lights whose light differs by direction as a table has it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from test_scene_lights import radiance_at_origin

from shlight.nodes.photometric import WATTS_PER_CANDELA, luminaire

Array = NDArray[np.float64]
HEIGHT, WIDTH = 128, 256


def factor(direction: Array) -> Array:
    """The factor of unit vectors (..., 3) differs along all axes."""
    x, y, z = np.moveaxis(direction, -1, 0)
    return np.asarray(1.2 + 0.5 * x - 0.4 * y + 0.6 * x * z + 0.3 * z**2)


def table() -> Array:
    down = np.pi * (np.arange(HEIGHT) + 0.5)[:, None] / HEIGHT
    around = np.pi - 2 * np.pi * (np.arange(WIDTH) + 0.5) / WIDTH
    z, s = np.broadcast_to(np.cos(down), (HEIGHT, WIDTH)), np.sin(down)
    return factor(np.stack([s * np.cos(around), s * np.sin(around), z], axis=-1))


def turned(angle: float) -> Array:
    """A frame that is turned about x and moved, so that its origin lies at (0.6, -0.4, 1.5)."""
    made = np.eye(4)
    c, s = math.cos(angle), math.sin(angle)
    made[1:3, 1:3] = [[c, -s], [s, c]]
    made[:3, 3] = (0.6, -0.4, 1.5)
    return made


def test_a_point_light_in_its_turned_frame() -> None:
    frame = turned(0.7)

    def add(scene: Any) -> None:
        light = scene.add_point_light((0, 0, 0), (1, 2, 3), profile=table())
        light.to_world = frame

    way = -frame[:3, 3]
    square = float(way @ way)
    own = factor(frame[:3, :3].T @ way / math.sqrt(square))
    expected = own * np.array([1, 2, 3]) * 1.5 / square**1.5 / math.pi
    np.testing.assert_allclose(radiance_at_origin(add), expected, rtol=2e-4)


def test_a_wide_sphere_light() -> None:
    """Against the integral over its cap of directions."""
    center, radius = np.array([0.5, -0.3, 1.5]), 0.8
    distance = float(np.linalg.norm(center))
    axis = center / distance
    count = 400
    least = math.sqrt(1 - (radius / distance) ** 2)
    cosine = 1 - (1 - least) * (np.arange(count) + 0.5) / count
    phi = 2 * np.pi * (np.arange(count) + 0.5) / count
    x = np.cross(axis, (1, 0, 0)) / np.linalg.norm(np.cross(axis, (1, 0, 0)))
    ring = np.cos(phi)[:, None] * x + np.sin(phi)[:, None] * np.cross(axis, x)
    ways = cosine[:, None, None] * axis + np.sqrt(1 - cosine**2)[:, None, None] * ring
    lit = (factor(-ways) * ways[..., 2]).mean() * 2 * math.pi * (1 - least) / math.pi
    found = radiance_at_origin(lambda scene: scene.add_sphere_light(center, radius, 1.0, profile=table()))
    np.testing.assert_allclose(found, lit, rtol=1e-3)


def test_a_spot_light_has_both_factors() -> None:
    def value(**options: Any) -> float:
        def add(scene: Any) -> None:
            scene.add_spot_light((0.2, 0, 2), (0, 0, -1), 1.0, 0.9, 1.0, **options)

        return float(radiance_at_origin(add)[0])

    way = np.array([-0.2, 0, -2]) / math.hypot(0.2, 2)
    assert value(profile=table()) / value() == pytest.approx(float(factor(way)), rel=2e-4)


@pytest.mark.parametrize("profile", [np.ones(4), np.ones((0, 4)), -np.ones((2, 4)), np.zeros((2, 2)), [[math.nan]]])
def test_profiles_that_are_refused(profile: Any) -> None:
    with pytest.raises(ValueError, match="profile"):
        radiance_at_origin(lambda scene: scene.add_point_light((0, 0, 1), 1.0, profile=profile))


@pytest.mark.parametrize(
    "text", ["", "TILT=NONE\n1", "\nTILT=NONE\n1 2 x", "\nTILT=NONE\n1 1 1 2 1 9 1 0 0 0 1 1 1 0 90 0 1 1", 3]
)
def test_files_that_are_refused(text: Any) -> None:
    with pytest.raises(ValueError, match="text"):
        luminaire(text)


def test_a_file_as_the_standard_has_it() -> None:
    own = luminaire("IESNA91\nTILT=NONE\n1 -1 2 3 1 1 2 0 0 0 0.5 3 1\n0 45 90\n0\n10, 20, 30\n")
    assert own.heights.tolist() == [0, 45, 90]
    assert own.turns.tolist() == [0, 360]
    np.testing.assert_allclose(own.watts, [2 * 0.5 * 3 * WATTS_PER_CANDELA * np.array([10, 20, 30])] * 2)
