# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees that no one should make: each renders without a crash or a NaN, and the report names what is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

DEPTH = 500


def value_node(tree: Any, kind: str, **inputs: Any) -> Any:
    made = tree.nodes.new(kind)
    for key, value in inputs.items():
        made.inputs[int(key[1:])].default_value = value
    return made


def deep_values(tree: Any, shader: Any) -> str:
    """A chain of mathematics from an attribute."""
    last = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    for _ in range(DEPTH):
        node = value_node(tree, "ShaderNodeMath", _1=1e-4)
        tree.links.new(last, node.inputs[0])
        last = node.outputs[0]
    tree.links.new(last, shader.inputs["Roughness"])
    return ""


def deep_shaders(tree: Any, shader: Any) -> str:
    """A chain of mixtures."""
    last = shader.outputs[0]
    for _ in range(DEPTH):
        node = value_node(tree, "ShaderNodeMixShader", _0=0.01)
        tree.links.new(last, node.inputs[1])
        tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], node.inputs[2])
        last = node.outputs[0]
    tree.links.new(last, tree.nodes["Material Output"].inputs["Surface"])
    return ""


def deep_groups(tree: Any, shader: Any) -> str:
    """Groups in groups, and reroutes between them."""
    inner = None
    for depth in range(60):
        group = bpy.data.node_groups.new(f"Depth {depth}", "ShaderNodeTree")
        if hasattr(group, "interface"):
            group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketFloat")
        else:
            group.outputs.new("NodeSocketFloat", "Out")
        end = group.nodes.new("NodeGroupOutput")
        if inner is None:
            start = value_node(group, "ShaderNodeValue")
        else:
            start = group.nodes.new("ShaderNodeGroup")
            start.node_tree = inner
        reroute = group.nodes.new("NodeReroute")
        group.links.new(start.outputs[0], reroute.inputs[0])
        group.links.new(reroute.outputs[0], end.inputs[0])
        inner = group
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = inner
    tree.links.new(outer.outputs[0], shader.inputs["Metallic"])
    return ""


def circle(tree: Any, shader: Any) -> str:
    """A circle of links, half of it muted."""
    a, b = (value_node(tree, "ShaderNodeMath", _1=0.5) for _ in range(2))
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    a.mute = True
    tree.links.new(b.outputs[0], shader.inputs["Roughness"])
    return ""


def circle_of_shaders(tree: Any, shader: Any) -> str:
    mixed = [tree.nodes.new("ShaderNodeMixShader") for _ in range(2)]
    tree.links.new(mixed[0].outputs[0], mixed[1].inputs[1])
    tree.links.new(mixed[1].outputs[0], mixed[0].inputs[1])
    tree.links.new(shader.outputs[0], mixed[0].inputs[2])
    tree.links.new(mixed[1].outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return ""


def muted_circle(tree: Any, shader: Any) -> str:
    """Muted nodes whose inner links lead to each other."""
    a, b = (tree.nodes.new("ShaderNodeGamma") for _ in range(2))
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    a.mute = b.mute = True
    tree.links.new(b.outputs[0], shader.inputs["Base Color"])
    return ""


def wild_numbers(tree: Any, shader: Any) -> str:
    """Sockets out of all bounds; Blender clamps some of them."""
    for name, value in (("Roughness", -3.0), ("Metallic", math.inf), ("IOR", -math.inf), ("Alpha", math.nan)):
        source = tree.nodes.new("ShaderNodeValue")
        source.outputs[0].default_value = value
        tree.links.new(source.outputs[0], shader.inputs[name])
    shader.inputs["Base Color"].default_value = (math.nan, math.inf, -1e30, 1.0)
    return ""


def wild_variables(tree: Any, shader: Any) -> str:
    """Divisions by zero, roots and logarithms of what is negative, at each hit."""
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    for name, operation in (("Roughness", "DIVIDE"), ("Metallic", "LOGARITHM"), ("IOR", "POWER"), ("Alpha", "TANGENT")):
        node = value_node(tree, "ShaderNodeMath", _1=0.0)
        node.operation = operation
        tree.links.new(place, node.inputs[0])
        tree.links.new(node.outputs[0], shader.inputs[name])
    huge = value_node(tree, "ShaderNodeVectorMath", _1=(1e38, -1e38, math.nan))
    huge.operation = "MULTIPLY"
    tree.links.new(place, huge.inputs[0])
    tree.links.new(huge.outputs[0], shader.inputs["Base Color"])
    tree.links.new(huge.outputs[0], shader.inputs["Normal"])
    return ""


def image_node(tree: Any, shader: Any, image: Any) -> Any:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return node


def no_image(tree: Any, shader: Any) -> str:
    image_node(tree, shader, None)
    return ""


def missing_image(tree: Any, shader: Any) -> str:
    made = bpy.data.images.new("Gone", 1, 1)
    made.source, made.filepath = "FILE", "//gone/nowhere.png"
    image_node(tree, shader, made)
    return "is missing"


def broken_image(tree: Any, shader: Any) -> str:
    """A file whose header is right and whose pixels end too early."""
    whole = bpy.data.images.new("Whole", 64, 64)
    whole.pixels.foreach_set(np.random.default_rng(1).random(64 * 64 * 4, dtype=np.float32))
    path = Path(bpy.app.tempdir) / "broken.png"
    whole.filepath_raw, whole.file_format = str(path), "PNG"
    whole.save()
    path.write_bytes(path.read_bytes()[:700])
    image_node(tree, shader, bpy.data.images.load(str(path)))
    return "cannot be read"


def nan_image(tree: Any, shader: Any) -> str:
    made = bpy.data.images.new("Wild", 4, 4, float_buffer=True)
    made.pixels.foreach_set(np.tile(np.float32([math.nan, math.inf, -math.inf, 1.0]), 16))
    image_node(tree, shader, made)
    return ""


def tiny_image(tree: Any, shader: Any) -> str:
    image_node(tree, shader, bpy.data.images.new("Tiny", 1, 1)).interpolation = "Cubic"
    return ""


def long_image(tree: Any, shader: Any) -> str:
    """16384 texels by one."""
    image_node(tree, shader, bpy.data.images.new("Long", 16384, 1))
    return ""


def text_for_a_number(tree: Any, shader: Any) -> str:
    """An attribute of the object that is a text."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type, node.attribute_name = "OBJECT", "label"
    tree.links.new(node.outputs["Fac"], shader.inputs["Roughness"])
    return ""


def strange_attributes(tree: Any, shader: Any) -> str:
    """Attributes that no one has, with names that mean something inside."""
    last = tree.nodes.new("ShaderNodeAttribute")
    last.attribute_name = "tangent:"
    other = tree.nodes.new("ShaderNodeAttribute")
    other.attribute_name = 'no"thing]'
    other.attribute_type = "OBJECT"
    tree.links.new(last.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(other.outputs["Fac"], shader.inputs["Roughness"])
    return ""


def shader_as_value(tree: Any, shader: Any) -> str:
    """A value where a shader is asked for."""
    tree.links.new(
        tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], tree.nodes["Material Output"].inputs["Surface"]
    )
    return ""


TREES: list[Callable[[Any, Any], str]] = [
    deep_values, deep_shaders, deep_groups, circle, circle_of_shaders, muted_circle, wild_numbers, wild_variables,
    no_image, missing_image, broken_image, nan_image, tiny_image, long_image, text_for_a_number, strange_attributes,
    shader_as_value,
]  # fmt: skip


@pytest.mark.parametrize("build", TREES, ids=lambda build: build.__name__)
def test_hostile_tree(studio: Any, build: Callable[[Any, Any], str]) -> None:
    material = studio.material("ShaderNodeBsdfPrincipled")
    plane = studio.plane(material=material)
    plane["label"] = "some text"
    plane.data.uv_layers.new(name="UVMap")
    studio.area(energy=150)
    studio.camera()
    studio.scene.shlight.pixel_samples = 1
    named = build(material.node_tree, material.node_tree.nodes["Principled BSDF"])
    image = studio.render("SHLIGHT")
    assert np.isfinite(image).all()
    assert named in "\n".join(studio.messages(most=99))
