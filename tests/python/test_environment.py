# SPDX-License-Identifier: MIT
"""Scene.set_environment: arguments, and that rendering knows what was set."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, SQUARE, from_above

import shlight


def open_floor() -> shlight.Scene:
    """Fills the middle quarter of the picture."""
    scene = shlight.Scene()
    scene.add_mesh(SQUARE, FACES, bsdf=shlight.Bsdf.lambert(0.5))
    return from_above(scene)


@pytest.mark.parametrize("visible", [True, False])
def test_constant(visible: bool) -> None:
    scene = open_floor()
    scene.set_environment((1, 2, 4), visible=visible)
    image, report = shlight.render(scene, 8, 8, return_report=True, max_bounces=0)
    np.testing.assert_allclose(image[4, 4], [0.5, 1, 2, 1], rtol=1e-6)
    np.testing.assert_array_equal(image[0, 0], [1, 2, 4, 1] if visible else [0, 0, 0, 0])
    assert report.order_shares == {1: 1.0}
    assert report.over_tolerance == 0
    scene.set_environment((3, 3, 3))  # the last one counts
    assert shlight.render(scene, 8, 8, max_bounces=0)[4, 4, 0] == pytest.approx(1.5, rel=1e-6)
    with pytest.raises(ValueError, match=r"^radiance"):
        scene.set_environment((1, 2, -3))
    assert shlight.render(scene, 8, 8, max_bounces=0)[4, 4, 0] == pytest.approx(1.5, rel=1e-6)  # as it was


def random_picture() -> NDArray[np.float32]:
    return np.random.default_rng(4).random((16, 32, 3), dtype=np.float32)


def test_picture_is_seen_where_it_lies() -> None:
    picture = random_picture()
    scene = shlight.Scene()
    scene.set_environment(picture)
    for row, column in [(3, 0), (8, 5), (12, 31), (8, 5.5), (3, 31.5)]:  # in the middle of a texel or between two
        tilt, azimuth = (row + 0.5) / 16 * np.pi, np.pi * (1 - 2 * (column + 0.5) / 32)
        z = -np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
        x = np.cross([0, 0, 1], z)
        x /= np.linalg.norm(x)
        to_world = np.eye(4)
        to_world[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
        scene.set_camera(to_world, 1e-4)
        expected = (picture[row, int(column)] + picture[row, int(column + 0.5) % 32]) / 2
        np.testing.assert_allclose(shlight.render(scene, 1, 1, max_bounces=0)[0, 0], [*expected, 1], atol=5e-4)


def test_a_turned_picture_is_its_columns_rolled() -> None:
    picture = random_picture()
    scene = open_floor()
    turn = np.pi / 2
    to_world = [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    scene.set_environment(picture, to_world=to_world, visible=False)
    turned = shlight.render(scene, 8, 8, max_bounces=0)
    scene.set_environment(np.roll(picture, -8, axis=1), visible=False)  # columns go against the azimuth
    np.testing.assert_allclose(turned, shlight.render(scene, 8, 8, max_bounces=0), rtol=1e-4)
