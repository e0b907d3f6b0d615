# SPDX-License-Identifier: MIT
"""Light sets and shadow sets: what lights light, and what blocks them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shlight

QUAD = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
TRIANGLES = [[0, 1, 2], [0, 2, 3]]
ABOVE = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]], dtype=float)
UNSEEN = ["diffuse", "glossy", "shadow"]
ALL = {"receivers": None, "blockers": None}

Light = Callable[..., Any]
LIGHTS: dict[str, Light] = {
    "sphere": lambda scene, **links: scene.add_sphere_light((0, 0, 3), 0.3, 5, **links),
    "polygon": lambda scene, **links: scene.add_polygon_light(0.4 * QUAD[::-1] + [0, 0, 3], 5, **links),
    "disk": lambda scene, **links: scene.add_disk_light((0, 0, 3), (0, 0.4, 0), (0.4, 0, 0), 5, **links),
    "point": lambda scene, **links: scene.add_point_light((0, 0, 3), 5, **links),
    "spot": lambda scene, **links: scene.add_spot_light((0, 0, 3), (0, 0, -1), 1.5, 0.2, 5, radius=0.2, **links),
    "sun": lambda scene, **links: scene.add_sun_light((0.1, 0, -1), 0.1, 2, **links),
    "parallel": lambda scene, **links: scene.add_sun_light((0.1, 0, -1), 0, 2, **links),
    "faces": lambda scene, **links: scene.add_mesh(
        0.4 * QUAD + [0, 0, 3], TRIANGLES, emission=5, visible_to=UNSEEN, **links
    ),
}


def picture(light: Light | None, links: dict[str, Any], post: bool = True, bounces: int = 0) -> np.ndarray[Any, Any]:
    """Two floors side by side, the right one of light set 1, under a post of shadow set 2."""
    scene = shlight.Scene()
    for x, light_set in ((-1, 0), (1, 1)):
        scene.add_mesh(QUAD + np.array([x, 0, 0]), TRIANGLES, light_set=light_set)
    if post:
        scene.add_mesh(0.3 * QUAD + [0.2, 0.1, 1], TRIANGLES, shadow_set=2, light_set=0, visible_to=["shadow"])
    if light is not None:
        light(scene, **links)
    scene.set_environment(0.05)
    scene.set_camera_window(ABOVE, -2, 2, -1, 1, orthographic=True)
    return np.asarray(shlight.render(scene, 24, 12, pixel_samples=4, max_bounces=bounces))[..., :3]


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_light_lights_its_receivers_alone(kind: str) -> None:
    linked = picture(LIGHTS[kind], ALL | {"receivers": {1}})
    whole, dark = picture(LIGHTS[kind], ALL), picture(None, ALL)
    shade = 2e-3 if kind == "faces" else 0.0  # the plate's own, of the environment
    np.testing.assert_allclose(linked[:, :11], dark[:, :11], rtol=0, atol=shade)
    np.testing.assert_allclose(linked[:, 13:], whole[:, 13:], rtol=0, atol=2e-2 * whole.max())
    assert whole[:, :11].mean() > 1.5 * dark[:, :11].mean()
    np.testing.assert_array_equal(picture(LIGHTS[kind], ALL | {"receivers": [0, 1]}), whole)


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_light_is_blocked_by_its_blockers_alone(kind: str) -> None:
    """The environment, which has no links, is still blocked."""
    free = picture(LIGHTS[kind], ALL | {"blockers": [0, 27]})
    alone = picture(LIGHTS[kind], ALL, post=False) - picture(None, ALL, post=False) + picture(None, ALL)
    np.testing.assert_allclose(free, alone, rtol=0, atol=1e-2 * alone.max())
    blocked = picture(LIGHTS[kind], ALL | {"blockers": (2,)})
    np.testing.assert_array_equal(blocked, picture(LIGHTS[kind], ALL))
    assert np.abs(blocked - free).max() > 0.2 * free.max()


def test_bounces_follow_links() -> None:
    """Light that a wall reflects reaches the floor, which the lamp leaves out."""
    scene = shlight.Scene()
    for light_set, axes in ((0, QUAD), (1, QUAD[:, [2, 1, 0]] + [-1, 0, 1])):
        scene.add_mesh(axes, TRIANGLES, light_set=light_set)
    scene.add_point_light((0, 0, 2), 10, receivers=[1])
    scene.set_camera_window(ABOVE, -0.6, 0, -0.3, 0.3, orthographic=True)
    direct, bounced = (np.asarray(shlight.render(scene, 4, 4, max_bounces=n))[..., :3] for n in (0, 1))
    assert not direct.any()
    assert bounced.mean() > 0.05


@pytest.mark.parametrize(
    "links", [{"receivers": 3}, {"receivers": [64]}, {"receivers": [1.5]}, {"blockers": [28]}, {"blockers": "12"}]
)
def test_sets_that_are_none_are_refused(links: dict[str, Any]) -> None:
    (name,) = links
    for add in LIGHTS.values():
        with pytest.raises((ValueError, TypeError), match=name):
            add(shlight.Scene(), **links)


@pytest.mark.parametrize(("name", "value"), [("light_set", 64), ("light_set", -1), ("shadow_set", 28)])
def test_numbers_of_sets_are_checked(name: str, value: int) -> None:
    with pytest.raises(ValueError, match=name):
        shlight.Scene().add_mesh(QUAD, TRIANGLES, **{name: value})
