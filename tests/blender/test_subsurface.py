# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies that scatter light below their surface, as bright as in Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import pytest

SKIN = {"Color": (0.8, 0.5, 0.3), "Radius": (1.0, 0.2, 0.1)}
PRINCIPLED = "ShaderNodeBsdfPrincipled"
SCATTERING = "ShaderNodeSubsurfaceScattering"
SINCE_52 = pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="this version has no such method")


def add_ball(studio: Any, material: Any) -> None:
    studio.ball(1.0, material, rings=32)


def add_cube(studio: Any, material: Any) -> None:
    studio.box((1.5, 1.5, 1.5), material)


def add_slab(studio: Any, material: Any) -> None:
    studio.box((3, 3, 0.2), material)


def light(studio: Any) -> None:
    """A lamp above, one behind, and the camera."""
    studio.area(120, (1.5, -1, 3), size=0.6)
    studio.lamp("POINT", 150, (-1.5, 2.5, -0.5), shadow_soft_size=0.2)
    studio.camera((1.5, -4.5, 2.2), (0, 0, 0), lens=55)
    studio.scene.shlight.pixel_samples = 16
    studio.resolution(32, 24)


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="methods have other names")
@pytest.mark.parametrize(
    ("add", "inputs"),
    [
        pytest.param(add_ball, {"falloff": "RANDOM_WALK", "Scale": 0.2}, id="walk"),
        pytest.param(add_cube, {"falloff": "RANDOM_WALK", "Scale": 0.6, "Roughness": 0.2, "IOR": 1.8}, id="bent"),
        pytest.param(
            add_slab,
            {"falloff": "RANDOM_WALK_SKIN", "Scale": 0.3, "Anisotropy": 0.6},
            id="skin",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            add_ball,
            {"falloff": "RANDOM_WALK_LEGACY", "Scale": 0.2, "Anisotropy": -0.3},
            id="legacy backward",
            marks=SINCE_52,
        ),
        pytest.param(add_cube, {"falloff": "RANDOM_WALK_LEGACY", "Scale": 0.6}, id="legacy", marks=SINCE_52),
        pytest.param(
            add_cube, {"falloff": "RANDOM_WALK", "Scale": 0.1, "Anisotropy": -0.5}, id="backward", marks=SINCE_52
        ),
        pytest.param(
            add_cube, {"falloff": "RANDOM_WALK", "Scale": 0.03, "Anisotropy": 0.6}, id="forward", marks=SINCE_52
        ),
        pytest.param(add_ball, {"falloff": "BURLEY", "Scale": 0.5}, id="burley"),
        pytest.param(add_ball, {"falloff": "RANDOM_WALK", "Scale": 1e-9}, id="none", marks=pytest.mark.slow),
    ],
)
def test_subsurface_scattering(studio: Any, add: Any, inputs: dict[str, Any]) -> None:
    add(studio, studio.material(SCATTERING, **SKIN, **inputs))
    light(studio)
    assert studio.messages() == []
    studio.compare(mean=7e-3, error=2e-2)


@pytest.mark.parametrize("bounces", [pytest.param(0, marks=pytest.mark.slow), 2])
def test_a_principled_body_on_a_floor(studio: Any, bounces: int) -> None:
    """Light that has bounced off a diffuse surface before enters diffusely, as in Cycles before 5.2."""
    own = {"Base_Color": SKIN["Color"], "Subsurface_Radius": SKIN["Radius"]}
    if bpy.app.version < (4, 0, 0):
        own |= {"Subsurface": 0.15, "Subsurface_Color": (0.2, 0.8, 0.3), "Specular": 0.0}
    else:
        own |= {"Subsurface_Weight": 0.7, "Subsurface_Scale": 0.15, "subsurface_method": "RANDOM_WALK_SKIN"}
    add_ball(studio, studio.material(PRINCIPLED, **own))
    studio.plane(8, studio.material(), location=(0, 0, -1.05))
    light(studio)
    cycles = studio.scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    studio.scene.shlight.max_bounces = bounces
    studio.compare(mean=7e-3, error=2e-2)


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="bodies of little radius are brighter there; why is not known")
@pytest.mark.parametrize("bumped", [False, True])
@pytest.mark.parametrize("method", ["BURLEY", pytest.param("RANDOM_WALK", marks=pytest.mark.slow)])
def test_a_body_whose_normals_are_bent(studio: Any, method: str, bumped: bool) -> None:
    """A bump bends them, or a map does so far that the viewer's mirror image is below: Cycles turns those back."""
    inputs = {"Subsurface Weight": 1.0, "Subsurface Scale": 0.1, "Base Color": (0.8, 0.5, 0.3)}
    inputs["Specular IOR Level"] = 0.0
    material = studio.material(PRINCIPLED, **inputs)
    tree = material.node_tree
    bent = tree.nodes.new("ShaderNodeBump" if bumped else "ShaderNodeNormalMap")
    if bumped:
        noise = tree.nodes.new("ShaderNodeTexNoise")
        noise.inputs["Scale"].default_value, bent.inputs["Distance"].default_value = 8.0, 0.5
        tree.links.new(noise.outputs[0], bent.inputs["Height"])
    else:
        bent.inputs["Color"].default_value = (1.0, 0.1, 1.0, 1.0)
    shader = tree.nodes["Principled BSDF"]
    shader.subsurface_method = method
    tree.links.new(bent.outputs["Normal"], shader.inputs["Normal"])
    add_ball(studio, material)
    light(studio)
    noise = 1 if method == "BURLEY" else 2.5  # of 16 walks a pixel
    studio.compare(mean=7e-3 * noise, error=2e-2 * noise)
