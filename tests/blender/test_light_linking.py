# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that light some objects, and are blocked by some, beside Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import pytest

from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of

pytestmark = pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="this Blender has no light linking")
SLOW = pytest.mark.slow
LIGHTS = ("AREA", "POINT", "SPOT", "SUN", "SHARP", "PLATE", "BALL")


def collection(role: str, light: Any, objects: Any, state: str = "INCLUDE", through: bool = False) -> Any:
    """Gives a light a collection of objects, or of one collection that has them."""
    made = bpy.data.collections.new(role)
    setattr(light.light_linking, role, made)
    if through:
        inner = bpy.data.collections.new("Inner")
        made.children.link(inner)
        made.collection_children[0].light_linking.link_state = state
        for each in objects:
            inner.objects.link(each)
        return made
    for each in objects:
        made.objects.link(each)
        made.collection_objects[-1].light_linking.link_state = state
    return made


def add_light(studio: Any, kind: str) -> Any:
    glow = studio.material("ShaderNodeEmission", "Glow", Color=(1, 0.7, 0.4), Strength=12.0)
    if kind == "PLATE":
        return studio.plane(0.8, glow, kind, location=(0.5, -1, 2.6))
    if kind == "BALL":
        return studio.ball(0.4, glow, location=(0.5, -1, 2.6), rings=8)
    if kind in {"SUN", "SHARP"}:
        angle = 0.2 if kind == "SUN" else 0.0
        return studio.lamp("SUN", 3, (0, 0, 3), angle=angle, rotation_euler=(0.5, 0.3, 0))
    shape = {"size": 0.8} if kind == "AREA" else {"shadow_soft_size": 0.3}
    spot = {"spot_size": 2.0} if kind == "SPOT" else {}
    return studio.lamp(kind, 150, (0.5, -1, 3), **shape, **spot)


def stage(studio: Any, kinds: tuple[str, ...], bounces: int) -> tuple[list[Any], dict[str, Any]]:
    """Lights over a floor with boxes: without bounces, which are noise in Cycles, one is glossy and one a mirror."""
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    shiny = studio.material("ShaderNodeBsdfAnisotropic", "Shiny", Color=(0.9, 0.8, 0.7), Roughness=0.4)
    mirror = studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Color=(0.9, 0.9, 0.9), Roughness=0.0)
    if bounces > 0:
        shiny = mirror = white
    objects = {
        "floor": studio.plane(8, white, "floor"),
        "box": studio.box((0.6, 0.6, 1.2), white, "box", location=(-1, 0, 0.6)),
        "shiny": studio.box((0.7, 0.7, 0.8), shiny, "shiny", location=(0.3, 0.3, 0.4)),
        "wall": studio.box((3, 0.1, 2), mirror, "wall", location=(0.5, 1.5, 1)),
        "post": studio.box((0.3, 0.3, 1.6), white, "post", location=(1.4, -0.6, 0.8)),
    }
    lights = [add_light(studio, kind) for kind in kinds]
    studio.plain_world((0.05, 0.06, 0.08))
    studio.camera((1.5, -6, 3.5), (0, 0, 0.6), lens=45)
    studio.scene.shlight.max_bounces = bounces
    studio.resolution(48, 32)
    use_cycles(studio.scene, 512, 0, bounces_of(studio.scene))
    return lights, objects


@pytest.mark.parametrize("bounces", [0, pytest.param(2, marks=SLOW)])
@pytest.mark.parametrize("kind", [pytest.param(own, marks=() if own == "SHARP" else SLOW) for own in LIGHTS])
def test_a_light_lights_some_objects_and_others_shadow_it(studio: Any, kind: str, bounces: int) -> None:
    (light,), objects = stage(studio, (kind,), bounces)
    studio.scene.cycles.samples = 1024
    whole = studio.render("SHLIGHT")
    collection("receiver_collection", light, [objects["box"], objects["post"]], "EXCLUDE", through=kind == "SUN")
    own = [light] if kind == "BALL" else []  # Cycles' rays from its far side would come through it
    collection("blocker_collection", light, [objects["box"], objects["shiny"], *own], through=kind == "AREA")
    image, _ = studio.compare(mean=8e-3 if bounces else 2e-3, error=2e-3)
    assert abs(image - whole).mean() > 3e-3
    assert studio.messages(most=99) == []


def test_many_lights_with_links_of_their_own(studio: Any) -> None:
    lights, objects = stage(studio, LIGHTS, 0)
    names = list(objects)
    for i, light in enumerate(lights):
        for name, shift in (("receiver_collection", 0), ("blocker_collection", 2)):
            state = "EXCLUDE" if (i + shift) % 3 == 0 else "INCLUDE"
            own = [light] if state == "INCLUDE" and light.type == "MESH" and shift else []
            collection(name, light, [objects[names[(i + shift + j) % 5]] for j in range(3)] + own, state)
    # Cycles draws one of the lights: the rest is its noise.
    studio.compare(mean=5e-3, error=1e-2)
    assert studio.messages(most=99) == []


@pytest.mark.parametrize("is_owner", [True, False])
def test_the_object_that_shows_an_instance_has_its_links(studio: Any, is_owner: bool) -> None:
    (light,), objects = stage(studio, ("AREA",), 0)
    own = bpy.data.collections.new("Own")
    studio.scene.collection.children.link(own)
    studio.scene.collection.objects.unlink(objects["box"])
    own.objects.link(objects["box"])
    shows = studio.link("Shows", None, (-1, -1.5, 0), instance_type="COLLECTION", instance_collection=own)
    collection("receiver_collection", light, [shows if is_owner else objects["box"]], "EXCLUDE")
    studio.compare(mean=5e-3, error=4e-3)


def test_what_collections_say_of_an_object_twice(studio: Any) -> None:
    """Objects of a light's collection come after those of the collections in it."""
    (light,), objects = stage(studio, ("AREA",), 0)
    made = collection("receiver_collection", light, [objects["floor"], objects["box"]], through=True)
    made.objects.link(objects["box"])
    made.collection_objects[0].light_linking.link_state = "EXCLUDE"
    studio.compare(mean=5e-3, error=4e-3)


def test_more_sets_than_there_can_be_are_named(studio: Any) -> None:
    studio.lit_floor()
    for i in range(30):
        lamp = studio.area(1, (i, 0, 3))
        collection("blocker_collection", lamp, [studio.box(name=f"Box {i}")])
    assert [line for line in studio.messages(most=99) if "28 of blockers" in line]
