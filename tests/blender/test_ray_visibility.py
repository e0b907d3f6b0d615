# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that some kinds of rays do not meet, beside Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import pytest

from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of

KINDS = ("camera", "diffuse", "glossy", "transmission", "shadow")


def stage(studio: Any, bounces: int) -> dict[str, Any]:
    """A floor, a mirror, a pane of glass, and boxes by the kinds of rays; those of odd number shine."""
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    mirror = studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Color=(0.9, 0.9, 0.9), Roughness=0.0)
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(1, 1, 1), Roughness=0.0, IOR=1.1)
    glow = studio.material("ShaderNodeEmission", "Glow", Color=(1, 0.6, 0.3), Strength=0.5)
    studio.plane(8, white)
    studio.box((6, 0.1, 3), mirror, "Wall", location=(0, 1.5, 1.5))
    studio.box((1.2, 0.1, 1), glass, "Pane", location=(1.6, -1.6, 0.5))
    made = {
        kind: studio.box((0.5, 0.5, 0.9), glow if i % 2 == 1 else white, kind, location=(1.1 * i - 2.2, 0.2, 0.6))
        for i, kind in enumerate(KINDS)
    }
    studio.lamp("POINT", 150, (1.5, -3, 4), shadow_soft_size=0.0)  # of an area, caustics would be Cycles' noise
    studio.plain_world((0.1, 0.15, 0.2))
    studio.camera((1.5, -7, 2.5), (0, 0, 0.6))
    studio.scene.shlight.max_bounces = bounces
    studio.resolution(36, 24)
    use_cycles(studio.scene, 1024, 0, bounces_of(studio.scene))
    return made


@pytest.mark.parametrize("bounces", [pytest.param(0, marks=pytest.mark.slow), 3])
def test_objects_are_hidden_from_kinds_of_rays(studio: Any, bounces: int) -> None:
    for kind, box in stage(studio, bounces).items():
        setattr(box, f"visible_{kind}", False)
    studio.compare(mean=5e-3, error=6e-3)
    glass = [line for line in studio.messages(most=99) if "Glass" in line]
    assert studio.messages(most=99) == (glass if bounces == 0 else [])


def test_holdouts_and_collections_that_are_indirect_only(studio: Any) -> None:
    boxes = stage(studio, 2)
    boxes["camera"].is_holdout = True
    scene = studio.scene
    for kind, flag in (("diffuse", "holdout"), ("shadow", "indirect_only")):
        own = bpy.data.collections.new(kind)
        scene.collection.children.link(own)
        scene.collection.objects.unlink(boxes[kind])
        own.objects.link(boxes[kind])
        setattr(bpy.context.view_layer.layer_collection.children[kind], flag, True)
    _, reference = studio.compare(mean=5e-3, error=6e-3, alpha=1e-2)
    assert 0.01 < (reference[..., 3] == 0).mean() < 0.5
    assert studio.messages(most=99) == []


@pytest.mark.parametrize("is_off", [True, False])
def test_transparent_shadows_that_are_off_stop_lamps_alone(studio: Any, is_off: bool) -> None:
    """An even world is seen through the pane by every ray that surfaces reflect."""
    pane = studio.material("ShaderNodeBsdfTransparent", "Pane", Color=(0.9, 0.5, 0.3))
    switch = pane if hasattr(pane, "use_transparent_shadow") else pane.cycles
    switch.use_transparent_shadow = not is_off
    studio.plane(8, studio.material("ShaderNodeBsdfPrincipled", "Floor", Roughness=0.3))
    studio.plane(2, pane, location=(0, 0, 0.7))
    studio.area(150, (1.5, -3, 4), size=1)
    studio.plain_world((0.3, 0.4, 0.5))
    studio.camera()
    studio.compare(mean=5e-3, error=2e-3)
    assert studio.messages(most=99) == []


def test_what_shines_and_casts_no_shadow_is_named(studio: Any) -> None:
    stage(studio, 1)["diffuse"].visible_shadow = False
    assert studio.messages(most=99) == [
        "Object 'diffuse': it shines and is hidden from shadow rays; its far sides light what is before it"
    ]


def test_glass_that_throws_no_shadow_is_named(studio: Any) -> None:
    studio.lit_floor()
    studio.box((1, 1, 1), studio.material("ShaderNodeBsdfGlass"), visible_shadow=False)
    assert any("Object 'Box': it refracts and is hidden from shadow rays" in line for line in studio.messages())
