# SPDX-License-Identifier: MIT
from __future__ import annotations

import numpy as np
import pytest

import shlight


def test_look_at_puts_the_target_ahead_and_up_above() -> None:
    rng = np.random.default_rng(1)
    eye, target, up = rng.normal(size=(7, 1, 3)), rng.normal(size=(5, 3)), rng.normal(size=3)
    to_world = shlight.look_at(eye, target, up)
    assert to_world.shape == (7, 5, 4, 4)
    seen = np.linalg.inv(to_world)
    ahead = (seen @ np.append(target, np.ones((5, 1)), axis=1)[..., None])[..., 0]
    distance = np.linalg.norm(target - eye, axis=-1)
    np.testing.assert_allclose(ahead[..., :3], distance[..., None] * [0, 0, -1], atol=1e-12)
    above = seen[..., :3, :3] @ up
    assert np.abs(above[..., 0]).max() <= 1e-12
    assert above[..., 1].min() > 0
    rotation = to_world[..., :3, :3]
    np.testing.assert_allclose(
        rotation @ rotation.swapaxes(-1, -2), np.broadcast_to(np.eye(3), (7, 5, 3, 3)), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(rotation), 1, rtol=1e-12)


def test_a_render_shows_what_look_at_names() -> None:
    """A lamp at the target is in the middle of the picture, and one above it is above the middle."""
    scene = shlight.Scene()
    scene.add_sphere_light((1, 2, 3), 0.1, (1, 0, 0), camera=True)
    scene.add_sphere_light((1, 2, 3.8), 0.1, (0, 1, 0), camera=True)
    scene.set_camera(shlight.look_at((4, -1, 2), (1, 2, 3)), 0.6)
    image = np.asarray(shlight.render(scene, 33, 33))
    assert image[16, 16, 0] > 0.9
    rows, columns = np.nonzero(image[..., 1] > 0.5)
    assert rows.max() < 12
    assert abs(columns.mean() - 16) <= 0.1


def test_no_camera_without_a_direction() -> None:
    eyes = [[0.0, 0, 1], [0, 0, 2], [3, 0, 0]]
    for named, eye, target, up in (
        (r"target\[1\]", [[0.0, 0, 1], [0, 0, 2]], [[0.0, 0, 0], [0, 0, 2]], (0, 1, 0)),
        (r"up\[2\] must not be 0", eyes, (0, 0, 0), [[0, 1, 0], [0, 1, 0], [0, 0, 0]]),
        (r"up must not be parallel", eyes[::-1], (0, 0, 0), (0, 0, -3)),
        (r"eye\[2\] must be finite", [[0.0, 0, 1], [0, 0, 2], [np.nan, 0, 0]], (0, 0, 0), (0, 1, 0)),
    ):
        with pytest.raises(ValueError, match=f"^{named}"):
            shlight.look_at(eye, target, up)
