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


def deep_values(tree: Any, shader: Any) -> None:
    """A chain of mathematics from an attribute."""
    last = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    for _ in range(DEPTH):
        node = value_node(tree, "ShaderNodeMath", _1=1e-4)
        tree.links.new(last, node.inputs[0])
        last = node.outputs[0]
    tree.links.new(last, shader.inputs["Roughness"])


def deep_shaders(tree: Any, shader: Any) -> None:
    """A chain of mixtures."""
    last = shader.outputs[0]
    for _ in range(DEPTH // 2):
        node = value_node(tree, "ShaderNodeMixShader", _0=0.01)
        tree.links.new(last, node.inputs[1])
        tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], node.inputs[2])
        last = node.outputs[0]
    tree.links.new(last, tree.nodes["Material Output"].inputs["Surface"])


def deep_groups(tree: Any, shader: Any) -> None:
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


def circle(tree: Any, shader: Any) -> None:
    """A circle of links, half of it muted."""
    a, b = (value_node(tree, "ShaderNodeMath", _1=0.5) for _ in range(2))
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    a.mute = True
    tree.links.new(b.outputs[0], shader.inputs["Roughness"])


def circle_of_shaders(tree: Any, shader: Any) -> None:
    mixed = [tree.nodes.new("ShaderNodeMixShader") for _ in range(2)]
    tree.links.new(mixed[0].outputs[0], mixed[1].inputs[1])
    tree.links.new(mixed[1].outputs[0], mixed[0].inputs[1])
    tree.links.new(shader.outputs[0], mixed[0].inputs[2])
    tree.links.new(mixed[1].outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def muted_circle(tree: Any, shader: Any) -> None:
    """Muted nodes whose inner links lead to each other."""
    a, b = (tree.nodes.new("ShaderNodeGamma") for _ in range(2))
    tree.links.new(a.outputs[0], b.inputs[0])
    tree.links.new(b.outputs[0], a.inputs[0])
    a.mute = b.mute = True
    tree.links.new(b.outputs[0], shader.inputs["Base Color"])


def wild_numbers(tree: Any, shader: Any) -> None:
    """Sockets out of all bounds; Blender clamps some of them."""
    for name, value in (("Roughness", -3.0), ("Metallic", math.inf), ("IOR", -math.inf), ("Alpha", math.nan)):
        source = tree.nodes.new("ShaderNodeValue")
        source.outputs[0].default_value = value
        tree.links.new(source.outputs[0], shader.inputs[name])
    shader.inputs["Base Color"].default_value = (math.nan, math.inf, -1e30, 1.0)


def wild_variables(tree: Any, shader: Any) -> None:
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


def image_node(tree: Any, shader: Any, image: Any) -> Any:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return node


def clipped(tree: Any, shader: Any, node: Any) -> None:
    """Cycles' pixel in place of a picture fades towards its edges."""
    node.extension = "CLIP"
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])


def no_image(tree: Any, shader: Any) -> None:
    clipped(tree, shader, image_node(tree, shader, None))


def missing_image(tree: Any, shader: Any) -> None:
    made = bpy.data.images.new("Gone", 1, 1)
    made.source, made.filepath = "FILE", "//gone/nowhere.png"
    clipped(tree, shader, image_node(tree, shader, made))


def broken_image(tree: Any, shader: Any) -> None:
    """A file whose header is right and whose pixels end too early."""
    whole = bpy.data.images.new("Whole", 64, 64)
    whole.pixels.foreach_set(np.random.default_rng(1).random(64 * 64 * 4, dtype=np.float32))
    path = Path(bpy.app.tempdir) / "broken.png"
    whole.filepath_raw, whole.file_format = str(path), "PNG"
    whole.save()
    path.write_bytes(path.read_bytes()[:700])
    image_node(tree, shader, bpy.data.images.load(str(path)))


def nan_image(tree: Any, shader: Any) -> None:
    made = bpy.data.images.new("Wild", 4, 4, float_buffer=True)
    made.pixels.foreach_set(np.tile(np.float32([math.nan, math.inf, -math.inf, 1.0]), 16))
    image_node(tree, shader, made)


def tiny_image(tree: Any, shader: Any) -> None:
    image_node(tree, shader, bpy.data.images.new("Tiny", 1, 1)).interpolation = "Cubic"


def long_image(tree: Any, shader: Any) -> None:
    """16384 texels by one."""
    image_node(tree, shader, bpy.data.images.new("Long", 16384, 1))


def text_for_a_number(tree: Any, shader: Any) -> None:
    """An attribute of the object that is a text."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type, node.attribute_name = "OBJECT", "label"
    tree.links.new(node.outputs["Fac"], shader.inputs["Roughness"])


def strange_attributes(tree: Any, shader: Any) -> None:
    """Attributes that no one has, with names that mean something inside."""
    last = tree.nodes.new("ShaderNodeAttribute")
    last.attribute_name = "tangent:"
    other = tree.nodes.new("ShaderNodeAttribute")
    other.attribute_name = 'no"thing]'
    other.attribute_type = "OBJECT"
    tree.links.new(last.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(other.outputs["Fac"], shader.inputs["Metallic"])


def shader_as_value(tree: Any, shader: Any) -> None:
    """A value where a shader is asked for."""
    tree.links.new(
        tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"], tree.nodes["Material Output"].inputs["Surface"]
    )


# The words of the report, if it says any, and whether Cycles draws a picture that can be told from one without light.
TREES: list[tuple[Callable[[Any, Any], None], str, bool]] = [
    (deep_values, "", False),
    (deep_shaders, "", False),
    (deep_groups, "", True),
    (circle, "its links run in a circle; 0 is used", True),
    (circle_of_shaders, "", False),
    (muted_circle, "", False),
    (wild_numbers, "an 'IOR' below 1", False),
    (wild_variables, "", False),
    (no_image, "", True),
    (missing_image, "is missing", True),
    (broken_image, "cannot be read", False),
    (nan_image, "", False),
    (tiny_image, "", True),
    (long_image, "", True),
    (text_for_a_number, "", True),
    (strange_attributes, "it has no attribute or UV map 'tangent:'", True),
    (shader_as_value, "", True),
]


@pytest.mark.parametrize(("build", "named", "drawn"), TREES, ids=lambda value: getattr(value, "__name__", ""))
def test_hostile_tree(studio: Any, build: Callable[[Any, Any], None], named: str, drawn: bool) -> None:
    material = studio.material("ShaderNodeBsdfPrincipled")
    plane = studio.plane(material=material)
    plane["label"] = "some text"
    plane.data.uv_layers.new(name="UVMap")
    studio.box((0.5, 0.5, 0.5), studio.material(name="Witness"), location=(0, 0, 1.2))  # of nothing that is wrong
    studio.area(energy=150)
    studio.camera()
    build(material.node_tree, material.node_tree.nodes["Principled BSDF"])
    if drawn and (build is not circle or bpy.app.version < (5, 0, 0)):  # Cycles draws another part of it then
        image, _ = studio.compare()
    else:
        image = studio.render("SHLIGHT")
    assert np.isfinite(image).all()
    assert image[..., :3].max() > 0.1  # the box, whatever becomes of the floor
    messages = studio.messages(most=99)
    assert len(messages) == bool(named), messages
    assert named in "".join(messages)
