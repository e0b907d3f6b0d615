# SPDX-License-Identifier: MIT
"""The lights of shlight.Scene from Python: closed forms in one pixel, and arguments that are turned down."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scene_cases import FACES, FLOOR

import shlight


def radiance_at_origin(add: Callable[[shlight.Scene], None]) -> Any:
    """The radiance of a white Lambert floor z = 0 at its middle."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, bsdf=shlight.Bsdf.lambert(1))
    add(scene)
    to_world = np.eye(4)
    to_world[2, 3] = 20
    scene.set_camera(to_world, 1e-4)
    return shlight.render(scene, 1, 1, pixel_samples=1, max_bounces=0)[0, 0, :3]


def test_point_light() -> None:
    image = radiance_at_origin(lambda scene: scene.add_point_light((0, 3, 4), (25, 50, 5)))
    np.testing.assert_allclose(image, np.array([1, 2, 0.2]) * 0.8 / math.pi, rtol=2e-6)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 0.01, 0.6, 1.0])
def test_sun_light_travels_along_its_direction(angle: float) -> None:
    image = radiance_at_origin(lambda scene: scene.add_sun_light((0, -6, -8), angle, (1, 2, 3)))
    np.testing.assert_allclose(image, np.array([1, 2, 3]) * 0.8 / math.pi, rtol=2e-5)
    assert not radiance_at_origin(lambda scene: scene.add_sun_light((0, 0, 1), angle, (1, 2, 3))).any()


@pytest.mark.parametrize("radius", [0.0, 0.01])
def test_spot_light_by_direction_and_by_axes(radius: float) -> None:
    def add(direction: Any) -> Callable[[shlight.Scene], None]:
        return lambda scene: scene.add_spot_light((0, 0, 2), direction, 1.0, 0.5, (4, 8, 12), radius=radius)

    z = (1 / math.cos(math.atan(0.2)) ** 2) ** -0.5  # cosine to the axis (0.2, 0, -1)
    t = min(1.0, (z - math.cos(0.5)) / ((1 - math.cos(0.5)) * 0.5))
    expected = np.array([1, 2, 3]) / math.pi * t * t * (3 - 2 * t)
    np.testing.assert_allclose(radiance_at_origin(add((0.2, 0, -1))), expected, rtol=1e-3)
    axes = np.array([[1, 0, 0.2], [0, 1, 0], [0.2, 0, -1]]) @ np.diag([1, math.hypot(1, 0.2), -1])
    np.testing.assert_allclose(radiance_at_origin(add(axes)), expected, rtol=1e-3)
    assert not radiance_at_origin(add((0, 0, 1))).any()


def test_spread_of_a_polygon_light() -> None:
    square = 1e-3 * np.array([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]]) + (0, 0, 1)

    def value(**options: Any) -> Any:
        return radiance_at_origin(lambda scene: scene.add_polygon_light(square, (1, 1, 1), **options))[0]

    h = 0.4
    assert value(spread=2 * h) / value() == pytest.approx(math.tan(h) / (math.tan(h) - h), rel=2e-3)
    assert value(spread=math.pi) == value()


def test_disk_light_is_disk_coefficients() -> None:
    disk = ((0.3, -0.2, 1.0), (0.4, 0.1, 0.3), (-0.1, -0.9, 1.2))  # cut by the horizon
    irradiance = math.sqrt(4 * math.pi / 3) * shlight.disk_coefficients(*disk, order=2)[2]

    def value(u: Any, v: Any, **options: Any) -> Any:
        return radiance_at_origin(lambda scene: scene.add_disk_light(disk[0], u, v, (1, 2, 3), **options))

    facing, away = (disk[1:], disk[:0:-1])
    np.testing.assert_allclose(value(*facing), np.array([1, 2, 3]) * irradiance / math.pi, rtol=2e-5)
    assert not value(*away).any()
    in_the_floor = lambda scene: scene.add_disk_light((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 2, 3))  # noqa: E731
    assert not radiance_at_origin(in_the_floor).any()
    assert not value(*facing, diffuse=False).any()
    assert value(*facing, spread=math.pi)[0] == value(*facing)[0]
