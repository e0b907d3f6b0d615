# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that let light through, beside Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest


def curtain(studio: Any, color: Any, share: float) -> Any:
    """A material that lets light of `color` pass where it is not diffuse."""
    made = studio.material("ShaderNodeBsdfTransparent", Color=color)
    tree = made.node_tree
    clear, output = tree.nodes["Transparent BSDF"], tree.nodes["Material Output"]
    mixed, cloth = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mixed.inputs[0].default_value = share
    for i, shader in enumerate((clear, cloth), start=1):
        tree.links.new(shader.outputs[0], mixed.inputs[i])
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    return made


@pytest.mark.parametrize("bounces", [0, 1, 2, 8])
def test_layers_seen_up_to_the_limit(studio: Any, bounces: int) -> None:
    """Five layers before a light surface, of which a camera ray passes as many as Cycles lets it."""
    if bounces in (1, 2) and bpy.app.version >= (5, 0, 0):
        pytest.skip("camera rays pass one surface less from this version on")
    own = curtain(studio, (0.9, 0.7, 0.5), 0.3)
    for i in range(5):
        studio.plane(2.0, own, location=(0, 0, 0.3 * i))
    studio.plane(1.0, studio.material("ShaderNodeEmission", Color=(0.2, 0.6, 0.9)), location=(0, 0, -0.3))
    studio.lamp("POINT", 100, (0.5, -2, 4.0), shadow_soft_size=0.1, use_shadow=False)
    studio.camera((0, -0.5, 6), (0, 0, 0.4))
    studio.scene.cycles.transparent_max_bounces = bounces
    studio.compare(mean=5e-3, error=2e-3)


@pytest.mark.parametrize(("bounces", "is_passed"), [(0, True), (1, True), (8, True), (8, False)])
def test_coloured_shadows(studio: Any, bounces: int, is_passed: bool) -> None:
    studio.plane(material=studio.material())
    for i in range(3):
        own = curtain(studio, tuple(np.roll((0.9, 0.6, 0.2), i)), 0.2)
        switch = own if hasattr(own, "use_transparent_shadow") else own.cycles
        switch.use_transparent_shadow = is_passed
        studio.plane(1.0, own, location=(0.2 * i, 0, 1.0 + 0.2 * i))
    studio.area(150, (0.5, -0.5, 4.0), size=0.5)
    studio.camera((0, -7, 2.5), (0, 0, 0))
    studio.scene.cycles.transparent_max_bounces = bounces
    studio.compare(mean=5e-3, error=2e-3)


def test_light_that_only_the_camera_sees(studio: Any) -> None:
    """A mixture by Is Camera Ray: the plate glows but lights nothing, and casts no shadow."""
    studio.lit_floor()
    made = studio.material("ShaderNodeEmission", Color=(0.9, 0.5, 0.1), Strength=3.0)
    tree = made.node_tree
    mixed, clear = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mixed.inputs[0])
    tree.links.new(clear.outputs[0], mixed.inputs[1])
    tree.links.new(tree.nodes["Emission"].outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    studio.plane(1.0, made, location=(0, 0, 0.5))
    studio.compare()


@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="this version has no thin walls")
@pytest.mark.parametrize("kind", ["pane", "rough pane", "leaf", "rough leaf"])
def test_thin_walls(studio: Any, kind: str) -> None:
    """A pane that light passes and mirrors, and a leaf that shines on both sides, upright on a floor that glows."""
    inputs = {"Thin Wall": True, "Base Color": (0.9, 0.5, 0.3, 1.0), "Roughness": 0.0}
    if kind.endswith("pane"):
        inputs |= {"Transmission Weight": 1.0, "IOR": 1.8, "Specular Tint": (0.5, 1.0, 1.0, 1.0)}
    else:
        inputs |= {"Subsurface Weight": 0.8, "Subsurface Anisotropy": 0.3, "Roughness": 0.6}
    if kind == "rough pane":
        inputs["Roughness"] = 0.3
    if kind == "rough leaf":
        inputs["Diffuse Roughness"] = 0.5
    material = studio.material("ShaderNodeBsdfPrincipled")
    for name, value in inputs.items():
        material.node_tree.nodes["Principled BSDF"].inputs[name].default_value = value
    studio.plane(2.0, material, location=(0, 0, 0.6), rotation_euler=(1.2, 0, 0.4))
    glows = studio.material("ShaderNodeEmission", Strength=0.2)  # on which the pane throws nothing
    studio.plane(8.0, glows, location=(0, 0, -0.5))
    studio.area(150, (1.0, 2.0, 2.5), size=0.5)
    studio.camera((0.5, -5, 2), (0, 0, 0.3))
    bounces = 1 if kind.endswith("pane") else 0
    cycles = studio.scene.cycles
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    studio.scene.shlight.max_bounces, cycles.samples = bounces, 512
    messages = studio.messages()
    assert [line for line in messages if "thin wall" in line] == messages
    assert len(messages) == kind.startswith("rough")
    if not kind.startswith("rough"):
        studio.compare(mean=4e-3, error=1e-3)
