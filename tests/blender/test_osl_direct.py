# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps in materials of Cycles by Open Shading Language: one sample beside the core, at the places that it hit."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

import shlight
from shlight.images import read_layers
from shlight.metrics import mean_ratio, rel_mse
from shlight_blender import compat
from shlight_blender.osl import script

EYE = np.array([3.0, -6.0, 4.0])
PLACE, POWER, TINT = (-0.8, 0.6, 1.2), 150.0, np.array([1.0, 0.8, 0.5])
COLOR = (0.7, 0.5, 0.9)


def stage(studio: Any, material: Any, place: Any = PLACE, **lamp: Any) -> Any:
    """A floor and a ball under a lamp, whose light is in their material."""
    scene = studio.scene
    scene.render.engine = "CYCLES"
    studio.plane(material=material)
    studio.ball(0.7, material, location=(0.6, 0, 0.7))
    studio.camera(EYE)
    given = {"shadow_soft_size": 0.3, "color": TINT, "use_soft_falloff": False, "visible_camera": False, **lamp}
    made = studio.lamp("POINT", POWER, place, **given)
    for name in ("position", "normal", "emit"):
        setattr(scene.view_layers[0], f"use_pass_{name}", True)
    compat.choose_layers(scene.render.image_settings)
    scene.cycles.samples = 1
    operate("osl_insert")
    return made


def operate(name: str) -> None:
    """Runs an operator on all objects."""
    for shown in bpy.context.scene.objects:
        shown.select_set(True)
    assert getattr(bpy.ops.shlight, name)() == {"FINISHED"}


def picture(studio: Any) -> dict[str, Any]:
    """Cycles' passes."""
    return {name.lower(): values for name, values in read_layers(studio.write("CYCLES")).items()}


def error_of(studio: Any, lamp: Any, bsdf: Any) -> float:
    """How far one sample is from what the core reflects at order 8, relative to the largest of the picture."""
    place, radius = np.array(lamp.location), lamp.data.shadow_soft_size
    passes = picture(studio)
    towards = place - passes["position"].astype(np.float64)
    lit = (np.linalg.norm(passes["normal"], axis=-1) > 0.5) & (np.linalg.norm(towards, axis=-1) > radius)
    towards, at, up = towards[lit], passes["position"][lit].astype(np.float64), passes["normal"][lit]
    view, up = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (EYE - at, up.astype(np.float64)))
    seen = np.einsum("ij,ij->i", up, view)
    x = view - seen[:, None] * up
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    centers = np.einsum("ijk,ik->ij", np.stack([x, np.cross(up, x), up], axis=1), towards)
    radiance = shlight.shade_spheres(centers, radius, bsdf, np.clip(seen, 0.0, 1.0), order=8)
    radiance = radiance * lamp.data.energy * TINT / (4.0 * np.pi**2 * radius**2)
    error = float(np.abs(passes["emission"][lit] - radiance).max() / radiance.max())
    print(f"{error:.1e} of {radiance.max():.3f}; {np.mean(np.abs(centers[:, 2]) < radius):.0%} cut")
    return error


@pytest.mark.parametrize(("height", "radius"), [(1.2, 0.3), (0.3, 0.35)])
@pytest.mark.parametrize("roughness", [None, 0.3, 0.45, 0.6, 1.0])
def test_one_sample_is_the_core(studio: Any, roughness: float | None, height: float, radius: float) -> None:
    """The horizon cuts the low lamp all over the floor."""
    made, bsdf = studio.material(Color=COLOR), shlight.Bsdf.lambert(COLOR)
    if roughness is not None:
        made = studio.material("ShaderNodeBsdfGlossy", Color=COLOR, Roughness=roughness, distribution="GGX")
        bsdf = shlight.Bsdf.ggx(roughness, 1.0) * COLOR
    lamp = stage(studio, made, (*PLACE[:2], height), shadow_soft_size=radius)
    assert error_of(studio, lamp, bsdf) <= 1e-4


def textured(studio: Any) -> Any:
    """Lambert's and a glossy shader mixed, with a pattern, a roughness that varies and a bump."""
    made = studio.material(Color=COLOR)
    tree = made.node_tree
    new, link = tree.nodes.new, tree.links.new
    matt, output = tree.nodes[0], tree.nodes[1]
    noise, bump = new("ShaderNodeTexNoise"), new("ShaderNodeBump")
    glossy, mix = new("ShaderNodeBsdfGlossy"), new("ShaderNodeMixShader")
    noise.inputs["Scale"].default_value = 3.0
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.2, 1.0
    link(noise.outputs[0], bump.inputs["Height"])
    link(noise.outputs["Color"], matt.inputs["Color"])
    link(noise.outputs[0], glossy.inputs["Roughness"])
    for node, number in ((matt, 1), (glossy, 2)):
        link(bump.outputs[0], node.inputs["Normal"])
        link(node.outputs[0], mix.inputs[number])
    link(mix.outputs[0], output.inputs["Surface"])
    return made


@pytest.mark.parametrize("disk", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_it_is_the_light_that_cycles_samples(studio: Any, disk: bool) -> None:
    stage(studio, textured(studio), use_soft_falloff=disk, use_shadow=False)
    studio.resolution(40, 30)
    studio.scene.cycles.samples = 128
    emitted = picture(studio)["emission"]
    operate("osl_remove")
    # Open Shading Language in Cycles darkens the sum of two shaders by 2 %.
    studio.scene.cycles.shading_system, studio.scene.cycles.samples = False, 512
    sampled = picture(studio)["combined"][..., :3]
    print(f"mean {mean_ratio(emitted, sampled) - 1:+.2%}, relMSE {rel_mse(emitted, sampled):.1e}")
    assert abs(mean_ratio(emitted, sampled) - 1) <= 5e-3
    assert rel_mse(emitted, sampled) <= 5e-3


def tree_of(material: Any) -> list[Any]:
    """All that a tree of nodes has."""
    tree = material.node_tree
    made: list[Any] = [tree.animation_data, material.cycles.emission_sampling, list(material.keys())]
    for node in tree.nodes:
        values = [str(getattr(socket, "default_value", 0)) for socket in node.inputs]
        made.append((node.name, node.bl_idname, tuple(node.location), values))
    made += sorted(f"{each.from_socket.path_from_id()} {each.to_socket.path_from_id()}" for each in tree.links)
    return made


def test_removing_leaves_what_was_there(studio: Any) -> None:
    made = textured(studio)
    before = tree_of(made)
    lamp = stage(studio, made)
    groups = [node for node in made.node_tree.nodes if node.type == "GROUP"]
    assert len(groups) == 2
    assert lamp.light_linking.receiver_collection is not None
    operate("osl_insert")
    assert [node for node in made.node_tree.nodes if node.type == "GROUP"] == groups
    operate("osl_remove")
    assert tree_of(made) == before
    assert lamp.light_linking.receiver_collection is None
    assert not [*bpy.data.collections, *bpy.data.node_groups]


def test_a_moved_lamp_moves_its_light(studio: Any) -> None:
    lamp = stage(studio, studio.material(Color=COLOR))
    lamp.location, lamp.data.energy, lamp.data.shadow_soft_size = (1.0, 1.0, 2.0), 300.0, 0.6
    assert error_of(studio, lamp, shlight.Bsdf.lambert(COLOR)) <= 1e-4
    # A floor alone has no light but that: the lamp does not light it once more.
    bpy.data.objects.remove(studio.scene.objects["Ball"])
    passes = picture(studio)
    assert np.abs(passes["combined"][..., :3] - passes["emission"]).max() <= 1e-6 * passes["emission"].max()


def test_what_is_not_supported_is_named(studio: Any, capfd: Any, monkeypatch: Any) -> None:
    studio.plane(material=studio.material("ShaderNodeBsdfPrincipled"))
    studio.lamp("POINT", 10.0, PLACE)
    for shown in studio.scene.objects:
        shown.select_set(True)
    with pytest.raises(RuntimeError, match="nothing that is selected is supported"):
        bpy.ops.shlight.osl_insert()
    assert "Material: Principled BSDF is not supported" in capfd.readouterr().out
    monkeypatch.setattr(script, "has_osl", lambda: False)
    with pytest.raises(RuntimeError, match="this Blender was built without Open Shading Language"):
        bpy.ops.shlight.osl_insert()
