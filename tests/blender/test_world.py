# SPDX-License-Identifier: MIT
"""The world as light and background, against Cycles."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender import record
from shlight_blender.export.nodes import Surroundings
from shlight_blender.export.world import world_of_nodes
from shlight_blender.report import Effect, ExportReport


def balls(studio: Any) -> None:
    """A diffuse and a glossy ball on a floor."""
    studio.plane(material=studio.material(Color=(0.7, 0.6, 0.5)))
    studio.ball(material=studio.material(Color=(0.8, 0.5, 0.3)), rings=32, location=(-1.1, 0, 1))
    glossy = studio.material("ShaderNodeBsdfAnisotropic", Color=(0.9, 0.8, 0.6), Roughness=0.5, distribution="GGX")
    studio.ball(material=glossy, rings=32, location=(1.1, 0, 1))
    studio.camera(target=(0, 0, 0.8))


def test_constant_world(studio: Any) -> None:
    balls(studio)
    studio.world((0.4, 0.6, 1.0), 1.5)
    image, _ = studio.compare(error=1e-3)
    assert studio.messages() == []
    np.testing.assert_array_equal(image[..., 3], 1)


@pytest.mark.parametrize("transparent", [True, False])
def test_world_without_nodes_and_film(studio: Any, transparent: bool) -> None:
    studio.ball(material=studio.material(Color=(0.8, 0.5, 0.3)), rings=32)
    studio.camera()
    studio.plain_world((0.2, 0.4, 0.6))
    studio.scene.render.film_transparent = transparent
    image, _ = studio.compare(error=1e-3, alpha=2e-3)
    corner = image[0, 0]
    np.testing.assert_allclose(corner, (0, 0, 0, 0) if transparent else (0.2, 0.4, 0.6, 1), rtol=1e-6)


def test_the_world_of_a_view_layer(studio: Any) -> None:
    layer = bpy.context.view_layer
    if not hasattr(layer, "world_override"):
        pytest.skip("view layers of this version of Blender have no world")
    balls(studio)
    studio.world((0.1, 0.6, 0.2), 1.5)
    layer.world_override = studio.scene.world
    studio.world((0.9, 0.3, 0.2))
    studio.compare(error=1e-3)


# --- pictures

WORLDS = Path(bpy.utils.system_resource("DATAFILES")) / "studiolights" / "world"
NAMES = ["city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"]
QUICK = {("sunrise", True)}


def set_picture(studio: Any, image: Any, *turns: tuple[float, float, float]) -> Any:
    """A world with an Environment Texture of `image`; returns its node."""
    background = studio.world((0, 0, 0))
    tree = studio.scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    if turns:
        directions = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
        for turn in turns:
            mapping = tree.nodes.new("ShaderNodeMapping")
            mapping.inputs["Rotation"].default_value = turn
            tree.links.new(directions, mapping.inputs["Vector"])
            directions = mapping.outputs["Vector"]
        tree.links.new(directions, texture.inputs["Vector"])
    return texture


def gradient(width: int = 32, height: int = 16) -> Any:
    """A small picture in which no two directions are alike."""
    image = bpy.data.images.new("Gradient", width, height, float_buffer=True)
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    red = 0.2 + (np.cos(2 * np.pi * u) + 1) * np.sin(np.pi * v)
    green = 0.1 + (np.sin(2 * np.pi * u) + 1) * np.sin(np.pi * v)
    image.pixels.foreach_set(np.stack([red, green, v, np.ones_like(u)], -1).astype(np.float32).ravel())
    return image


SLOW_KINDS = [pytest.param(kind, marks=pytest.mark.slow) for kind in ("NORMAL", "TEXTURE", "VECTOR")]


@pytest.mark.parametrize("kind", ["", "POINT", *SLOW_KINDS])
def test_orientation_of_a_picture(studio: Any, kind: str) -> None:
    """The picture alone, and rotated by two Mapping nodes, the last one of each kind."""
    studio.ball_in_view_of_the_world()
    texture = set_picture(studio, gradient(), *([(0.3, 0, 1.0), (0.4, -0.7, 2.0)] if kind else []))
    if kind:
        texture.inputs["Vector"].links[0].from_node.vector_type = kind
    studio.compare(mean=2e-3, error=1e-3)
    assert studio.messages() == []


def test_pictures_of_bytes_and_strength(studio: Any) -> None:
    studio.ball_in_view_of_the_world()
    # In steps so small that it does not matter that Cycles interpolates before it undoes the colour space.
    image = bpy.data.images.new("Bytes", 128, 64)
    u, v = np.meshgrid((np.arange(128) + 0.5) / 128, (np.arange(64) + 0.5) / 64)
    wave = 0.5 + 0.4 * np.cos(2 * np.pi * u)
    image.pixels.foreach_set(np.stack([wave, 1 - wave, v, 0.6 + 0.4 * v], -1).astype(np.float32).ravel())
    texture = set_picture(studio, image)
    texture.outputs["Color"].links[0].to_node.inputs["Strength"].default_value = 3.0
    studio.compare(mean=1.5e-2, error=1e-3)  # Cycles multiplies by alpha in bytes


@pytest.mark.parametrize(
    ("name", "floor"),
    [
        pytest.param(name, floor, marks=[] if (name, floor) in QUICK else [pytest.mark.slow])
        for name in NAMES
        for floor in (False, True)
    ],
)
def test_real_pictures(studio: Any, name: str, floor: bool) -> None:
    image = bpy.data.images.load(str(WORLDS / f"{name}.exr"))
    if (name, floor) in QUICK:
        studio.resolution(40, 30)
    studio.scene.cycles.samples = 1024 if (name, floor) in QUICK else 2048
    studio.scene.render.film_transparent = True  # what is seen behind is not the question
    if floor:
        balls(studio)
    else:
        studio.ball(material=studio.material(Color=(0.8, 0.5, 0.3)), rings=48, location=(-1.1, 0, 0))
        glossy = studio.material("ShaderNodeBsdfAnisotropic", Color=(0.9, 0.8, 0.6), Roughness=0.5, distribution="GGX")
        studio.ball(material=glossy, rings=48, location=(1.1, 0, 0))
        studio.camera((0, -6, 1), (0, 0, 0))
    set_picture(studio, image)
    studio.scene.world.cycles.sampling_method = "AUTOMATIC"  # its sun is small
    studio.compare(error=1e-3)


def world_program(studio: Any, width: int) -> Any:
    """The picture that the world's program makes."""
    world, report = studio.scene.world, ExportReport()
    found = world_of_nodes(world, "World", width, Surroundings(), report)
    assert report.lines() == []
    return found.radiance


def through_a_mapping(texture: Any, kind: str) -> None:
    """Directions that are turned, shifted and stretched."""
    mapping = texture.inputs["Vector"].links[0].from_node
    mapping.vector_type = kind
    mapping.inputs["Scale"].default_value = (1, 2, 1)
    if "Location" in mapping.inputs:
        mapping.inputs["Location"].default_value = (0.3, 0.2, -0.1)


def through_a_mirror_ball(texture: Any) -> None:
    texture.projection = "MIRROR_BALL"


def through_closest_texels(texture: Any) -> None:
    texture.interpolation = "Closest"


def by_a_gradient(texture: Any) -> None:
    """Mixed with another background by a gradient around z."""
    tree = texture.id_data
    gradient = tree.nodes.new("ShaderNodeTexGradient")
    gradient.gradient_type = "RADIAL"
    mix, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBackground")
    other.inputs["Color"].default_value = (0.2, 0.5, 0.9, 1)
    tree.links.new(gradient.outputs["Fac"], mix.inputs["Fac"])
    tree.links.new(texture.outputs["Color"].links[0].to_node.outputs[0], mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])


def by_what_looks(texture: Any) -> None:
    """Position, Normal and Incoming of a world, which are the direction and its opposite."""
    tree = texture.id_data
    geometry, sums = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeVectorMath")
    sums.operation = "MULTIPLY_ADD"
    for i, name in enumerate(("Position", "Normal", "Incoming")):
        tree.links.new(geometry.outputs[name], sums.inputs[i])
    tree.links.new(sums.outputs[0], texture.outputs["Color"].links[0].to_node.inputs["Color"])


@pytest.mark.parametrize(
    "change",
    [
        *(partial(through_a_mapping, kind=kind) for kind in ("POINT", "NORMAL", "TEXTURE", "VECTOR")),
        through_a_mirror_ball,
        through_closest_texels,
        by_a_gradient,
        by_what_looks,
    ],
)
def test_programs_of_worlds_against_cycles(studio: Any, change: Callable[[Any], None]) -> None:
    change(set_picture(studio, gradient(), (0.4, -0.7, 2.0)))
    studio.all_around(256)
    studio.scene.cycles.samples = 16
    studio.scene.world.cycles.sampling_method = "NONE"  # which takes Cycles time to prepare
    seen = studio.render("CYCLES")[..., :3]
    # Cycles draws 16 places of a texel, and one is looked at here: at edges between closest texels they differ.
    assert np.abs(world_program(studio, 256) - seen).mean() <= 0.01 * np.abs(seen).mean()


@pytest.mark.parametrize(("kind", "name"), [("VIEW_LAYER", "tint"), ("OBJECT", "tint"), ("GEOMETRY", "Col")])
def test_attributes_of_a_world(studio: Any, kind: str, name: str) -> None:
    """A view layer's are read from it or the scene; a world has no others."""
    studio.ball_in_view_of_the_world()
    background = studio.world()
    tree = background.id_data
    node, sum_of = tree.nodes.new("ShaderNodeAttribute"), tree.nodes.new("ShaderNodeVectorMath")
    node.attribute_type, node.attribute_name = kind, name
    sum_of.inputs[1].default_value = (0.1, 0.2, 0.3)
    studio.scene["tint"] = (0.2, 0.5, 0.9)
    tree.links.new(node.outputs["Color"], sum_of.inputs[0])
    tree.links.new(sum_of.outputs[0], background.inputs["Color"])
    studio.compare(error=1e-3)
    assert studio.messages() == []


def test_a_node_that_is_not_supported_is_named(studio: Any) -> None:
    studio.plane()
    studio.area()
    studio.camera()
    texture = set_picture(studio, gradient())
    tree = studio.scene.world.node_tree
    tree.links.new(tree.nodes.new("ShaderNodePointInfo").outputs[0], texture.inputs["Vector"])
    (message,) = studio.messages()
    assert "World 'World', node 'Point Info': Point Info is not supported" in message


def test_light_that_misses_the_tolerance_is_told(studio: Any) -> None:
    """Narrow reflections of a picture of noise; in the report's part for what is hardly seen."""
    studio.ball(material=studio.material("ShaderNodeBsdfPrincipled", Roughness=0.3), rings=32)
    studio.camera()
    background = studio.world()
    tree = background.id_data
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = studio.picture(np.random.default_rng(1).gamma(0.1, size=(64, 128, 3)))
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    studio.render("SHLIGHT")
    (message,) = record.last.report
    assert "less exact than Tolerance" in message.text
    assert message.effect == Effect.SLIGHT
    studio.scene.shlight.tolerance = 0.5
    studio.render("SHLIGHT")
    assert len(record.last.report) == 0
