# SPDX-License-Identifier: MIT
"""Names and paths that are not UTF-8, as files of old versions of Blender have them."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

from shlight.images import write_png
from shlight_blender import record
from shlight_blender.compat import choose_layers

KINDS = ["OBJ", "MES", "MAT", "NOD", "LAB", "IMG", "UVM", "COL", "WOR", "CAM", "CDA", "LMP", "LDA", "ATT", "SCE"]
KINDS += ["VLA", "VLB", "AOV", "GRP"]


def named_scene(studio: Any) -> None:
    """Everything that has a name has one that ends with one of the KINDS."""
    studio.still_life()
    scene, layer, camera = studio.scene, studio.scene.view_layers[0], studio.camera()
    camera.name, camera.data.name = "NAMEXXCAM", "NAMEXXCDA"
    if scene.world is None:
        studio.world((0.1, 0.1, 0.1))
    scene.world.name, scene.name, layer.name = "NAMEXXWOR", "NAMEXXSCE", "NAMEXXVLA"
    scene.view_layers.new("NAMEXXVLB")
    lamp, box = bpy.data.objects["Area"], bpy.data.objects["Box"]
    lamp.name, lamp.data.name, box.name, box.data.name = "NAMEXXLMP", "NAMEXXLDA", "NAMEXXOBJ", "NAMEXXMES"
    material = box.active_material
    material.name = "NAMEXXMAT"
    new, link = material.node_tree.nodes.new, material.node_tree.links.new
    other, texture, place, value = (
        new(f"ShaderNode{kind}") for kind in ("AmbientOcclusion", "TexImage", "UVMap", "Attribute")
    )
    other.name, other.label, place.uv_map, value.attribute_name = "NAMEXXNOD", "NAMEXXLAB", "NAMEXXUVM", "NAMEXXATT"
    texture.image = bpy.data.images.new("NAMEXXIMG", 8, 8)
    texture.image.pack()
    diffuse = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    mix, output = new("ShaderNodeMixRGB"), new("ShaderNodeOutputAOV")
    setattr(output, "aov_name" if hasattr(output, "aov_name") else "name", "NAMEXXAOV")
    link(place.outputs[0], texture.inputs[0])
    link(other.outputs["Color"], mix.inputs[1])
    link(texture.outputs[0], mix.inputs[2])
    link(value.outputs["Fac"], diffuse.inputs["Roughness"])
    link(mix.outputs[0], diffuse.inputs["Color"])
    box.data.uv_layers.new(name="NAMEXXUVM")
    box.data.attributes.new("NAMEXXATT", "FLOAT", "POINT")
    scene.collection.children.link(bpy.data.collections.new("NAMEXXCOL"))
    layer.layer_collection.children[0].holdout = True
    layer.aovs.add().name = "NAMEXXAOV"
    layer.lightgroups.add(name="NAMEXXGRP")
    layer.use_pass_cryptomatte_object = True
    lamp.lightgroup = "NAMEXXGRP"


def saved_with_name(studio: Any, kind: str) -> None:
    """Opens a file of that scene in which the name of one kind is not UTF-8."""
    named_scene(studio)
    path = studio.folder / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    raw = path.read_bytes()
    assert b"NAMEXX" + kind.encode() in raw
    path.write_bytes(raw.replace(b"NAMEXX" + kind.encode(), b"NAME\xfc\xe9" + kind.encode()))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = studio.scene = bpy.context.scene
    scene.render.engine, scene.shlight.max_samples, scene.shlight.use_pass_lights = "SHLIGHT", 4, True


@pytest.mark.parametrize("kind", KINDS)
def test_a_name_that_is_not_utf8(studio: Any, kind: str) -> None:
    saved_with_name(studio, kind)
    image = studio.render("SHLIGHT")
    assert image[..., :3].mean() > 0.1
    if kind == "LAB":
        assert any(f"NAMEüé{kind}" in line for line in record.last.report.lines())


@pytest.mark.parametrize("kind", ["WOR", "SKY"])
def test_a_world_of_nodes(studio: Any, kind: str) -> None:
    background = studio.world((1, 1, 1)).id_data.nodes["Background"]
    node = background.id_data.nodes.new("ShaderNodeAmbientOcclusion")
    node.name = "NAMEXXSKY"
    node.id_data.links.new(node.outputs[0], background.inputs[0])
    saved_with_name(studio, kind)
    studio.scene.shlight.world_width = 64
    assert studio.render("SHLIGHT")[..., :3].mean() > 0.1
    assert any(f"NAMEüé{kind}" in line for line in record.last.report.lines())


@pytest.mark.parametrize("kind", ["VLA", "VLB"])
def test_every_view_layer_has_its_picture(studio: Any, kind: str) -> None:
    oiio = pytest.importorskip("OpenImageIO")
    saved_with_name(studio, kind)
    studio.scene.view_layers[1].use_sky = False
    choose_layers(studio.scene.render.image_settings)
    path = studio.write("SHLIGHT")
    # OpenImageIO gives no names that are not UTF-8 either; channels stay in the order of their names.
    path.write_bytes(path.read_bytes().replace(b"NAME\xfc\xe9", b"NAMEzz"))
    found = {}
    for part in range(oiio.ImageBuf(str(path)).nsubimages):
        image = oiio.ImageBuf(str(path), part, 0)
        for number, channel in enumerate(image.spec().channelnames):
            found[channel.replace("zz", "XX")] = image.get_pixels(oiio.FLOAT)[..., number].mean()
    assert found["NAMEXXVLA.Combined.R"] > found["NAMEXXVLB.Combined.R"] > 0.1


def test_paths_that_are_not_utf8(studio: Any) -> None:
    folder = os.fsencode(studio.folder) + b"/b\xfccher"
    Path(os.fsdecode(folder)).mkdir()
    try:
        write_png(os.fsdecode(folder + b"/t.png"), np.full((8, 16, 3), (20, 200, 20), np.uint8))
    except OSError as error:
        pytest.skip(str(error))
    shutil.copy(folder + b"/t.png", studio.folder / "t.png")
    image = bpy.data.images.load(str(studio.folder / "t.png"))
    image.filepath = os.fsdecode(folder + b"/t.png")
    material = studio.material()
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs[0], material.node_tree.nodes["Diffuse BSDF"].inputs["Color"])
    studio.plane(material=material)
    studio.area(150, size=0.8)
    studio.camera()
    studio.compare()
    image.filepath = os.fsdecode(folder + b"/gone.png")
    image.reload()
    studio.compare()
    assert any("b?cher/gone.png' is missing" in line for line in record.last.report.lines())


@pytest.mark.parametrize("broken", ["layer_passes", "name_of"])
def test_blender_gets_a_result_whatever_fails(studio: Any, broken: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: Any) -> None:
        raise KeyError("planted")

    studio.lit_floor()
    monkeypatch.setattr(f"shlight_blender.engine.{broken}", fail)
    with pytest.raises(RuntimeError, match="planted"):
        studio.render("SHLIGHT")
