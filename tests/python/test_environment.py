# SPDX-License-Identifier: MIT
"""Scene.set_environment: arguments, and that rendering knows what was set."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

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


def random_picture(height: int = 16) -> NDArray[np.float32]:
    return np.random.default_rng(4).random((height, 2 * height, 3), dtype=np.float32)


def texels(picture: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions of the centres (h, w, 3) and solid angles (h, w)."""
    height, width = picture.shape[:2]
    tilt = (np.arange(height) + 0.5) / height * np.pi
    azimuth = np.pi * (1 - 2 * (np.arange(width) + 0.5) / width)
    z, x, y = (
        np.broadcast_to(a, (height, width))
        for a in (
            np.cos(tilt)[:, None],
            np.outer(np.sin(tilt), np.cos(azimuth)),
            np.outer(np.sin(tilt), np.sin(azimuth)),
        )
    )
    edges = np.cos(np.arange(height + 1) / height * np.pi)
    return np.stack([x, y, z], -1), np.outer(edges[:-1] - edges[1:], np.full(width, 2 * np.pi / width))


def test_picture_is_seen_where_it_lies() -> None:
    picture = random_picture()
    scene = shlight.Scene()
    scene.set_environment(picture)
    directions, _ = texels(picture)
    for row, column in [(3, 0), (8, 5), (12, 31)]:
        z = -directions[row, column]
        x = np.cross([0, 0, 1], z)
        x /= np.linalg.norm(x)
        to_world = np.eye(4)
        to_world[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
        scene.set_camera(to_world, 1e-4)
        np.testing.assert_allclose(shlight.render(scene, 1, 1)[0, 0], [*picture[row, column], 1], atol=5e-4)


def test_a_turned_picture_is_its_columns_rolled() -> None:
    picture = random_picture()
    scene = open_floor()
    turn = np.pi / 2
    to_world = [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    scene.set_environment(picture, to_world=to_world, visible=False)
    turned = shlight.render(scene, 8, 8)
    scene.set_environment(np.roll(picture, -8, axis=1), visible=False)  # columns go against the azimuth
    np.testing.assert_allclose(turned, shlight.render(scene, 8, 8), rtol=1e-4)


@pytest.mark.parametrize("to_world", [np.eye(4), 2 * np.eye(3), -np.eye(3), np.full((3, 3), np.nan), "north", 1.0])
def test_what_is_no_rotation_is_rejected(to_world: Any) -> None:
    with pytest.raises(ValueError, match=r"^to_world"):
        shlight.Scene().set_environment(random_picture(), to_world=to_world)


@pytest.mark.parametrize(
    "radiance",
    [
        np.zeros((0, 4, 3)),
        np.zeros((4, 4)),
        np.zeros((4, 4, 4)),
        np.zeros((2, 4, 4, 3)),
        (1, 2),
        1.0,
        (1, 2, -3),
        (1, float("nan"), 0),
        (1, float("inf"), 0),
        "sky",
        None,
        [[1, 2, 3]],
    ],
)
def test_what_is_no_radiance_is_rejected(radiance: Any) -> None:
    scene = open_floor()
    scene.set_environment((1, 1, 1))
    with pytest.raises(ValueError, match=r"^radiance"):
        scene.set_environment(radiance)
    assert shlight.render(scene, 8, 8)[0, 0, 0] == 1, "the scene is as it was"
