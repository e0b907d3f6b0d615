# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals, sheen, microfacets of other distributions and of two widths: as bright as in Cycles under each light."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
import pytest

GOLD = (1.0, 0.78, 0.34)
METAL = "ShaderNodeBsdfMetallic"
GLOSSY = "ShaderNodeBsdfAnisotropic"
SHEEN = "ShaderNodeBsdfSheen"
PRINCIPLED = "ShaderNodeBsdfPrincipled"

CASES: dict[str, tuple[str, dict[str, Any]]] = {
    **{
        f"metal_{r:g}": (METAL, {"Base_Color": GOLD, "Edge_Tint": (0.9, 0.6, 0.5), "Roughness": r})
        for r in (0.3, 0.5, 1.0)
    },
    "metal_ggx": (METAL, {"Base_Color": GOLD, "Edge_Tint": (0.4, 0.6, 1.0), "Roughness": 0.4, "distribution": "GGX"}),
    "metal_edge_0": (METAL, {"Base_Color": (0.5, 0.5, 0.5), "Edge_Tint": (0.0, 0.0, 0.0)}),
    "metal_dark": (METAL, {"Base_Color": (0.1, 0.1, 0.1), "Edge_Tint": (0.5, 1.0, 1.0)}),
    "metal_beckmann": (METAL, {"Base_Color": GOLD, "Edge_Tint": (0.5, 1, 1), "distribution": "BECKMANN"}),
    "conductor": (METAL, {"fresnel_type": "PHYSICAL_CONDUCTOR"}),
    "conductor_gold": (
        METAL,
        {"fresnel_type": "PHYSICAL_CONDUCTOR", "IOR": (0.18, 0.42, 1.37), "Extinction": (3.42, 2.35, 1.77),
         "distribution": "GGX", "Roughness": 0.3},
    ),
    "conductor_edges": (
        METAL,
        {"fresnel_type": "PHYSICAL_CONDUCTOR", "IOR": (0.0, 0.5, 1.0), "Extinction": (1.0, 0.5, 1.0), "Roughness": 1.0},
    ),
    **{f"beckmann_{r:g}": (GLOSSY, {"Roughness": r, "distribution": "BECKMANN"}) for r in (0.3, 0.5, 1.0)},
    **{f"shirley_{r:g}": (GLOSSY, {"Roughness": r, "distribution": "ASHIKHMIN_SHIRLEY"}) for r in (0.3, 0.5, 1.0)},
    **{
        f"brushed_{a:g}_{turns:g}": (
            PRINCIPLED,
            {"Base_Color": GOLD, "Metallic": 1.0, "Roughness": 0.4, "Anisotropic": a, "Anisotropic_Rotation": turns},
        )
        for a, turns in ((0.5, 0.0), (1.0, 0.0), (1.0, 0.15))
    },
    "brushed_dielectric": (PRINCIPLED, {"Roughness": 0.3, "Anisotropic": 0.8, "Coat_Weight": 0.5, "IOR": 2.0}),
    **{
        f"glossy_{a:g}_{kind}": (GLOSSY, {"Roughness": 0.5, "Anisotropy": a, "Rotation": 0.1, "distribution": kind})
        for a, kind in ((0.5, "GGX"), (-0.5, "MULTI_GGX"), (0.9, "GGX"), (0.5, "BECKMANN"), (-0.7, "ASHIKHMIN_SHIRLEY"))
    },
    "metal_brushed": (METAL, {"Base_Color": GOLD, "Edge_Tint": (0.9, 0.6, 0.5), "Anisotropy": 0.7, "Rotation": 0.2}),
    "conductor_brushed": (METAL, {"fresnel_type": "PHYSICAL_CONDUCTOR", "Anisotropy": 1.0, "distribution": "BECKMANN"}),
    "glass_beckmann": ("ShaderNodeBsdfGlass", {"Roughness": 0.5, "distribution": "BECKMANN"}),
    **{f"fibres_{r:g}": (SHEEN, {"Roughness": r, "distribution": "MICROFIBER"}) for r in (0.5, 1.0)},
    **{f"velvet_{r:g}": (SHEEN, {"Roughness": r, "distribution": "ASHIKHMIN"}) for r in (0.3, 0.5, 1.0)},
    **{
        f"sheen_{w:g}_{r:g}": (
            PRINCIPLED,
            {"Base_Color": (0.5, 0.1, 0.2), "Sheen_Weight": w, "Sheen_Roughness": r, "Sheen_Tint": (0.7, 0.9, 1.0)},
        )
        for w, r in ((0.5, 0.5), (1.0, 0.0), (1.0, 0.3), (1.0, 1.0))
    },
}  # fmt: skip
LIGHTS = ("area", "sphere", "sun", "sky")


def light_up(studio: Any, light: str) -> None:
    """One light of a kind."""
    if light == "area":
        studio.area(150, (1.5, -2, 3), shape="RECTANGLE", size=1.2, size_y=0.8, rotation_euler=(-0.5, 0.3, 0))
    elif light == "sphere":
        studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6, use_soft_falloff=False)
    elif light == "sun":
        studio.lamp("SUN", 3, (0, 0, 5), angle=0.2, rotation_euler=(0.8, 0.5, 0))
    else:
        width, height = 32, 16
        glow = np.full((height, width, 3), (0.1, 0.15, 0.3))
        glow[9:13, 4:8] = (30.0, 25.0, 15.0)
        glow[6:14, 20:29] = (2.0, 2.5, 3.0)
        background = studio.world()
        tree = background.id_data
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = studio.picture(glow)
        tree.links.new(node.outputs[0], background.inputs["Color"])


def cases() -> Iterator[Any]:
    """All lobes and lights; each lobe once among the quick ones, but brushed ones, which take long, not under the sky.

    Cycles shows the sky through glass without bounces.
    """
    for i, (case, light) in enumerate(itertools.product(CASES, LIGHTS)):
        if (case, light) == ("glass_beckmann", "sky"):
            continue
        own = (i // len(LIGHTS)) % len(LIGHTS)
        quick = i % len(LIGHTS) == (0 if "brushed" in case and own == LIGHTS.index("sky") else own)
        yield pytest.param(case, light, marks=() if quick else pytest.mark.slow)


@pytest.mark.parametrize(("case", "light"), list(cases()))
def test_as_bright_as_in_cycles(studio: Any, case: str, light: str) -> None:
    shader, inputs = CASES[case]
    if not hasattr(bpy.types, shader):
        pytest.skip(f"this version of Blender has no {shader}")
    rough = inputs.get("Roughness", 0.5) >= 0.4 and abs(inputs.get("Anisotropy", 0.0)) <= 0.7
    compare(studio, studio.material(shader, **inputs), light, rough=rough)


@pytest.mark.parametrize("light", ["area", *(pytest.param(light, marks=pytest.mark.slow) for light in LIGHTS[1:])])
def test_anisotropy_and_tangents_may_vary(studio: Any, light: str) -> None:
    """Noise decides how anisotropic and how rough a metal is, and a vector along what."""
    material = studio.material(PRINCIPLED, Base_Color=GOLD, Metallic=1.0)
    tree = material.node_tree
    node = next(each for each in tree.nodes if each.type == "BSDF_PRINCIPLED")
    noise, tangent = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeCombineXYZ")
    noise.inputs["Scale"].default_value = 2.0
    for name, value in (("X", 0.3), ("Y", 0.8), ("Z", 0.2)):
        tangent.inputs[name].default_value = value
    for name in ("Anisotropic", "Anisotropic Rotation", "Roughness"):
        tree.links.new(noise.outputs[0], node.inputs[name])
    tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
    compare(studio, material, light, rough=False)


def compare(studio: Any, material: Any, light: str, *, rough: bool) -> None:
    studio.plane(6.0, material)
    studio.ball(1.0, material, location=(0, 0, 1.1), rings=24)
    light_up(studio, light)
    studio.camera()
    studio.resolution(32, 24)
    # The mean of narrow highlights, which are a few pixels, has noise of 0.4 % at 1024 samples.
    studio.scene.cycles.samples = 1024 if rough else 8192
    studio.scene.shlight.noise_threshold = 2e-3
    assert [line for line in studio.messages(most=99) if "shows nothing behind it" not in line] == []
    studio.compare(mean=5e-3, error=5e-3)
