# SPDX-License-Identifier: MIT
"""What a view layer's filters and Simplify leave out, against Cycles, and what of negative worlds is left out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest


@pytest.mark.parametrize("switch", ["use_sky", "use_solid"])
@pytest.mark.parametrize("transparent", [False, True])
def test_filters_of_a_view_layer(studio: Any, switch: str, transparent: bool) -> None:
    studio.still_life()
    studio.camera()
    studio.world((0.3, 0.3, 0.3))
    studio.scene.render.film_transparent = transparent
    setattr(studio.scene.view_layers[0], switch, False)
    image, reference = studio.render("SHLIGHT"), studio.render("CYCLES")
    assert np.abs(image - reference).mean() <= 3e-3
    assert studio.messages() == [] or switch == "use_solid"


def field(studio: Any) -> None:
    """Boxes all around, which a low sun lets throw shadows into the picture; some of them are never culled."""
    studio.plane(60, material=studio.material(Color=(0.7, 0.7, 0.6)))
    random = np.random.default_rng(3)
    for i in range(100):
        place, size = random.uniform((-12, -12, 0.2), (12, 12, 1.5)), random.uniform(0.2, 0.8, 3)
        made = studio.box(size, location=place, rotation_euler=random.uniform(0, 3, 3))
        made.cycles.use_camera_cull, made.cycles.use_distance_cull = bool(i % 3), bool(i % 4)
    studio.lamp("SUN", 2, (0, 0, 5), angle=0.2, rotation_euler=(1.1, 0.6, 0.4))
    studio.camera((1, -4, 3.5), (0, 2, 0), shift_x=0.1)
    studio.scene.render.use_simplify = True


@pytest.mark.parametrize(
    ("culled", "kind"),
    [
        pytest.param("camera", "ORTHO", marks=pytest.mark.slow),
        pytest.param("camera", "PERSP", marks=pytest.mark.slow),
        pytest.param("distance", "ORTHO", marks=pytest.mark.slow),
        pytest.param("distance", "PERSP", marks=pytest.mark.slow),
        pytest.param("camera distance", "ORTHO", marks=pytest.mark.slow),
        ("camera distance", "PERSP"),
    ],
)
def test_simplify_leaves_out_what_cycles_does(studio: Any, kind: str, culled: str) -> None:
    field(studio)
    studio.resolution(64, 48)
    cycles, lens = studio.scene.cycles, studio.scene.camera.data
    lens.type, lens.ortho_scale = kind, 5.0
    cycles.camera_cull_margin, cycles.distance_cull_margin = 0.05, 7.0
    whole = studio.render("SHLIGHT")
    cycles.use_camera_cull, cycles.use_distance_cull = "camera" in culled, "distance" in culled
    image, reference = studio.compare(error=1e-3)
    assert np.abs(whole - reference).mean() > 3 * np.abs(image - reference).mean()


def test_simplify_limits_subdivision_and_not_textures(studio: Any) -> None:
    studio.lit_floor()
    made = studio.box(material=studio.material(), location=(0, 0, 0.5))
    modifier = made.modifiers.new("Subdivision", "SUBSURF")
    modifier.render_levels, studio.scene.render.simplify_subdivision_render = 3, 1
    studio.picture(np.zeros((8, 256, 3)))
    studio.scene.render.use_simplify, studio.scene.cycles.texture_limit_render = True, "128"
    studio.compare(error=1e-3)
    assert studio.messages() == ["Scene 'Scene': Simplify's Texture Limit is not supported; textures keep their size"]


def test_caustics_that_are_off_are_named(studio: Any) -> None:
    studio.lit_floor()
    studio.scene.cycles.caustics_reflective = studio.scene.cycles.caustics_refractive = False
    studio.scene.shlight.max_bounces = 1
    (message,) = studio.messages()
    assert message.endswith("Reflective and Refractive Caustics are off, which is not supported; they are drawn")


@pytest.mark.parametrize("source", ["strength", "pixels", "nodes"])
def test_negative_light_of_a_world_is_named(studio: Any, source: str) -> None:
    studio.lit_floor()
    background = studio.world((0.2, 0.3, 0.4), -1.0 if source == "strength" else 1.0)
    tree = background.id_data
    if source == "pixels":
        pixels = np.full((4, 8, 3), 0.5)
        pixels[2, 3] = -2.0
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = studio.picture(pixels)
        tree.links.new(node.outputs[0], background.inputs[0])
    elif source == "nodes":
        studio.scene.shlight.world_width = 64
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = "SUBTRACT"
        parts, place = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(place.outputs["Generated"], parts.inputs[0])
        tree.links.new(parts.outputs["Z"], node.inputs[0])
        tree.links.new(node.outputs[0], background.inputs["Strength"])
    text = "where it is negative, it takes light away in Cycles; it is black there"
    assert studio.messages() == [f"World 'World': {text}"]
    assert studio.render("SHLIGHT").min() >= 0
