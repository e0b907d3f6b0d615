# SPDX-License-Identifier: MIT
"""Lamps and emissive meshes that are instanced or parented: place, orientation and power as in Cycles."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest

KINDS: dict[str, dict[str, Any]] = {
    "AREA": {"energy": 60, "shape": "RECTANGLE", "size": 0.9, "size_y": 0.4},
    "POINT": {"energy": 40, "shadow_soft_size": 0.3, "use_soft_falloff": False},
    "SPOT": {"energy": 150, "shadow_soft_size": 0.1, "spot_size": 0.9, "spot_blend": 0.6},
    "SUN": {"energy": 2, "angle": 0.3},
}
SLOW = pytest.mark.slow
QUICK_KINDS = [kind if kind == "SPOT" else pytest.param(kind, marks=SLOW) for kind in KINDS]
QUARTER = math.pi / 2
# Location, rotation and scale of what carries the lamp.
PLACES: dict[str, tuple[Any, Any, Any]] = {
    "turned": ((-0.4, 0.3, 1.6), (0.5, -0.4, 0.7), (1, 1, 1)),
    "scaled": ((0.3, -0.2, 1.7), (-0.4, 0.3, 0.2), (1.5, 0.6, 0.8)),
    "mirrored": ((0.1, 0.4, 1.6), (0.3, 0.5, 1.2), (-1.2, 0.8, 1)),
    "upside_down": ((0.2, 0.2, 1.6), (math.pi - 0.3, 0.2, 0.4), (1, 1, -1)),
}


def stage(studio: Any) -> None:
    """A floor, a ball and a camera."""
    material = studio.material(Color=(0.8, 0.6, 0.4))
    studio.plane(6.0, material)
    studio.ball(0.45, material, location=(-0.6, 0.2, 0.45))
    studio.camera(location=(2.0, -4.0, 3.0))
    studio.resolution(40, 40)


def lamp(studio: Any, kind: str) -> Any:
    values = dict(KINDS[kind])
    return studio.lamp(kind, values.pop("energy"), (0, 0, 0), **values)


def collection_of(studio: Any, *objects: Any, name: str = "Lights") -> Any:
    """The objects in a collection that is not part of the scene."""
    collection = bpy.data.collections.new(name)
    for thing in objects:
        studio.scene.collection.objects.unlink(thing)
        collection.objects.link(thing)
    return collection


def place_instance(studio: Any, collection: Any, place: str) -> Any:
    """An empty that shows the collection."""
    location, rotation, scale = PLACES[place]
    empty = studio.link("Instance", None, location, rotation_euler=rotation, scale=scale, instance_type="COLLECTION")
    empty.instance_collection = collection
    return empty


@pytest.mark.parametrize(
    ("kind", "place"),
    [
        pytest.param(kind, place, marks=() if (kind, place) in {("AREA", "mirrored"), ("SPOT", "scaled")} else SLOW)
        for kind in KINDS
        for place in PLACES
    ],
)
def test_lamp_in_a_collection_instance(studio: Any, kind: str, place: str) -> None:
    stage(studio)
    inside = lamp(studio, kind)
    # Area lamps are turned so that the scale of the instance does not shear them.
    inside.location, inside.rotation_euler = (0.2, 0.1, 0.1), (0, 0, QUARTER) if kind == "AREA" else (0.2, -0.1, 0.3)
    place_instance(studio, collection_of(studio, inside), place)
    studio.scene.cycles.use_light_tree = False  # it bounds the cone of a sheared spot lamp too tightly
    studio.compare(mean=3e-3, error=3e-3)
    assert studio.messages() == []


@pytest.mark.parametrize("kind", [pytest.param("POINT", marks=SLOW), "SPOT", pytest.param("SUN", marks=SLOW)])
def test_lamp_sheared_by_its_parent(studio: Any, kind: str) -> None:
    stage(studio)
    parent = studio.link("Parent", None, (0.2, 0.1, 1.7), rotation_euler=(0.2, 0.1, 0.3), scale=(1.6, 0.7, 1))
    child = lamp(studio, kind)
    child.parent, child.rotation_euler = parent, (0.4, 0.2, 0.5)
    studio.scene.cycles.use_light_tree = False  # it bounds the cone of a sheared spot lamp too tightly
    studio.compare(mean=3e-3, error=3e-3)
    assert studio.messages() == []


def test_a_sheared_area_lamp_is_named(studio: Any) -> None:
    stage(studio)
    inside = lamp(studio, "AREA")
    inside.rotation_euler = (0.2, -0.1, 0.5)
    place_instance(studio, collection_of(studio, inside), "scaled")
    (line,) = studio.messages()
    assert line.startswith("Light 'Area': sheared area lamps")


def test_nested_instances(studio: Any) -> None:
    stage(studio)
    inner = collection_of(studio, lamp(studio, "AREA"), lamp(studio, "SPOT"))
    middle = place_instance(studio, inner, "mirrored")
    middle.location, middle.rotation_euler = (0.2, 0, 0), (0, 0, QUARTER)
    outer = collection_of(studio, middle, name="Outer")
    place_instance(studio, outer, "scaled")
    studio.compare(mean=3e-3, error=3e-3)


CORNERS = [(-1, 0, 1.6), (0.8, -0.2, 1.5), (0.3, 1, 1.8)]


def on_points(studio: Any, collection: Any) -> None:
    """The collection on three points, turned and mirrored, by geometry nodes."""

    def instances(tree: Any) -> Any:
        node = tree.nodes.new("GeometryNodeCollectionInfo")
        node.inputs["Collection"].default_value = collection
        return node.outputs["Instances"]

    studio.on_points(CORNERS, [], instances, Scale=(1.0, 0.7, -1.3), Rotation=(math.pi - 0.3, 0.2, 0.5))


@pytest.mark.slow
@pytest.mark.parametrize("kind", QUICK_KINDS)
def test_lamps_of_geometry_nodes(studio: Any, kind: str) -> None:
    stage(studio)
    on_points(studio, collection_of(studio, lamp(studio, kind)))
    studio.compare(mean=3e-3, error=3e-3)
    assert studio.messages() == []


@pytest.mark.parametrize("instance_type", ["VERTS", "FACES"])
def test_lamps_of_a_parent_with_instances(studio: Any, instance_type: str) -> None:
    stage(studio)
    host = studio.mesh("Host", CORNERS, [(0, 1, 2)], instance_type=instance_type, show_instancer_for_render=False)
    lamp(studio, "AREA").parent = host
    studio.compare(mean=3e-3, error=3e-3)


def glowing(studio: Any, name: str = "Glow") -> Any:
    emission = studio.material("ShaderNodeEmission", Color=(1.0, 0.6, 0.3), Strength=12.0)
    return studio.box((0.3, 0.6, 0.1), emission, name=name)


def test_emissive_meshes_of_geometry_nodes(studio: Any) -> None:
    stage(studio)
    on_points(studio, collection_of(studio, glowing(studio)))
    studio.scene.shlight.pixel_samples = 64
    studio.compare(mean=3e-3, error=5e-3)
    assert studio.messages() == []


@pytest.mark.parametrize(
    ("flag", "carrier"),
    [
        pytest.param(flag, carrier, marks=() if i % 2 == j else SLOW)
        for i, flag in enumerate(("visible_diffuse", "visible_glossy", "visible_shadow", "visible_camera"))
        for j, carrier in enumerate(("instancer", "lamp"))
    ],
)
def test_ray_visibility(studio: Any, flag: str, carrier: str) -> None:
    """An object that shows a lamp can also hide it from Blender 4.5 on."""
    stage(studio)
    inside = lamp(studio, "AREA")
    inside.visible_camera = flag == "visible_camera"
    empty = place_instance(studio, collection_of(studio, inside), "turned")
    setattr(empty if carrier == "instancer" else inside, flag, False)
    image, reference = (studio.render(engine)[..., :3] for engine in ("SHLIGHT", "CYCLES"))
    if flag == "visible_diffuse" and (carrier == "lamp" or bpy.app.version >= (4, 5, 0)):
        assert not image.any()
        assert not reference.any()
        return
    assert image.mean() == pytest.approx(reference.mean(), rel=3e-3)
    assert studio.messages() == []


def test_portals_give_no_light(studio: Any) -> None:
    stage(studio)
    portal = lamp(studio, "AREA")
    portal.location, portal.data.cycles.is_portal = (0.5, 0, 1.0), True
    lamp(studio, "POINT").location = (0, 0, 1.8)
    # A grey one: Cycles 5.2 crashes on portals without a world.
    studio.scene.world = bpy.data.worlds.new("World")
    image, _ = studio.compare(mean=3e-3, error=3e-3)
    assert studio.messages() == []
    np.testing.assert_array_equal(image[..., :3].max() > 0, True)


@pytest.mark.parametrize("node", ["ShaderNodeTexCoord/Generated", "ShaderNodeTexCoord/UV", "ShaderNodeUVMap/UV"])
def test_what_shines_by_its_place_on_the_instancer(studio: Any, node: str) -> None:
    """Each card has one colour, of the place where a particle has it; what nothing instances has none."""
    stage(studio)
    corners = [*CORNERS, (-0.4, -1.0, 1.7)]
    host = studio.mesh("Host", corners, [(0, 1, 2), (1, 0, 3)], show_instancer_for_render=False)
    places = [(0.9, 0.2), (0.6, 0.8), (0.1, 0.4), (0.3, 0.9), (0.2, 0.7), (0.8, 0.5)]
    host.data.uv_layers.new().data.foreach_set("uv", np.ravel(places))
    name, output = node.split("/")
    glow = studio.material("ShaderNodeEmission", name="Glow", Strength=9.0)
    tree = glow.node_tree
    own, up = tree.nodes.new(name), tree.nodes.new("ShaderNodeVectorMath")
    own.from_instancer, up.inputs[1].default_value = True, (1.1, 1.1, 1.1)
    tree.links.new(own.outputs[output], up.inputs[0])
    tree.links.new(up.outputs[0], tree.nodes["Emission"].inputs["Color"])
    card = studio.box((0.3, 0.4, 0.02), glow)
    alone = card.copy()
    alone.location = (1.0, 1.0, 0.4)
    studio.scene.collection.objects.link(alone)
    particles = host.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    particles.type, particles.render_type, particles.count = "HAIR", "OBJECT", 6
    particles.instance_object, particles.particle_size, particles.hair_length = card, 1.0, 1.0
    studio.scene.shlight.pixel_samples = 64
    studio.compare(mean=3e-3, error=1e-2)  # the edges of bright cards
    assert studio.messages() == []
