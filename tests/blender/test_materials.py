# SPDX-License-Identifier: MIT
"""Materials: pictures against Cycles, and what of a node tree is named as not supported."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
import pytest

from shlight import nodes


def shine_on(studio: Any, material: Any, *, sharp: bool = False) -> None:
    """A smooth ball of `material` over a plane of the same, under two lamps.

    A sharp reflection of an area lamp takes the highest orders and long; then both are point lamps.
    """
    studio.plane(material=material)
    studio.ball(1.0, material, location=(0, 0, 1.1))
    if sharp:
        studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)
    else:
        studio.area(150, (1.5, -2, 3), shape="RECTANGLE", size=1.2, size_y=0.8, rotation_euler=(-0.5, 0.3, 0))
    studio.lamp("POINT", 80, (-2, -2, 2), shadow_soft_size=0.4, color=(0.6, 0.8, 1.0))
    studio.camera()


MIRRORS: list[tuple[str, dict[str, Any]]] = [
    ("ShaderNodeBsdfAnisotropic", {"Color": (0.9, 0.6, 0.3), "distribution": "GGX"}),
    ("ShaderNodeBsdfAnisotropic", {"Color": (0.9, 0.6, 0.3), "distribution": "MULTI_GGX"}),
    ("ShaderNodeBsdfPrincipled", {"Base_Color": (0.9, 0.7, 0.3), "Metallic": 1.0}),
    ("ShaderNodeBsdfPrincipled", {"Base_Color": (0.2, 0.5, 0.8), "IOR": 1.8}),
    ("ShaderNodeBsdfAnisotropic", {"Color": (0.9, 0.6, 0.3), "distribution": "BECKMANN"}),
]
MIRROR_ROUGHNESSES = (0.003, 0.0, 0.01, 0.03)


def mirrors() -> Iterator[Any]:
    """All shaders and roughnesses; each of the first two once among the quick ones."""
    for i, (shader, inputs) in enumerate(MIRRORS):
        for j, roughness in enumerate(MIRROR_ROUGHNESSES):
            yield pytest.param(shader, inputs, roughness, marks=[] if i == j < 2 else [pytest.mark.slow])


@pytest.mark.parametrize(("shader", "inputs", "roughness"), list(mirrors()))
def test_mirrors(studio: Any, shader: str, inputs: dict[str, Any], roughness: float) -> None:
    """Down to roughness 0, where a lamp's own image is seen; Cycles draws it from 0.0037 on."""
    shine_on(studio, studio.material(shader, Roughness=roughness, **inputs))
    studio.resolution(40, 30)
    studio.scene.shlight.pixel_samples = 64  # the image has edges
    studio.scene.cycles.samples = 1024  # 256 miss the narrow peak in too many pixels
    studio.compare(mean=1e-2)  # the edges of the image are cut by the same points in all pixels
    assert studio.messages(most=99) == []


def test_all_distributions_end_in_the_same_mirror(studio: Any) -> None:
    studio.plane(
        material=studio.material("ShaderNodeBsdfAnisotropic", Color=(1, 1, 1), Roughness=0.0, distribution="BECKMANN")
    )
    studio.area()
    studio.camera()
    assert studio.messages(most=99) == []


def test_principled_emission(studio: Any) -> None:
    studio.plane(material=studio.material())
    studio.box(
        (0.4, 0.4, 0.4),
        studio.material(
            "ShaderNodeBsdfPrincipled",
            Emission_Color=(0.4, 0.7, 1.0),
            Emission_Strength=9.0,
            Base_Color=(0.5, 0.5, 0.5),
        ),
        location=(0, 0, 0.8),
    )
    studio.camera()
    studio.compare()


def test_mixed_and_added_shaders_in_groups(studio: Any) -> None:
    """Mix of diffuse and glossy, plus emission, inside a node group with a reroute, a muted node and group inputs."""
    group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    group.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Share", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    new, link = group.nodes.new, group.links.new
    inside, outside, reroute = new("NodeGroupInput"), new("NodeGroupOutput"), new("NodeReroute")
    kinds = ("BsdfDiffuse", "BsdfAnisotropic", "Emission", "MixShader", "AddShader", "Gamma")
    diffuse, glossy, emission, mix, add, muted = (new(f"ShaderNode{kind}") for kind in kinds)
    glossy.distribution, glossy.inputs["Roughness"].default_value = "GGX", 0.5
    emission.inputs["Strength"].default_value = 2.0
    muted.inputs["Gamma"].default_value, muted.mute = 3.0, True
    link(inside.outputs["Tint"], muted.inputs["Color"])
    link(muted.outputs["Color"], diffuse.inputs["Color"])
    link(inside.outputs["Share"], mix.inputs["Fac"])
    link(diffuse.outputs[0], reroute.inputs[0])
    link(reroute.outputs[0], mix.inputs[1])
    link(glossy.outputs[0], mix.inputs[2])
    link(mix.outputs[0], add.inputs[0])
    link(emission.outputs[0], add.inputs[1])
    link(add.outputs[0], outside.inputs["Shader"])

    material = studio.material()
    tree = material.node_tree
    node, value = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeValue")
    node.node_tree = group
    node.inputs["Tint"].default_value = (0.2, 0.6, 0.3, 1)
    value.outputs[0].default_value = 0.35
    tree.links.new(value.outputs[0], node.inputs["Share"])
    tree.links.new(node.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    # Emissive, it lights the plane; few faces, for every one of them is a lamp.
    studio.plane(material=studio.material(Color=(0.5, 0.5, 0.5)))
    studio.box((1.5, 1.2, 1), material, location=(0, 0, 0.8))
    studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)
    studio.camera()
    studio.compare()
    assert studio.messages(most=99) == []


@pytest.mark.parametrize("temperature", [900.0, 1700.0, 3000.0, 6500.0, 15000.0])
def test_blackbody_emission(studio: Any, temperature: float) -> None:
    material = studio.material("ShaderNodeEmission", Strength=1.0)
    tree = material.node_tree
    blackbody = tree.nodes.new("ShaderNodeBlackbody")
    blackbody.inputs["Temperature"].default_value = temperature
    tree.links.new(blackbody.outputs[0], tree.nodes["Emission"].inputs["Color"])
    studio.plane(20.0, material)
    studio.camera()
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 8
    studio.scene.cycles.samples = 1
    image, reference = studio.render("SHLIGHT")[4, 4, :3], studio.render("CYCLES")[4, 4, :3]
    assert np.abs(image - reference).max() <= 5e-3 * reference.max()


def test_blackbody_over_its_whole_range() -> None:
    """Blender computes the colour of a lamp's temperature as Cycles computes the Blackbody node's."""
    lamp = bpy.data.lights.new("Lamp", "POINT")
    if not hasattr(lamp, "use_temperature"):
        pytest.skip("lamps of this version of Blender have no temperature")
    lamp.use_temperature = True

    def color(kelvin: float) -> Any:
        return np.array(nodes.blackbody(kelvin).constant)

    worst = 0.0
    for temperature in [*range(800, 12001, 50), 12500]:
        lamp.temperature = temperature
        expected = np.array(lamp.temperature_color)
        worst = max(worst, float(np.abs(color(temperature) - expected).max() / expected.max()))
    assert worst <= 2e-3
    np.testing.assert_allclose(color(100.0), color(800.0))
    bpy.data.lights.remove(lamp)


def test_objects_without_material_or_nodes(studio: Any) -> None:
    studio.plane()
    plain = bpy.data.materials.new("Plain")
    plain.diffuse_color = (0.7, 0.2, 0.4, 1.0)
    studio.box((1, 1, 1), plain, location=(-1, 0, 0.5))
    studio.box((1, 1, 1), location=(1, 0, 0.5)).data.materials.append(None)
    studio.area(150)
    studio.camera()
    studio.compare()


# --- what is not supported


def linked_point_info(material: Any, socket: Any) -> Any:
    """Links a Point Info node, which is not supported, to a socket of the material's tree."""
    node = material.node_tree.nodes.new("ShaderNodePointInfo")
    material.node_tree.links.new(node.outputs[0], socket)
    return node


def test_textures_are_named_and_the_sockets_value_used(studio: Any) -> None:
    studio.area()
    studio.camera()
    material = studio.material(name="Wood", Color=(0.25, 0.5, 0.75))
    linked_point_info(material, material.node_tree.nodes["Diffuse BSDF"].inputs["Color"]).label = "Grain"
    studio.plane(material=material)
    (line,) = studio.messages(most=99)
    assert "Material 'Wood'" in line
    assert "node 'Grain'" in line
    assert "'Color' of 'Diffuse BSDF'" in line
    assert "[0.25, 0.5 , 0.75]" in line


def test_nothing_is_bevelled_or_occluded(studio: Any) -> None:
    """Both nodes are named, and the picture is that without them."""
    material = studio.material(Color=(0.25, 0.5, 0.75))
    studio.ball(1.0, material, location=(0, 0, 1))
    studio.lit_floor()
    plain = studio.render("SHLIGHT")
    tree = material.node_tree
    bevel, occlusion = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Bevel", "AmbientOcclusion"))
    occlusion.inputs["Color"].default_value = (0.25, 0.5, 0.75, 1.0)
    tree.links.new(occlusion.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    tree.links.new(bevel.outputs["Normal"], tree.nodes["Diffuse BSDF"].inputs["Normal"])
    assert ["Bevel is not" in line or "Occlusion is not" in line for line in studio.messages(most=99)] == [True, True]
    np.testing.assert_allclose(studio.render("SHLIGHT"), plain, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize(
    ("shader", "inputs", "named"),
    [
        ("ShaderNodeBsdfHair", {}, "Hair BSDF is not supported"),
        (
            "ShaderNodeBsdfPrincipled",
            {"Thin_Film_Thickness": 300.0, "Transmission_Weight": 1.0},
            "its thin film is not seen from inside of the body",
        ),
        ("ShaderNodeBsdfPrincipled", {"Transmission_Weight": 1.0}, "'Transmission Weight' shows nothing behind it"),
        ("ShaderNodeBsdfPrincipled", {"IOR": 0.8}, "an 'IOR' below 1 reflects as its reciprocal does"),
        ("ShaderNodeEmission", {"Strength": -1.0}, "negative emission"),
    ],
)
def test_unsupported_shaders_are_named(studio: Any, shader: str, inputs: dict[str, Any], named: str) -> None:
    if not hasattr(bpy.types, shader):
        pytest.skip(f"this version of Blender has no {shader}")
    studio.area()
    studio.camera()
    studio.plane(material=studio.material(shader, name="Odd", **inputs))
    lines = studio.messages(most=99, of_depths=True)
    assert [line for line in lines if named in line and "Material 'Odd'" in line], lines
    studio.scene.render.resolution_percentage = 25
    assert np.isfinite(studio.render("SHLIGHT")).all()


def test_shadows_of_bumps_that_cycles_does_not_soften_are_named(studio: Any) -> None:
    material = studio.material()
    if not hasattr(material.cycles, "use_bump_map_correction"):
        pytest.skip("this version of Blender has no Bump Map Correction")
    tree = material.node_tree
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], tree.nodes["Diffuse BSDF"].inputs["Normal"])
    studio.area()
    studio.camera()
    studio.plane(material=material)
    named = "diffuse bumps shadow themselves"
    assert studio.messages(most=9) == []
    tree.nodes["Diffuse BSDF"].inputs["Roughness"].default_value = 0.5
    material.cycles.use_bump_map_correction = False
    material.update_tag()
    lines = studio.messages(most=9)
    assert any(named in line for line in lines)
    assert any("without diffuse roughness" in line for line in lines)


def test_light_of_the_world_that_transparent_shadows_stop_is_named(studio: Any) -> None:
    studio.camera()
    background, tree = studio.world(), studio.scene.world.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeTexGradient").outputs["Color"], background.inputs["Color"])
    pane = studio.material("ShaderNodeBsdfTransparent", name="Pane")
    settings = pane if hasattr(pane, "use_transparent_shadow") else pane.cycles
    settings.use_transparent_shadow = False
    studio.plane(material=pane)
    assert any("Material 'Pane': its Transparent Shadows are off" in line for line in studio.messages(most=99))


def test_volumes_and_unknown_nodes_are_named(studio: Any) -> None:
    studio.area()
    studio.camera()
    material = studio.material("ShaderNodeBsdfPrincipled", name="Rough")
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    tree.links.new(tree.nodes.new("ShaderNodeVolumeScatter").outputs[0], output.inputs["Volume"])
    linked_point_info(material, tree.nodes["Principled BSDF"].inputs["Coat Weight"])
    studio.plane(material=material)
    text = "\n".join(studio.messages(most=99))
    for part in ("scattering is not supported", "'Coat Weight'"):
        assert part in text
    assert text.count("\n") == 1


def test_material_without_output_is_black(studio: Any) -> None:
    studio.area()
    studio.camera()
    empty = studio.material(name="Empty")
    empty.node_tree.nodes.clear()
    studio.plane(material=empty)
    assert any("no Material Output" in line for line in studio.messages(most=99))
    assert studio.render("SHLIGHT")[..., :3].max() == 0.0
