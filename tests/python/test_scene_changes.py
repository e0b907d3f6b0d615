# SPDX-License-Identifier: MIT
"""Scenes that change between renders look like scenes made anew."""

from __future__ import annotations

import copy
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, from_above

import shlight
from shlight import Bsdf, nodes

WALL = np.array([[-0.2, -1, 0.2], [-0.2, 1, 0.2], [0.4, 1, 0.9], [0.4, -1, 0.9]])
UP = np.eye(4)
ASIDE = np.eye(4)
ASIDE[0, 3] = 0.5
SHEER = nodes.mix(nodes.transparent(1.0), nodes.lambert(0.5), 0.5)


def scene_of(**wall: Any) -> tuple[shlight.Scene, shlight.SceneMesh]:
    """A wall on a floor, and no lamp."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES)
    mesh = scene.add_mesh(WALL, FACES, **wall)
    from_above(scene, 2.0)
    return scene, mesh


def add_lamp(scene: shlight.Scene, x: float) -> None:
    scene.add_sphere_light([x, 0.25, 1.5], 0.3, [4, 2, 1])


def picture(scene: shlight.Scene) -> shlight.RenderResult:
    return shlight.render(scene, 24, 24, max_samples=4, max_bounces=0)


Change = Callable[[shlight.SceneMesh], None]
CHANGES: dict[str, tuple[Change, dict[str, Any]]] = {  # what it does, and arguments that have it from the beginning
    "material": (lambda mesh: mesh.set_bsdf(Bsdf.lambert(0.1)), {"bsdf": Bsdf.lambert(0.1)}),
    "emission": (lambda mesh: mesh.set_bsdf(None, emission=[1, 2, 3]), {"emission": [1, 2, 3]}),
    "transparent": (lambda mesh: mesh.set_bsdf(SHEER), {"bsdf": SHEER}),
    "place": (lambda mesh: mesh.set_transforms([ASIDE]), {"transforms": [ASIDE]}),
    "instances": (lambda mesh: mesh.set_transforms([UP, ASIDE]), {"transforms": [UP, ASIDE]}),
}


@pytest.mark.parametrize(("change", "arguments"), CHANGES.values(), ids=CHANGES)
def test_a_changed_mesh_looks_as_if_made_so(change: Change, arguments: dict[str, Any]) -> None:
    scene, wall = scene_of()
    add_lamp(scene, 0.5)
    before = picture(scene)
    change(wall)
    changed = picture(scene)
    other, _ = scene_of(**arguments)
    add_lamp(other, 0.5)
    np.testing.assert_array_equal(changed, picture(other))
    assert not np.array_equal(changed, before)


def plane(steps: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A square of 2 steps² triangles."""
    x = np.linspace(-0.5, 0.5, steps + 1)
    vertices = np.stack([*np.meshgrid(x, x), np.full((steps + 1, steps + 1), 0.5)], axis=-1).reshape(-1, 3)
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)).ravel()
    corners = np.stack([first, first + 1, first + steps + 2, first + steps + 1], axis=-1)
    return vertices, np.concatenate([corners[:, :3], corners[:, [0, 2, 3]]])


TURNED = np.array([[0.8, -0.6, 0, 0.2], [0.6, 0.8, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
SHEARED = np.array([[1, 8, 0, 0], [0, 1, 0, 0.3], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@pytest.mark.parametrize("place", [ASIDE, TURNED, SHEARED], ids=["aside", "turned", "sheared"])
def test_a_large_mesh_that_moves_looks_as_if_made_there(place: NDArray[np.float64]) -> None:
    def scene_at(transform: NDArray[np.float64]) -> tuple[shlight.Scene, shlight.SceneMesh]:
        scene, _ = scene_of()
        mesh = scene.add_mesh(*plane(150), transforms=[transform])
        add_lamp(scene, 0.5)
        return scene, mesh

    scene, mesh = scene_at(UP)
    before = picture(scene)
    mesh.set_transforms([place])
    changed = picture(scene)
    np.testing.assert_array_equal(changed, picture(scene_at(place)[0]))
    assert not np.array_equal(changed, before)


def test_emissive_meshes_stay_lit_where_others_are_removed() -> None:
    scene, wall = scene_of()
    vertices, triangles = plane(4)
    vertices += np.array([0, 0, 1])
    scene.add_mesh(vertices, triangles, emission=[4, 2, 1])
    picture(scene)
    wall.remove()
    other = shlight.Scene()
    other.add_mesh(vertices, triangles, emission=[4, 2, 1])
    other.add_mesh(FLOOR, FACES)
    from_above(other, 2.0)
    np.testing.assert_array_equal(picture(scene), picture(other))


def test_many_meshes_that_shine_look_as_if_made_so() -> None:
    """There are more lights than are looked at one by one."""
    small = 0.05 * WALL
    places = np.tile(np.eye(4), (150, 1, 1))
    places[:, :3, 3] = np.random.default_rng(5).uniform((-1, -1, 0.5), (1, 1, 1), (150, 3))
    moved = places + 0.3 * np.eye(4, k=3)
    scene, made = scene_of()[0], scene_of()[0]
    mesh = scene.add_mesh(small, FACES, emission=[3, 2, 1], transforms=places)
    before = picture(scene)
    mesh.set_transforms(moved)
    made.add_mesh(small, FACES, emission=[3, 2, 1], transforms=moved)
    changed = picture(scene)
    np.testing.assert_array_equal(changed, picture(made))
    assert not np.array_equal(changed, before)


def test_lamps_are_replaced() -> None:
    scene, _ = scene_of(emission=[0, 0.1, 0])
    scene.set_environment([0.1, 0.1, 0.2])
    add_lamp(scene, 0.5)
    picture(scene)
    scene.remove_lights()
    add_lamp(scene, -0.5)
    other, _ = scene_of(emission=[0, 0.1, 0])
    other.set_environment([0.1, 0.1, 0.2])
    add_lamp(other, -0.5)
    np.testing.assert_array_equal(picture(scene), picture(other))


def test_a_removed_mesh_is_gone_and_the_others_stay() -> None:
    scene, wall = scene_of()
    add_lamp(scene, 0.5)
    copied = copy.copy(scene)
    with_wall = picture(scene)
    wall.remove()
    other = shlight.Scene()
    other.add_mesh(FLOOR, FACES)
    from_above(other, 2.0)
    add_lamp(other, 0.5)
    np.testing.assert_array_equal(picture(scene), picture(other))
    np.testing.assert_array_equal(picture(copied), with_wall)
    for use in (wall.remove, lambda: wall.set_bsdf(None), lambda: wall.set_transforms(None)):
        with pytest.raises(ValueError, match="mesh has been removed"):
            use()


@pytest.mark.parametrize(
    ("change", "name"),
    [
        (lambda mesh: mesh.set_bsdf("red"), "bsdf"),
        (lambda mesh: mesh.set_bsdf(None, emission=[np.nan, 0, 0]), "emission"),
        (lambda mesh: mesh.set_transforms([np.zeros((4, 4))]), "transforms"),
        (lambda mesh: mesh.set_transforms([UP], object_values=[[1.0], [2.0]]), "object_values"),
    ],
)
def test_a_refused_change_leaves_the_mesh_as_it_was(change: Change, name: str) -> None:
    scene, wall = scene_of()
    add_lamp(scene, 0.5)
    before = picture(scene)
    with pytest.raises(ValueError, match=f"^{name}"):
        change(wall)
    np.testing.assert_array_equal(picture(scene), before)


@contextmanager
def once_released(work: Callable[[], object]) -> Iterator[None]:
    """Another thread does this as soon as a call in here lets go of Python's lock, as imports would too."""
    start = threading.Semaphore(0)
    thread = threading.Thread(target=lambda: (start.acquire(), work()))
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1000)  # Python itself lets go of it after so many seconds
    try:
        thread.start()
        start.release()
        yield
    finally:
        sys.setswitchinterval(usual)
        thread.join()


def test_a_render_shows_the_scene_that_it_began_with() -> None:
    """Also if the scene changes before it is built, while all its vertices are looked at."""
    scene, _ = scene_of()
    add_lamp(scene, 0.5)
    scene.add_mesh(np.concatenate([WALL, np.zeros((2_000_000, 3), np.float32)]), FACES)
    before = picture(copy.copy(scene))
    with once_released(scene.remove_lights):
        own = picture(scene)
    np.testing.assert_array_equal(own, before)
    assert not picture(scene)[..., :3].any()


def test_other_threads_run_while_a_scene_is_built() -> None:
    scene, _ = scene_of()
    picture(scene)  # has all imported that a render needs
    scene.add_mesh(*plane(300))
    ran = threading.Event()
    with once_released(ran.set), pytest.raises(shlight.RenderCancelled):
        shlight.render(scene, 8, 8, max_bounces=0, progress=lambda _: not ran.is_set())
    assert picture(scene).report.build_seconds > 0
