# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that say where a hit is and what it is on."""

from __future__ import annotations

import math

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.mathematics import reflect
from shlight.nodes.values import clamp, dot, maximum, minimum, number, operation, select, sqrt

from ..report import Effect
from .blackbody import blackbody_rgb
from .expressions import Expression, NodeInputs, ReadNode
from .mesh_attributes import GENERATED, INSTANCE_COLOR, TANGENT, ObjectValue


def _texture_coordinate(inputs: NodeInputs) -> Expression:
    name = inputs.output.name
    if inputs.node.from_instancer and name in ("Generated", "UV"):
        inputs.remark("'From Instancer' is not supported; the object's own coordinates are used")
    if name == "UV":
        return nodes.uv("")
    if name == "Generated":
        return nodes.attribute(GENERATED)
    if name == "Normal":
        return nodes.values.normalize(nodes.inputs.normal_to_object(nodes.normal()))
    if name == "Object":
        if inputs.node.object is not None:
            inputs.remark("the coordinates of another object are not supported; the object's own are used")
        return nodes.inputs.point_to_object(nodes.position())
    if name == "Reflection":
        return -reflect(nodes.towards_viewer() * -1.0, nodes.normal()) * -1.0
    inputs.remark(f"'{name}' coordinates are not supported; (0, 0, 0) is used")
    return Vector(0.0, 0.0, 0.0)


def _uv_map(inputs: NodeInputs) -> Vector:
    if inputs.node.from_instancer:
        inputs.remark("'From Instancer' is not supported; the object's own map is used")
    return nodes.uv(inputs.node.uv_map)


def _attribute(inputs: NodeInputs) -> Expression:
    node = inputs.node
    if node.attribute_type != "GEOMETRY":
        inputs.remark(f"attributes of the type {node.attribute_type} are not supported; 0 is used")
        return number(0.0)
    return _of_attribute(inputs, node.attribute_name) if node.attribute_name else number(0.0)


def _of_attribute(inputs: NodeInputs, name: str) -> Expression:
    found = nodes.attribute(name)
    output = inputs.output.name
    if output == "Alpha":
        return found.alpha
    if output == "Vector":
        return Vector(*found)
    return found.as_number() if output == "Fac" else found


def _color_attribute(inputs: NodeInputs) -> Expression:
    found = nodes.attribute(f"{INSTANCE_COLOR}{inputs.node.layer_name}")
    return found.alpha if inputs.output.name == "Alpha" else found


def _geometry(inputs: NodeInputs) -> Expression:
    name = inputs.output.name
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
        return nodes.barycentric()
    inputs.remark(f"'{name}' is not supported; 0 is used")
    return number(0.0)


def _object_info(inputs: NodeInputs) -> Expression:
    name = inputs.output.name
    if name == "Location":
        return Vector(*(nodes.inputs.read("object_to_world", 4 * row + 3) for row in range(3)))
    if name == "Color":
        return Color(*(nodes.object_value(ObjectValue.RED + i) for i in range(3)))
    index = {
        "Alpha": ObjectValue.ALPHA,
        "Object Index": ObjectValue.OBJECT_INDEX,
        "Material Index": ObjectValue.MATERIAL_INDEX,
        "Random": ObjectValue.RANDOM,
    }[name]
    return nodes.object_value(index)


def _fresnel_of(cosine: Value, ior: Value) -> Value:
    """The reflectance of a dielectric, 1 under total reflection."""
    c = abs(cosine)
    square = ior * ior - 1.0 + c * c
    g = sqrt(square)
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return select(square > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def _own_normal(inputs: NodeInputs) -> Vector:
    return inputs.vector("Normal") if inputs.is_linked("Normal") else nodes.normal()


def _fresnel(inputs: NodeInputs) -> Value:
    ior = maximum(inputs.number("IOR"), 1e-5)
    ior = select(nodes.backfacing(), 1.0 / ior, ior)
    return _fresnel_of(dot(nodes.towards_viewer(), _own_normal(inputs)), ior)


def _layer_weight(inputs: NodeInputs) -> Value:
    blend = inputs.number("Blend")
    cosine = dot(nodes.towards_viewer(), _own_normal(inputs))
    if inputs.output.name == "Fresnel":
        ior = maximum(1.0 - blend, 1e-5)
        return _fresnel_of(cosine, select(nodes.backfacing(), ior, 1.0 / ior))
    share = clamp(blend, 0.0, 1.0 - 1e-5)
    exponent = select(share < 0.5, 2.0 * share, 0.5 / (1.0 - share))
    return 1.0 - operation("power", abs(cosine), exponent)


def _light_path(inputs: NodeInputs) -> Value:
    name = inputs.output.name
    shadow = nodes.inputs.shadow_ray()
    if name == "Is Camera Ray":
        return 1.0 - shadow
    if name == "Is Shadow Ray":
        return shadow
    if name == "Ray Length":
        return nodes.inputs.ray_length()
    if name == "Transparent Depth":
        return nodes.inputs.transparent_depth()
    return number(0.0)


def _tangent(inputs: NodeInputs) -> Vector:
    node = inputs.node
    if node.direction_type != "UV_MAP":
        inputs.remark("radial tangents are not supported; 0 is used")
        return Vector(0.0, 0.0, 0.0)
    known = nodes.attribute(f"{TANGENT}{node.uv_map}")
    return nodes.values.normalize(nodes.inputs.vector_to_world(Vector(*known)))


def _normal_map(inputs: NodeInputs) -> Vector:
    node = inputs.node
    space = {"TANGENT": "tangent", "OBJECT": "object", "BLENDER_OBJECT": "object"}.get(node.space, "world")
    color: Vector = inputs.color("Color")
    if node.space.startswith("BLENDER"):
        color = Vector(color.x, 1.0 - color.y, 1.0 - color.z)
    return nodes.normal_map(color, inputs.number("Strength"), space=space, tangents=f"{TANGENT}{node.uv_map}")


def _bump(inputs: NodeInputs) -> Vector:
    at = inputs.vector("Normal") if inputs.is_linked("Normal") else None
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
    place = inputs.vector("Vector") if inputs.is_linked("Vector") else nodes.attribute(GENERATED)
    floors = [
        operation("modulo", abs(operation("floor", (c * inputs.number("Scale") + 1e-6) * 0.999999)), 2.0) for c in place
    ]
    same = operation("equal", operation("equal", floors[0], floors[1]), floors[2])
    if inputs.output.name == "Fac":
        return same
    first, second = inputs.color("Color1"), inputs.color("Color2")
    return Color(*(select(same, a, b) for a, b in zip(first, second, strict=True)))


def _gradient(inputs: NodeInputs) -> Expression:
    place = inputs.vector("Vector") if inputs.is_linked("Vector") else nodes.attribute(GENERATED)
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
    w = [inputs.number("W")] if count in (1, 4) else []
    place = inputs.vector("Vector") if count > 1 and inputs.is_linked("Vector") else nodes.position()
    key = ([*place][: min(count, 3)] if count > 1 else []) + w

    def noise(*more: float) -> Value:
        return operation(f"hash{len(key) + len(more)}", *key, *more)

    if inputs.output.name == "Value":
        return noise()
    if count < 4:
        return Color(noise(), noise(1.0), noise(2.0))
    inputs.remark("the colour of white noise in four dimensions is not supported; its value is used", Effect.SLIGHT)
    return noise()


INPUT_NODES: dict[str, ReadNode] = {
    "TEX_COORD": _texture_coordinate,
    "UVMAP": _uv_map,
    "ATTRIBUTE": _attribute,
    "VERTEX_COLOR": _color_attribute,
    "NEW_GEOMETRY": _geometry,
    "OBJECT_INFO": _object_info,
    "FRESNEL": _fresnel,
    "LAYER_WEIGHT": _layer_weight,
    "LIGHT_PATH": _light_path,
    "TANGENT": _tangent,
    "NORMAL_MAP": _normal_map,
    "BUMP": _bump,
    "BLACKBODY": _blackbody,
    "TEX_CHECKER": _checker,
    "TEX_GRADIENT": _gradient,
    "TEX_WHITE_NOISE": _white_noise,
}
__all__ = ["INPUT_NODES", "minimum"]
