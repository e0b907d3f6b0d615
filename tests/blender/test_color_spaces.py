# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in colour spaces other than sRGB, as glowing faces and as worlds beside Cycles'."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

import shlight

KINDS = ("PNG", "EXR", "packed")


def spaces() -> list[str]:
    """A space of each kind that this Blender has: another gamut, another curve, both."""
    probe = bpy.data.images.new("Probe", 1, 1)
    known = {item.identifier for item in probe.colorspace_settings.bl_rna.properties["name"].enum_items}
    bpy.data.images.remove(probe)
    wanted = [
        "Linear Rec.2020",
        "Linear ACEScg",
        "ACEScg",
        "Filmic sRGB",
        "Display P3",
        "Linear CIE-XYZ D65",
    ]
    return [space for space in wanted if space in known]


def picture(studio: Any, kind: str, space: str) -> Any:
    """Pixels from dark to bright, halfway transparent at one corner where files keep alpha."""
    pixels = np.random.default_rng(3).uniform(0.1, 0.9, (8, 8, 4)).astype(np.float32)
    pixels[..., 3] = 1.0
    if kind == "packed":
        made = studio.picture(pixels[..., :3], is_float=False)
        made.pack()
    else:
        path = studio.folder / f"picture.{kind.lower()}"
        if kind == "EXR":
            shlight.images.write_exr(path, pixels[..., :3])
        else:
            pixels[:2, :2, 3] = 0.5
            shlight.images.write_png(path, np.rint(pixels * 255).astype(np.uint8))
        made = bpy.data.images.load(str(path))
    made.colorspace_settings.name = space
    return made


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("space", spaces())
def test_a_picture_in_another_space(studio: Any, space: str, kind: str) -> None:
    material = studio.material("ShaderNodeEmission")
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = picture(studio, kind, space), "Closest"
    tree.links.new(node.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    plane = studio.plane(material=material)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for loop, place in zip(plane.data.uv_layers.new(name="UVMap").data, corners, strict=True):
        loop.uv = place
    studio.camera((0, 0, 4), (0, 0, 0))
    studio.scene.cycles.samples = 512  # with half as many its noise where texels meet is 1e-4
    # Cycles keeps bytes as bytes of sRGB: half a step of 255 of values down to 0.1.
    studio.compare(mean=3e-3, error=1e-4)


@pytest.mark.parametrize("output", ["Color", "Alpha"])
def test_a_missing_picture_in_another_space(studio: Any, output: str) -> None:
    """Before Blender 5.2 it is black without alpha, to the least step of its kind of pixels; later magenta."""
    material = studio.material("ShaderNodeEmission")
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Gone", 1, 1)
    node.image.source, node.image.filepath = "FILE", "//gone/nowhere.png"
    node.image.colorspace_settings.name = "Filmic sRGB"
    tree.links.new(node.outputs[output], tree.nodes["Emission"].inputs["Color"])
    studio.plane(material=material)
    studio.camera((0, 0, 4), (0, 0, 0))
    assert np.abs(studio.render("SHLIGHT") - studio.render("CYCLES")).max() <= 1 / 255 + 1e-6
    color = "black" if bpy.app.version < (5, 2, 0) else "magenta"
    assert any(f"is missing; {color} is used" in line for line in studio.messages())
