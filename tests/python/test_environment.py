# SPDX-License-Identifier: MIT
"""Scene.set_environment: arguments, and that rendering knows what was set."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shlight

FLOOR = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
QUAD = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def open_floor(albedo: float = 0.5) -> shlight.Scene:
    """Fills the middle quarter of the picture."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, QUAD, bsdf=shlight.Bsdf.lambert(albedo))
    to_world = np.eye(4)
    to_world[2, 3] = 10
    scene.set_camera_window(to_world, -2, 2, -2, 2, orthographic=True)
    return scene


@pytest.mark.parametrize("visible", [True, False])
def test_constant(visible: bool) -> None:
    scene = open_floor()
    scene.set_environment((1, 2, 4), visible=visible)
    image, report = shlight.render(scene, 8, 8, return_report=True)
    np.testing.assert_allclose(image[4, 4], [0.5, 1, 2, 1], rtol=1e-6)
    np.testing.assert_array_equal(image[0, 0], [1, 2, 4, 1] if visible else [0, 0, 0, 0])
    assert report.order_shares == {1: 1.0}
    assert report.over_tolerance == 0


def test_the_last_one_counts_also_after_a_render() -> None:
    scene = open_floor()
    for radiance in (1.0, 3.0):
        scene.set_environment((radiance,) * 3)
        assert shlight.render(scene, 8, 8)[4, 4, 0] == pytest.approx(0.5 * radiance, rel=1e-6)


def test_it_adds_to_lights() -> None:
    scene = open_floor()
    scene.add_sphere_light((0, 0, 3), 0.5, (5, 5, 5))
    alone = shlight.render(scene, 8, 8)[4, 4, :3]
    scene.set_environment((1, 1, 1))
    np.testing.assert_allclose(shlight.render(scene, 8, 8)[4, 4, :3], alone + 0.5, rtol=1e-5)


@pytest.mark.parametrize(
    "radiance", [(1, 2), 1.0, (1, 2, -3), (1, float("nan"), 0), (1, float("inf"), 0), "sky", None, [[1, 2, 3]]]
)
def test_what_is_no_radiance_is_rejected(radiance: Any) -> None:
    scene = open_floor()
    scene.set_environment((1, 1, 1))
    with pytest.raises(ValueError, match=r"^radiance"):
        scene.set_environment(radiance)
    assert shlight.render(scene, 8, 8)[0, 0, 0] == 1, "the scene is as it was"
