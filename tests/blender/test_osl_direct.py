# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps in materials of Cycles by Open Shading Language: one sample beside the core, at the places that it hit."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from numpy.typing import NDArray

import shlight
from shlight.images import read_layers
from shlight.metrics import mean_ratio, rel_mse
from shlight_blender import compat
from shlight_blender.osl import materials, script

Array = NDArray[np.float64]
EYE = np.array([3.0, -6.0, 4.0])
PLACE, RADIUS, POWER, TINT = (-0.8, 0.6, 1.2), 0.3, 150.0, np.array([1.0, 0.8, 0.5])
COLOR = (0.7, 0.5, 0.9)


def stage(studio: Any, material: Any, place: Any = PLACE, **lamp: Any) -> Any:
    """A floor and a ball under a lamp, which the horizon of many places cuts; the lamp's light is in their material."""
    scene = studio.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = 80, 60
    studio.plane(material=material)
    studio.ball(0.7, material, location=(0.6, 0, 0.7))
    studio.camera(EYE)
    given = {"shadow_soft_size": RADIUS, "color": TINT, "use_soft_falloff": False, "visible_camera": False, **lamp}
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


def layers(studio: Any) -> dict[str, Array]:
    """Passes of one sample, each (pixels, channels), where something was hit."""
    passes = read_layers(studio.write("CYCLES"))
    hit = np.linalg.norm(passes["normal"], axis=-1) > 0.5
    return {name: passes[name][hit].astype(np.float64) for name in ("combined", "position", "normal", "emission")}


def reflected(bsdf: Any, passes: dict[str, Array], place: Any, radius: float) -> tuple[Array, Array]:
    """What the core reflects of a lamp of radiance 1 at order 8, and where it is to be compared: the normal faces us."""
    up = passes["normal"] / np.linalg.norm(passes["normal"], axis=-1, keepdims=True)
    view = EYE - passes["position"]
    view /= np.linalg.norm(view, axis=-1, keepdims=True)
    seen = np.einsum("ij,ij->i", up, view)
    x = view - seen[:, None] * up
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    frame = np.stack([x, np.cross(up, x), up], axis=1)
    centers = np.einsum("ijk,ik->ij", frame, np.asarray(place) - passes["position"])
    radiance = shlight.shade_spheres(centers, radius, bsdf, np.clip(seen, 0.0, 1.0), order=8)
    return np.asarray(radiance, np.float64), seen > 0.05


SHADERS: dict[str, tuple[str, dict[str, Any]]] = {
    "lambert": ("ShaderNodeBsdfDiffuse", {}),
    **{f"ggx {r}": ("ShaderNodeBsdfGlossy", {"Roughness": r, "distribution": "GGX"}) for r in (0.3, 0.45, 0.6, 1.0)},
}


@pytest.mark.parametrize("name", SHADERS)
def test_one_sample_is_the_core(studio: Any, name: str) -> None:
    kind, inputs = SHADERS[name]
    stage(studio, studio.material(kind, Color=COLOR, **inputs))
    passes = layers(studio)
    rough = inputs.get("Roughness")
    bsdf = shlight.Bsdf.lambert(COLOR) if rough is None else shlight.Bsdf.ggx(rough, 1.0) * COLOR
    radiance, compared = reflected(bsdf, passes, PLACE, RADIUS)
    radiance *= POWER * TINT / (4.0 * np.pi**2 * RADIUS**2)
    error = np.abs(passes["emission"] - radiance)[compared].max() / radiance.max()
    print(f"{name}: {error:.2e} of {radiance.max():.3f} at {compared.sum()} places")
    assert error <= 1e-4


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


@pytest.mark.parametrize("disk", [False, True])
def test_it_is_the_light_that_cycles_samples(studio: Any, disk: bool) -> None:
    stage(studio, textured(studio), use_soft_falloff=disk, use_shadow=False)
    studio.scene.cycles.samples = 256
    emitted = read_layers(studio.write("CYCLES"))["emission"]
    operate("osl_remove")
    studio.scene.cycles.shading_system = False
    sampled = read_layers(studio.write("CYCLES"))["combined"][..., :3]
    print(f"mean {mean_ratio(emitted, sampled) - 1:+.2%}, relMSE {rel_mse(emitted, sampled):.1e}")
    assert abs(mean_ratio(emitted, sampled) - 1) <= 5e-3
    assert rel_mse(emitted, sampled) <= 5e-3


def tree_of(material: Any) -> list[Any]:
    """What a tree of nodes is made of."""
    tree = material.node_tree
    nodes = [(n.name, n.bl_idname, tuple(n.location), [str(getattr(i, "default_value", 0)) for i in n.inputs]) for n in tree.nodes]
    links = {(l.from_node.name, l.from_socket.identifier, l.to_node.name, l.to_socket.identifier) for l in tree.links}
    return [nodes, links, tree.animation_data, material.cycles.emission_sampling, sorted(material.keys())]


def test_removing_leaves_what_was_there(studio: Any) -> None:
    made = textured(studio)
    before = tree_of(made)
    lamp = stage(studio, made)
    groups = [node for node in made.node_tree.nodes if node.type == "GROUP"]
    assert len(groups) == 2 and lamp.light_linking.receiver_collection is not None
    operate("osl_insert")
    assert [node for node in made.node_tree.nodes if node.type == "GROUP"] == groups
    operate("osl_remove")
    assert tree_of(made) == before
    assert lamp.light_linking.receiver_collection is None
    assert not bpy.data.collections and not bpy.data.node_groups


def test_a_moved_lamp_moves_its_light(studio: Any) -> None:
    lamp = stage(studio, studio.material(Color=COLOR))
    lamp.location, lamp.data.energy, lamp.data.shadow_soft_size = (1.0, 1.0, 3.0), 300.0, 0.6
    passes = layers(studio)
    radiance, compared = reflected(shlight.Bsdf.lambert(COLOR), passes, (1.0, 1.0, 3.0), 0.6)
    radiance *= 300.0 * TINT / (4.0 * np.pi**2 * 0.6**2)
    assert np.abs(passes["emission"] - radiance)[compared].max() <= 1e-4 * radiance.max()


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
