# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures at each input of the shaders, under each kind of light, beside Cycles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

LIGHTS = ("AREA", "SPHERE", "SUN", "WORLD")
# An input of Principled BSDF, the channel values between which its picture varies, and the node's other inputs.
INPUTS: dict[str, tuple[float, float, dict[str, Any]]] = {
    "Base Color": (0.05, 0.9, {"Roughness": 0.6}),
    "Roughness": (0.15, 0.9, {"Base_Color": (0.3, 0.2, 0.1)}),
    "Metallic": (0.0, 1.0, {"Base_Color": (0.9, 0.6, 0.2), "Roughness": 0.4}),
    "IOR": (1.2, 2.0, {"Roughness": 0.4, "Base_Color": (0.1, 0.1, 0.1)}),
    "Specular IOR Level": (0.0, 1.0, {"Roughness": 0.4, "Base_Color": (0.1, 0.1, 0.1)}),
    "Specular Tint": (0.2, 1.0, {"Metallic": 1.0, "Roughness": 0.4}),
    "Normal": (0.35, 0.65, {"Roughness": 0.5}),
    "Alpha": (0.0, 1.0, {}),
    "Coat Weight": (0.0, 1.0, {"Roughness": 0.8}),
    "Diffuse Roughness": (0.0, 1.0, {"Specular_IOR_Level": 0.0}),
    "Emission Strength": (0.0, 2.0, {"Emission_Color": (0.2, 0.9, 0.4)}),
}


def lit(studio: Any, light: str) -> None:
    if light == "AREA":
        studio.area()
    elif light == "SPHERE":
        studio.lamp("POINT", 60.0, (1.2, -1.0, 2.2), shadow_soft_size=0.4)
    elif light == "SUN":
        studio.lamp("SUN", 3.0, (0, 0, 3), rotation_euler=(0.5, 0.3, 0.0), angle=0.2)
    else:
        studio.world(color=(0.5, 0.6, 0.8))


@pytest.mark.parametrize(
    ("name", "distribution"),
    [
        pytest.param(name, distribution, marks=() if i % 2 == j or name == "Roughness" else pytest.mark.slow)
        for i, name in enumerate(INPUTS)
        for j, distribution in enumerate(("GGX", "MULTI_GGX"))
    ],
)
def test_a_picture_at_an_input(studio: Any, name: str, distribution: str) -> None:
    low, high, others = INPUTS[name]
    light = LIGHTS[list(INPUTS).index(name) % len(LIGHTS)]
    lit(studio, light)
    material = studio.material("ShaderNodeBsdfPrincipled", name="Varying", distribution=distribution, **others)
    tree = material.node_tree
    shader = tree.nodes["Principled BSDF"]
    if name not in shader.inputs:
        pytest.skip(f"this version has no input '{name}'")
    pixels = np.random.default_rng(7).uniform(low, high, (6, 6, 3))
    if name == "Normal":
        pixels[..., 2] = 0.95
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = studio.picture(pixels, is_float=True)
    output = node.outputs["Color"]
    if name == "Normal":
        bent = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(output, bent.inputs["Color"])
        output = bent.outputs["Normal"]
    tree.links.new(output, shader.inputs[name])
    plane = studio.plane(material=material)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for loop, place in zip(plane.data.uv_layers.new(name="UVMap").data, corners, strict=True):
        loop.uv = place
    studio.plane(location=(0, 0, -0.6))
    studio.camera()
    studio.resolution(36, 27)
    studio.compare(mean=5e-3, error=2e-3)
