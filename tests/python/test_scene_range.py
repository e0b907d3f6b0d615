# SPDX-License-Identifier: MIT
"""Scenes in any unit of length, within the range that docs/conventions.md gives and beyond it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, lit_floor

import shlight
from shlight import Bsdf, Scene, nodes

LAMPS: dict[str, Callable[[Scene, float], None]] = {
    "sphere": lambda scene, s: scene.add_sphere_light(np.array([0.5, 0.25, 2]) * s, 0.5 * s, [4, 2, 1]),
    "polygon": lambda scene, s: scene.add_polygon_light((FLOOR[::-1] / 9 + [0, 0.5, 2]) * s, [4, 2, 1]),
    "disk": lambda scene, s: scene.add_disk_light(np.array([0, 0.5, 2]) * s, [0, s, 0], [s, 0, 0], [4, 2, 1]),
    "point": lambda scene, s: scene.add_point_light(np.array([0.5, 0.25, 2]) * s, np.array([4, 2, 1]) * s * s),
    "emission": lambda scene, s: scene.add_mesh((FLOOR / 9 + [0, 0.5, 2]) * s, FACES, emission=[4, 2, 1]),
    "sun": lambda scene, s: scene.add_sun_light([0.3, 0.4, -1], 0.1, [4, 2, 1]),
    "environment": lambda scene, s: scene.set_environment([0.4, 0.2, 0.1]),
}
FAR = 1.001e10


def placed(x: float, y: float, z: float, scale: float = 1.0) -> Any:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = x, y, z
    return matrix


def scaled_picture(lamp: str, s: float) -> Any:
    """A glossy floor, and squares above it that cast shadows: one by itself, and two instances of another."""
    scene = Scene()
    scene.add_mesh(FLOOR * s, FACES, bsdf=Bsdf.ggx(0.4, 0.6) + Bsdf.lambert(0.3))
    scene.add_mesh(FLOOR / 20 * s, FACES, transforms=[placed(s, -s, 0.7 * s)])
    instances = [placed(-s, 0, 0.7 * s, scale=2), placed(0.3 * s, s, 0.5 * s)]
    scene.add_mesh(FLOOR / 30 * s, FACES, transforms=instances)
    LAMPS[lamp](scene, s)
    scene.set_camera_window(placed(0, 0, 10 * s), -2 * s, 2 * s, -2 * s, 2 * s, orthographic=True)
    return shlight.render(scene, 16, 16, pixel_samples=4, max_bounces=0)


@pytest.mark.parametrize("lamp", LAMPS)
def test_the_unit_of_length_does_not_matter(lamp: str) -> None:
    """Powers of two, which scale floats without rounding, from the least range to the largest; and twice beyond."""
    expected = scaled_picture(lamp, 1.0)
    assert expected[..., 0].std() > 0.01
    for exponent in [-23, -12, 12, 29]:
        np.testing.assert_array_equal(scaled_picture(lamp, 2.0**exponent), expected, err_msg=f"2^{exponent}")
    for exponent in [-49, -25]:
        with pytest.raises(ValueError, match=r"^scene"):
            scaled_picture(lamp, 2.0**exponent)


@pytest.mark.parametrize(
    ("bsdf", "order"), [(Bsdf.lambert(1), "auto"), (Bsdf.ggx(0.1, 1), "auto"), (Bsdf.ggx(0, 1), 8)]
)
def test_the_brightest_lights_give_finite_pictures(bsdf: Bsdf, order: Any) -> None:
    scene = lit_floor(bsdf=bsdf)
    scene.set_environment([1e15, 1, 0])
    scene.add_point_light([0, 0, 1e-13], [1e30, 1, 0])
    scene.add_point_light([0.1, 0, 1e-6], [1e30, 0, 0])
    scene.add_sphere_light([0, 0, 2], 1, [1e15, 0, 1])
    scene.add_sun_light([0, 0, -1], 0.0, [1e15, 0, 1])
    assert np.isfinite(shlight.render(scene, 16, 16, order=order, max_bounces=0)).all()


@pytest.mark.parametrize("kind", ["polygon", "disk", "mesh"])
def test_a_flat_light_shines_alike_far_from_the_origin(kind: str) -> None:
    """Also where it is nearer to a surface than what floats resolve of the coordinates."""

    def picture(x: float) -> NDArray[np.float32]:
        scene, at, up = shlight.Scene(), np.array([x, 0.0, 0.0]), np.array([0.0, 0.0, 0.25])
        faces, square = [[0, 1, 2], [0, 2, 3]], np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
        scene.add_mesh(4 * square + at, faces, bsdf=nodes.lambert(0.5 + 0.25 * (nodes.position().x - x)))
        if kind == "polygon":
            scene.add_polygon_light(square[::-1] + at + up, (5, 5, 5))
        elif kind == "disk":
            scene.add_disk_light(at + up, (0, 1, 0), (1, 0, 0), (5, 5, 5))
        else:
            scene.add_mesh(square + at + up, faces, bsdf=shlight.Bsdf.lambert(0), emission=(5, 5, 5))
        camera = np.eye(4)
        camera[:3, 3] = at + 0.8 * up
        scene.set_camera(camera, 1.0)
        return shlight.render(scene, 16, 16, passes=["position"], max_bounces=0)["combined"]

    np.testing.assert_allclose(picture(2.0**17), picture(0.0), rtol=2e-2)
