# SPDX-License-Identifier: MIT
"""Bodies that absorb light: closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import nodes

ABSORPTION = np.array([0.5, 1.0, 3.0])
CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
# Counter-clockwise seen from outside.
SIDES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2)]
SIDES += [(1, 3, 7), (1, 7, 5)]


def box(scene: shlight.Scene, low: float, high: float, surface: Any, absorption: Any = ABSORPTION) -> None:
    """A wide slab between two heights."""
    vertices = (CORNERS - (0.5, 0.5, 0.0)) * (20, 20, high - low) + (0, 0, low)
    scene.add_mesh(vertices, SIDES, bsdf=surface + nodes.absorbing(absorption))


def floor_seen(add: Any, height: float = 5.0, bounces: int = 0) -> Any:
    """The radiance of a white floor z = 0 at its middle, seen from above."""
    scene = shlight.Scene()
    square = 5 * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    scene.add_mesh(square, [(0, 1, 2), (0, 2, 3)], bsdf=shlight.Bsdf.lambert(1))
    scene.add_sun_light((0.6, 0, -0.8), 0.0, (1, 1, 1))
    add(scene)
    to_world = np.eye(4)
    to_world[2, 3] = height
    scene.set_camera(to_world, 1e-3)
    return shlight.render(scene, 1, 1, pixel_samples=1, max_bounces=bounces)[0, 0, :3].astype(float)


def test_light_and_sight_through_a_slab() -> None:
    clear = floor_seen(lambda scene: box(scene, 1, 1.5, nodes.transparent(), 0.0))
    found = floor_seen(lambda scene: box(scene, 1, 1.5, nodes.transparent()))
    np.testing.assert_allclose(found / clear, np.exp(-ABSORPTION * 0.5 * (1 + 1 / 0.8)), rtol=2e-4)


@pytest.mark.parametrize("height", [5.0, 0.7])
def test_a_floor_under_water(height: float) -> None:
    """The floor lies inside the body, the camera above it or inside, too."""
    clear = floor_seen(lambda scene: box(scene, -1, 1, nodes.transparent(), 0.0), height)
    found = floor_seen(lambda scene: box(scene, -1, 1, nodes.transparent()), height)
    way = min(height, 1.0) + 1 / 0.8
    np.testing.assert_allclose(found / clear, np.exp(-ABSORPTION * way), rtol=2e-4)


def test_bodies_in_each_other_add_up() -> None:
    def both(scene: shlight.Scene) -> None:
        box(scene, 1, 2, nodes.transparent())
        box(scene, 1.5, 3, nodes.transparent(), 2 * ABSORPTION)

    clear = floor_seen(lambda scene: None)
    expected = np.exp(-ABSORPTION * (1 + 2 * 1.5) * (1 + 1 / 0.8))
    np.testing.assert_allclose(floor_seen(both) / clear, expected, rtol=2e-4)


def test_paths_through_glass() -> None:
    """A glowing floor seen straight through a pane, which reflects by Fresnel's law at both sides."""
    scene = shlight.Scene()
    square = 5 * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    scene.add_mesh(square, [(0, 1, 2), (0, 2, 3)], bsdf=shlight.Bsdf.lambert(0.0), emission=1.0)
    box(scene, 1, 1.5, nodes.refraction(1.0, 0.0, 1.5))
    to_world = np.eye(4)
    to_world[2, 3] = 5
    scene.set_camera(to_world, 1e-3)
    found = shlight.render(scene, 1, 1, pixel_samples=1, max_bounces=4)[0, 0, :3]
    np.testing.assert_allclose(found, np.exp(-ABSORPTION * 0.5), rtol=1e-4)


def test_refused() -> None:
    with pytest.raises(ValueError, match="absorption must lie"):
        nodes.absorbing(-1.0)
    with pytest.raises(ValueError, match="absorption must be the same"):
        nodes.absorbing(nodes.uv().x).compiled()
    shader = (nodes.absorbing(2.0) + nodes.absorbing((0, 1, 0))) * 0.5
    assert shader.absorption.constant == pytest.approx((1, 1.5, 1))
    assert math.isclose(nodes.mix(shader, nodes.Shader(), 0.5).absorption.x.constant or 0.0, 0.5)
