# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that say where a hit is and what it is on."""

from __future__ import annotations

import math

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.values import clamp, dot, equal, maximum, number, operation, select, sqrt

from ..names import name_of
from .blackbody import blackbody_rgb
from .expressions import Expression, NodeInputs, ReadNode
from .frame_nodes import around
from .mesh_attributes import COLOR, GENERATED, TANGENT
from .object_values import RANDOM, property_color


def _uv_map(inputs: NodeInputs) -> Vector:
    if inputs.node.from_instancer:
        inputs.remark("'From Instancer' is not supported; the object's own map is used")
    return nodes.uv(name_of(inputs.node, "uv_map"))


def _attribute(inputs: NodeInputs) -> Expression:
    node, around = inputs.node, inputs.reader.surroundings
    name, kind = name_of(node, "attribute_name"), node.attribute_type
    if not name:
        return number(0.0)
    if kind == "GEOMETRY":
        return _channel(inputs, nodes.attribute(name), nodes.inputs.attribute_mean(name))
    if kind == "VIEW_LAYER":
        graph = around.depsgraph
        owners = [] if graph is None else [graph.view_layer_eval, graph.scene_eval, graph.scene_eval.world]
        return _channel(inputs, Color(*property_color(owners, name)))
    return _channel(inputs, _of_object(inputs, kind, name))


def _of_object(inputs: NodeInputs, kind: str, name: str) -> Color:
    first = inputs.reader.surroundings.object_values.first(kind, name)
    return Color(*(nodes.object_value(first + i) for i in range(4)))


def _channel(inputs: NodeInputs, found: Color, mean: Value | None = None) -> Expression:
    output = inputs.output.identifier
    if output == "Alpha":
        return found.alpha
    if output == "Vector":
        return Vector(*found)
    if output == "Fac":
        return (found.x + found.y + found.z) * (1.0 / 3.0) if mean is None else mean
    return found


def _color_attribute(inputs: NodeInputs) -> Expression:
    found = nodes.attribute(f"{COLOR}{name_of(inputs.node, 'layer_name')}")
    return found.alpha if inputs.output.identifier == "Alpha" else found


def _geometry(inputs: NodeInputs) -> Expression:
    name = inputs.output.identifier
    if name == "Position":
        return nodes.position()
    if name == "Normal":
        return nodes.normal()
    if name == "True Normal":
        return nodes.geometric_normal()
    if name == "Incoming":
        return nodes.towards_viewer()
    if name == "Backfacing":
        return nodes.backfacing()
    if name == "Parametric":
        return Vector(1.0 - nodes.barycentric().x - nodes.barycentric().y, nodes.barycentric().x, 0.0)
    if name == "Tangent":
        return around("Z")
    return nodes.attribute(f"\0{name.lower()}:").x


def _object_info(inputs: NodeInputs) -> Expression:
    name = inputs.output.identifier
    if name == "Location":
        return Vector(*(nodes.inputs.read("object_to_world", 4 * row + 3) for row in range(3)))
    if name == "Material Index":
        return number(float(getattr(inputs.reader.owner, "pass_index", 0)))
    if name == "Random":
        return _of_object(inputs, RANDOM, "").x
    found = _of_object(inputs, "OBJECT", "pass_index" if name == "Object Index" else "color")
    return found.alpha if name == "Alpha" else found if name == "Color" else found.x


def fresnel_of(cosine: Value, ior: Value) -> Value:
    """The reflectance of a dielectric, 1 under total reflection."""
    c = abs(cosine)
    square = ior * ior - 1.0 + c * c
    g = sqrt(square)
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return select(square > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def _own_normal(inputs: NodeInputs) -> Vector:
    return inputs.vector_or("Normal", nodes.normal())


def _fresnel(inputs: NodeInputs) -> Value:
    ior = maximum(inputs.number("IOR"), 1e-5)
    ior = select(nodes.backfacing(), 1.0 / ior, ior)
    return fresnel_of(dot(nodes.towards_viewer(), _own_normal(inputs)), ior)


def _layer_weight(inputs: NodeInputs) -> Value:
    blend = inputs.number("Blend")
    cosine = dot(nodes.towards_viewer(), _own_normal(inputs))
    if inputs.output.identifier == "Fresnel":
        ior = maximum(1.0 - blend, 1e-5)
        return fresnel_of(cosine, select(nodes.backfacing(), ior, 1.0 / ior))
    share = clamp(blend, 0.0, 1.0 - 1e-5)
    exponent = select(share < 0.5, 2.0 * share, 0.5 / (1.0 - share))
    return 1.0 - operation("power", abs(cosine), exponent)


def _light_path(inputs: NodeInputs) -> Value:
    name = inputs.output.identifier
    if name == "Is Camera Ray":
        return nodes.rays.camera_ray()
    if name == "Is Shadow Ray":
        return nodes.rays.shadow_ray()
    if name == "Ray Length":
        return nodes.inputs.ray_length()
    if name == "Transparent Depth":
        return nodes.inputs.transparent_depth()
    return number(0.0)


def _light_falloff(inputs: NodeInputs) -> Value:
    if inputs.output.identifier != "Quadratic" or inputs.number("Smooth").constant != 0.0:
        inputs.remark("only Quadratic, the falloff of real light, is supported, without Smooth; it is used")
    return inputs.number("Strength")


def _normal_map(inputs: NodeInputs) -> Vector:
    node = inputs.node
    space = {"TANGENT": "tangent", "OBJECT": "object", "BLENDER_OBJECT": "object"}.get(node.space, "world")
    color: Vector = inputs.color("Color")
    if node.space.startswith("BLENDER"):
        color = Vector(color.x, 1.0 - color.y, 1.0 - color.z)
    return nodes.normal_map(
        color, inputs.number("Strength"), space=space, tangents=f"{TANGENT}{name_of(node, 'uv_map')}"
    )


def _bump(inputs: NodeInputs) -> Vector:
    at = inputs.linked_vector("Normal")
    height, strength, distance = (inputs.number(name) for name in ("Height", "Strength", "Distance"))
    if not inputs.is_linked("Height"):
        return nodes.normal() if at is None else at
    return nodes.bump(height, strength, distance, at=at, invert=inputs.node.invert)


def _blackbody(inputs: NodeInputs) -> Expression:
    constant = inputs.number("Temperature").constant
    if constant is None:
        inputs.remark("a temperature that varies is not supported; 6500 K is used")
        constant = 6500.0
    return Color(*blackbody_rgb(constant))


def _checker(inputs: NodeInputs) -> Expression:
    place = inputs.vector_or("Vector", nodes.attribute(GENERATED))
    floors = [
        operation("modulo", abs(operation("floor", (c * inputs.number("Scale") + 1e-6) * 0.999999)), 2.0) for c in place
    ]
    same = equal(equal(floors[0], floors[1]), floors[2])
    if inputs.output.identifier == "Fac":
        return same
    first, second = inputs.color("Color1"), inputs.color("Color2")
    return Color(*(select(same, a, b) for a, b in zip(first, second, strict=True)))


def _gradient(inputs: NodeInputs) -> Expression:
    place = inputs.vector_or("Vector", nodes.attribute(GENERATED))
    x, y, _ = place
    kind = inputs.node.gradient_type
    if kind == "RADIAL":
        found = operation("arctangent2", y, x) / (2.0 * math.pi) + 0.5
    elif kind in ("SPHERICAL", "QUADRATIC_SPHERE"):
        found = maximum(0.999999 - nodes.values.length(place), 0.0)
        found = found * found if kind == "QUADRATIC_SPHERE" else found
    elif kind == "EASING":
        t = clamp(x)
        found = t * t * (3.0 - 2.0 * t)
    elif kind == "QUADRATIC":
        r = maximum(x, 0.0)
        found = r * r
    else:
        found = (x + y) * 0.5 if kind == "DIAGONAL" else x
    return clamp(found)


def _white_noise(inputs: NodeInputs) -> Expression:
    count = int(inputs.node.noise_dimensions[0])
    along = [inputs.number("W")] if count in (1, 4) else []
    place = inputs.vector("Vector") if count > 1 and inputs.is_linked("Vector") else nodes.position()
    key = ([*place][: min(count, 3)] if count > 1 else []) + along

    def noise(*more: float) -> Value:
        return operation(f"hash{len(key) + len(more)}", *key, *more)

    if inputs.output.identifier == "Value":
        return noise()
    if count < 4:
        return Color(noise(), noise(1.0), noise(2.0))
    x, y, z, w = key
    return Color(noise(), operation("hash4", z, x, w, y), operation("hash4", w, z, y, x))


INPUT_NODES: dict[str, ReadNode] = {
    "UVMAP": _uv_map,
    "ATTRIBUTE": _attribute,
    "VERTEX_COLOR": _color_attribute,
    "NEW_GEOMETRY": _geometry,
    "OBJECT_INFO": _object_info,
    "FRESNEL": _fresnel,
    "LAYER_WEIGHT": _layer_weight,
    "LIGHT_FALLOFF": _light_falloff,
    "LIGHT_PATH": _light_path,
    "NORMAL_MAP": _normal_map,
    "BUMP": _bump,
    "BLACKBODY": _blackbody,
    "TEX_CHECKER": _checker,
    "TEX_GRADIENT": _gradient,
    "TEX_WHITE_NOISE": _white_noise,
}
