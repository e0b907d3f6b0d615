# SPDX-License-Identifier: MIT
"""Lamps that the camera looks at: how much of the picture they fill, in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scene_cases import FACES, FLOOR

import shlight

RADIANCE = (1.0, 2.0, 4.0)
HALF_WIDTH = math.tan(0.5)
STAR = [[(1.0 if i % 2 else 0.4) * f(math.pi * i / 5) for f in (math.cos, math.sin)] for i in range(10)]
STAR_AREA = 5 * 0.4 * math.sin(math.pi / 5)


def picture(add: Callable[[shlight.Scene], None], floor: bool = False) -> Any:
    """A picture from the origin along -z, one radian wide."""
    scene = shlight.Scene()
    if floor:
        scene.add_mesh(FLOOR - [0, 0, 3], FACES)
    add(scene)
    scene.set_camera(np.eye(4), 1.0)
    return shlight.render(scene, 64, 64, pixel_samples=16, max_bounces=0)


def filled(add: Callable[[shlight.Scene], None], **options: Any) -> float:
    """Area of the lamp's image on the plane at distance 1."""
    image = picture(add, **options)
    np.testing.assert_allclose(image[..., :3].mean(axis=(0, 1)) / image[..., 0].mean(), RADIANCE, rtol=1e-5)
    return float(image[..., 0].mean()) * (2 * HALF_WIDTH) ** 2


def test_sphere() -> None:
    # A sphere with centre (x, 0, -d), x² + d² = D², appears as an ellipse: its cone cut by the picture's plane.
    x, d, radius = 0.5, 4.0, 0.7
    sine = radius / math.hypot(x, d)
    denominator = (d * d) / (x * x + d * d) - sine * sine
    expected = math.pi * sine * sine * math.sqrt(1 - sine * sine) / denominator**1.5
    area = filled(lambda s: s.add_sphere_light((x, 0, -d), radius, RADIANCE, camera=True))
    assert area == pytest.approx(expected, rel=2e-3)


def test_disk_that_faces_the_camera() -> None:
    area = filled(lambda s: s.add_sphere_light((0, 0, -4), 0.8, RADIANCE, facing_disk=True, camera=True))
    assert area == pytest.approx(math.pi * 0.2**2, rel=2e-3)


def test_star_from_its_front_only() -> None:
    star = [(x, y, -2.5) for x, y in STAR]
    area = filled(lambda s: s.add_polygon_light(star, RADIANCE, camera=True))
    assert area == pytest.approx(STAR_AREA / 2.5**2, rel=3e-3)
    assert not picture(lambda s: s.add_polygon_light(star[::-1], RADIANCE, camera=True)).any()


def test_ellipse_from_its_front_only() -> None:
    # In a plane across the view, half axes of lengths 0.9 and 0.5, not at right angles as they are given.
    disk = ((0.2, -0.1, -2.0), (0.72, 0.3, 0), (-0.54, 0.4, 0))
    area = filled(lambda s: s.add_disk_light(*disk, RADIANCE, camera=True))
    assert area == pytest.approx(math.pi * 0.9 * 0.5 / 2.0**2, rel=3e-3)
    away = (disk[0], disk[2], disk[1])
    assert not picture(lambda s: s.add_disk_light(*away, RADIANCE, camera=True)).any()


def test_sun() -> None:
    irradiance = np.array(RADIANCE) * math.pi * math.sin(0.1) ** 2
    area = filled(lambda s: s.add_sun_light((0, 0, 1), 0.2, irradiance, camera=True))
    assert area == pytest.approx(math.pi * math.tan(0.1) ** 2, rel=2e-3)


@pytest.mark.parametrize("facing_disk", [False, True])
def test_lamps_cover_nothing_and_are_covered(facing_disk: bool) -> None:
    def lamp(distance: float) -> Callable[[shlight.Scene], None]:
        options = {"facing_disk": facing_disk, "camera": True, "diffuse": False, "glossy": False}
        return lambda s: s.add_sphere_light((0, 0, -distance), 0.5, RADIANCE, **options)

    assert not picture(lamp(2.0))[..., 3].any()
    assert picture(lamp(2.0), floor=True)[..., 0].max() == 1.0
    assert not picture(lamp(4.0), floor=True)[..., :3].any()


def test_radiance_follows_the_profile() -> None:
    image = picture(lambda s: s.add_spot_light((0, 0, -4), (0.1, 0, 1), 1.0, 1.0, RADIANCE, radius=1.0, camera=True))
    z = 1 / math.hypot(1, 0.1)
    share = (z - math.cos(0.5)) / (1 - math.cos(0.5))
    expected = share * share * (3 - 2 * share) / math.pi
    assert image[31:33, 31:33, 0].mean() == pytest.approx(expected, rel=2e-3)


def test_only_those_asked_for() -> None:
    assert not picture(lambda s: s.add_sphere_light((0, 0, -4), 0.7, RADIANCE)).any()
    assert not picture(lambda s: s.add_point_light((0, 0, -4), RADIANCE, camera=True)).any()
    assert not picture(lambda s: s.add_sun_light((0, 0, 1), 0.0, RADIANCE, camera=True)).any()
