# SPDX-License-Identifier: MIT
"""Lights and meshes that are changed by their handles are as if they had been made so."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR

import shlight
from shlight import Bsdf

Floats = NDArray[np.float64]

RED = [3.0, 0.5, 0.2]
SQUARE = np.array([[-0.3, 0.3, 1.5], [0.3, 0.3, 1.5], [0.3, -0.3, 1.5], [-0.3, -0.3, 1.5]])  # shines down
SLANTED = np.linalg.qr([[1.0, 0.2, 0.1], [0, 1, 0.3], [0.2, 0, 1]])[0]
SLANTED *= np.sign(np.linalg.det(SLANTED))
PLACE = np.eye(4)
PLACE[:3, :3] = 1.5 * SLANTED
PLACE[:3, 3] = [0.2, -0.1, 0.4]


def moved(point: Any) -> Floats:
    return np.asarray(point) @ PLACE[:3, :3].T + PLACE[:3, 3]


def turned(way: Any) -> Floats:
    return np.asarray(way) @ PLACE[:3, :3].T


# How each is added, the name of its strength, and its arguments at PLACE.
LIGHTS: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "sphere": (
        "radiance",
        {"center": [0.1, 0, 1.5], "radius": 0.2, "radiance": RED},
        {"center": moved([0.1, 0, 1.5]), "radius": 0.3},
    ),
    "polygon": ("radiance", {"vertices": SQUARE, "radiance": RED, "spread": 2.0}, {"vertices": moved(SQUARE)}),
    "disk": (
        "radiance",
        {"center": [0, 0, 1.5], "half_axis_u": [0, 0.4, 0], "half_axis_v": [0.2, 0, 0], "radiance": RED},
        {
            "center": moved([0, 0, 1.5]),
            "half_axis_u": turned([0, 0.4, 0]),
            "half_axis_v": turned([0.2, 0, 0]),
        },
    ),
    "point": ("intensity", {"position": [0.1, 0, 1.5], "intensity": RED}, {"position": moved([0.1, 0, 1.5])}),
    "spot": (
        "intensity",
        {
            **{"position": [0, 0, 1.5], "direction": [0.1, 0, -1], "spot_angle": 1.0, "blend": 0.3},
            **{"intensity": RED, "radius": 0.1},
        },
        {"position": moved([0, 0, 1.5]), "direction": turned([0.1, 0, -1]), "radius": 0.15},
    ),
    "sun": (
        "irradiance",
        {"direction": [0.1, 0, -1], "angle": 0.1, "irradiance": RED},
        {"direction": turned([0.1, 0, -1])},
    ),
}


def empty_room() -> shlight.Scene:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR - np.array([0, 0, 1]), FACES)
    scene.add_mesh([[-0.2, -1, 0.2], [-0.2, 1, 0.2], [0.4, 1, 0.5], [0.4, -1, 0.5]], FACES)
    return scene


def light_of(scene: shlight.Scene) -> Floats:
    x = np.linspace(-1, 1, 8)
    points = np.stack([*np.meshgrid(x, x), np.full((8, 8), -1.0)], axis=-1).reshape(-1, 3)
    return scene.irradiance(points, [0, 0, 1])


def add(scene: shlight.Scene, kind: str, arguments: dict[str, Any]) -> shlight.Light:
    light: shlight.Light = getattr(scene, f"add_{kind}_light")(**arguments)
    return light


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_changed_light_is_as_if_made_so(kind: str) -> None:
    strength, arguments, at_place = LIGHTS[kind]
    scene, other = empty_room(), empty_room()
    light = add(scene, kind, arguments)
    before = light_of(scene)
    assert before.max() > 0
    np.testing.assert_array_equal(light.to_world, np.eye(4))
    np.testing.assert_allclose(getattr(light, strength), RED, rtol=1e-6)
    light.to_world = PLACE
    setattr(light, strength, [1, 2, 3])
    np.testing.assert_array_equal(light.to_world, PLACE)
    np.testing.assert_array_equal(getattr(light, strength), [1, 2, 3])
    changed = light_of(scene)
    add(other, kind, {**arguments, **at_place, strength: [1, 2, 3]})
    np.testing.assert_allclose(changed, light_of(other), rtol=1e-4, atol=1e-4 * changed.max())
    assert not np.allclose(changed, before, rtol=0.1)
    light.to_world = np.eye(4)
    setattr(light, strength, RED)
    np.testing.assert_array_equal(light_of(scene), before)


@pytest.mark.parametrize("kind", ["polygon", "disk"])
def test_a_mirrored_light_shines_to_its_mirrored_side(kind: str) -> None:
    scene = empty_room()
    light = add(scene, kind, LIGHTS[kind][1])
    straight = light_of(scene)
    light.to_world = np.diag([-1.0, 1, 1, 1])
    mirrored = light_of(scene)
    assert mirrored.sum() >= 0.2 * straight.sum()


@pytest.mark.parametrize("kind", LIGHTS)
def test_lights_are_removed_one_by_one(kind: str) -> None:
    scene = empty_room()
    other = add(scene, "sphere", LIGHTS["sphere"][1])
    alone = light_of(scene)
    light = add(scene, kind, LIGHTS[kind][1])
    copied = copy.deepcopy(scene)
    both = light_of(scene)
    light.remove()
    np.testing.assert_array_equal(light_of(scene), alone)
    np.testing.assert_array_equal(light_of(copied), both)
    assert repr(light) == "Light(removed)"
    for use in (light.remove, lambda: light.group, lambda: setattr(light, "to_world", np.eye(4))):
        with pytest.raises(ValueError, match="light has been removed from its scene"):
            use()
    scene.remove_lights()
    with pytest.raises(ValueError, match="light has been removed"):
        _ = other.radiance


def test_lights_and_meshes_change_their_groups() -> None:
    scene = empty_room()
    scene.set_camera([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 6], [0, 0, 0, 1]], 1.0)
    light = add(scene, "sphere", {**LIGHTS["sphere"][1], "group": "key"})
    mesh = scene.add_mesh(SQUARE + np.array([1, 0, 0]), FACES, emission=RED)
    assert (light.group, mesh.group) == ("key", None)
    light.group, mesh.group = "fill", "panel"
    assert (light.group, mesh.group) == ("fill", "panel")
    given: dict[str, Any] = {"max_bounces": 0, "max_samples": 1, "groups": True}
    groups = shlight.render(scene, 8, 8, **given).groups
    assert set(groups) >= {"fill", "panel"}
    assert groups["fill"].max() > 0
    assert groups["panel"].max() > 0
    light.group = None
    assert light.group is None


def test_a_mesh_moves_by_its_handle() -> None:
    scene, other = empty_room(), empty_room()
    for own in (scene, other):
        add(own, "sphere", LIGHTS["sphere"][1])
    mesh = scene.add_mesh(SQUARE * 0.5, FACES, bsdf=Bsdf.lambert(0.5))
    before = light_of(scene)
    mesh.to_world = PLACE
    np.testing.assert_array_equal(mesh.to_world, PLACE)
    other.add_mesh(SQUARE * 0.5, FACES, transforms=[PLACE])
    np.testing.assert_array_equal(light_of(scene), light_of(other))
    assert not np.array_equal(light_of(scene), before)
    mesh.set_transforms([PLACE, PLACE])
    with pytest.raises(ValueError, match="to_world is of a mesh with one instance; this one has 2"):
        mesh.to_world = PLACE


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("to_world", np.zeros((4, 4)), "to_world"),
        ("to_world", np.eye(3), "to_world must have shape"),
        ("to_world", np.diag([1.0, 1, 2, 1]), "to_world must turn, move and scale a sphere light alike"),
        ("radiance", [np.nan, 0, 0], "radiance"),
        ("group", 3, "group must be a string"),
    ],
)
def test_a_refused_change_leaves_a_light_as_it_was(name: str, value: Any, message: str) -> None:
    scene = empty_room()
    light = add(scene, "sphere", LIGHTS["sphere"][1])
    before = light_of(scene)
    with pytest.raises(ValueError, match=f"^{message}"):
        setattr(light, name, value)
    np.testing.assert_array_equal(light_of(scene), before)
    with pytest.raises(AttributeError, match="a sphere light has no intensity but radiance"):
        _ = light.intensity


def test_handles_say_what_they_are() -> None:
    scene = empty_room()
    mesh = scene.add_mesh(SQUARE, FACES)
    assert repr(mesh) == "SceneMesh(index=2, 2 triangles, 1 instance)"
    light = add(scene, "sphere", {**LIGHTS["sphere"][1], "radiance": [1, 2, 3], "group": "key"})
    assert repr(light) == "Light(sphere, radiance=[1.0, 2.0, 3.0], group='key')"
    scene.set_environment([1, 1, 1])
    assert repr(scene) == "Scene(3 meshes, 1 light, an environment)"
    mesh.remove()
    assert repr(mesh) == "SceneMesh(removed)"


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_number_is_a_grey_light(kind: str) -> None:
    strength, arguments, _ = LIGHTS[kind]
    scene = shlight.Scene()
    lamp = getattr(scene, f"add_{kind}_light")(**{**arguments, strength: 2})
    assert getattr(lamp, strength).tolist() == [2, 2, 2]
    setattr(lamp, strength, 0.5)
    assert getattr(lamp, strength).tolist() == [0.5, 0.5, 0.5]


def test_a_number_is_grey_emission_and_a_grey_sky() -> None:
    pictures = []
    for grey in (0.7, [0.7] * 3):
        scene = shlight.Scene()
        scene.add_mesh(FLOOR, FACES, emission=grey)
        scene.set_environment(grey)
        scene.set_camera(shlight.look_at((0, -3, 2), (0, 0, 0)), 0.8)
        pictures.append(shlight.render(scene, 16, 9))
    np.testing.assert_array_equal(*pictures)
    assert pictures[0].min() > 0
