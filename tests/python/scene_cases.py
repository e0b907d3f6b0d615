# SPDX-License-Identifier: MIT
"""A floor under one light, seen from above, which several tests render."""

from __future__ import annotations

from typing import Any

import numpy as np

import shlight

SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
FLOOR = 9 * SQUARE
FACES = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def from_above(scene: shlight.Scene, half_size: float = 2.0) -> shlight.Scene:
    """Column j shows x, row i shows -y of the floor."""
    to_world = np.eye(4)
    to_world[2, 3] = 10
    scene.set_camera_window(to_world, -half_size, half_size, -half_size, half_size, orthographic=True)
    return scene


def lit_floor(**mesh: Any) -> shlight.Scene:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, **mesh)
    scene.add_sphere_light([0.5, 0.25, 1.5], 0.5, [4, 2, 1])
    return from_above(scene)
