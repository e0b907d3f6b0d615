# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that say where a hit is, in the frames of the object, of another one and of the camera, and what it is on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.fresnel import fresnel_of
from shlight.nodes.inputs import normal_to_object, normal_to_world, point_to_object, point_to_world, vector_to_object
from shlight.nodes.mathematics import reflect
from shlight.nodes.values import clamp, cross, dot, length, maximum, normalize, number, operation, select, sqrt

from ..compat import TANGENT_SPACE_IS_UNIT, filter_width
from ..names import name_of
from .camera import View
from .mesh_attributes import (
    COLOR,
    CURVE_INTERCEPT,
    CURVE_LENGTH,
    CURVE_RANDOM,
    CURVE_THICKNESS,
    GENERATED,
    IS_CURVE,
    POINTINESS,
    RANDOM_PER_ISLAND,
    TANGENT,
)
from .nodes import Expression, NodeInputs, ReadNode
from .object_values import FROM_INSTANCER, RANDOM, property_color

Array = NDArray[np.float64]


def _rows(matrix: Array, v: Vector) -> Vector:
    """A matrix of three rows times a vector; a fourth column is added."""
    offset = matrix[:, 3] if matrix.shape[1] == 4 else np.zeros(3)
    rows = [dot(Vector(*(float(c) for c in row[:3])), v) for row in matrix]
    return Vector(*(row + float(o) for row, o in zip(rows, offset, strict=True)))


def _in_camera(view: View) -> Vector:
    return _rows(np.array(view.to_camera), nodes.position())


def _in_window(view: View) -> Vector:
    """(0, 0) at the picture's lower left corner, (1, 1) at its upper right one."""
    x, y, depth = _in_camera(view)
    (slope_x, slope_y), (offset_x, offset_y) = view.slope, view.offset
    if not view.orthographic:
        x, y = x / depth, y / depth
    return Vector(0.5 + 0.5 * (x * slope_x + offset_x), 0.5 + 0.5 * (y * slope_y + offset_y), 0.0)


COORDINATES: dict[str, Callable[[], Vector]] = {
    "UV": lambda: nodes.uv(""),
    "Generated": lambda: nodes.attribute(GENERATED),
    "Normal": lambda: normalize(normal_to_object(nodes.normal())),
    "Reflection": lambda: reflect(-nodes.towards_viewer(), nodes.normal()),
}


def _texture_coordinate(inputs: NodeInputs) -> Expression:
    name, view = inputs.output.identifier, inputs.reader.surroundings.view
    if inputs.node.from_instancer and name in ("Generated", "UV"):
        return Vector(*_of_object(inputs, FROM_INSTANCER, name))
    if name in COORDINATES:
        return COORDINATES[name]()
    if name == "Object":
        other = inputs.node.object
        if other is None:
            return point_to_object(nodes.position())
        return _rows(np.linalg.pinv(np.array(other.matrix_world, dtype=np.float64))[:3], nodes.position())
    if view is None or (name == "Window" and view.panoramic):
        inputs.remark(f"'{name}' coordinates are not supported here; (0, 0, 0) is used")
        return Vector(0.0, 0.0, 0.0)
    return _in_camera(view) if name == "Camera" else _in_window(view)


def _camera_data(inputs: NodeInputs) -> Expression:
    view, name = inputs.reader.surroundings.view, inputs.output.identifier
    if view is None:
        inputs.remark("the camera is not known here; 0 is used")
        return number(0.0)
    place = _in_camera(view)
    return normalize(place) if name == "View Vector" else place.z if name == "View Z Depth" else length(place)


Move = Callable[[Vector], Vector]
# Functions from the object's frame to the world, and back, by kinds of vectors.
OBJECT_MOVES: dict[str, tuple[Move, Move]] = {
    "POINT": (point_to_world, point_to_object),
    "VECTOR": (nodes.inputs.vector_to_world, vector_to_object),
    "NORMAL": (normal_to_world, normal_to_object),
}


def _camera_matrices(kind: str, view: View | None) -> tuple[Array, Array]:
    """Matrices that bring a vector of this kind from the camera's frame to the world, and back."""
    to_camera = np.eye(3, 4) if view is None else np.array(view.to_camera)
    to_world = np.linalg.inv(np.vstack([to_camera, (0.0, 0.0, 0.0, 1.0)]))[:3]
    if kind == "NORMAL":
        return to_camera[:, :3].T, to_world[:, :3].T
    columns = 3 if kind == "VECTOR" else 4
    return to_world[:, :columns], to_camera[:, :columns]


def _vector_transform(inputs: NodeInputs) -> Vector:
    node, view, found = inputs.node, inputs.reader.surroundings.view, inputs.vector("Vector")
    if node.convert_from == node.convert_to:
        return found
    if view is None and "CAMERA" in (node.convert_from, node.convert_to):
        inputs.remark("the camera is not known here; the world's frame is used in its place")
    moves, matrices = OBJECT_MOVES[node.vector_type], _camera_matrices(node.vector_type, view)
    for way, frame in enumerate((node.convert_from, node.convert_to)):
        if frame != "WORLD":
            found = moves[way](found) if frame == "OBJECT" else _rows(matrices[way], found)
    return normalize(found) if node.vector_type == "NORMAL" else found


# The direction around each axis at a place of the texture space, relative to its middle.
AROUND: dict[str, Callable[[Vector], Vector]] = {
    "X": lambda p: Vector(0.0, -p.z, p.y),
    "Y": lambda p: Vector(-p.z, 0.0, p.x),
    "Z": lambda p: Vector(-p.y, p.x, 0.0),
}


def _in_surface(along: Vector) -> Vector:
    """A direction of the object's frame, turned into the surface."""
    n = nodes.normal()
    return cross(n, normalize(cross(normal_to_world(along), n)))


def around(axis: str) -> Vector:
    """The tangent that runs around an axis of the object's texture space."""
    return _in_surface(AROUND[axis](Vector(*nodes.attribute(GENERATED)) - 0.5))


def _tangent(inputs: NodeInputs) -> Vector:
    node = inputs.node
    if node.direction_type == "RADIAL":
        return around(node.axis)
    return _in_surface(Vector(*nodes.attribute(f"{TANGENT}{name_of(node, 'uv_map')}")))


def _uv_map(inputs: NodeInputs) -> Vector:
    if inputs.node.from_instancer:
        return Vector(*_of_object(inputs, FROM_INSTANCER, "UV"))
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


def _parametric() -> Vector:
    x, y = nodes.barycentric().x, nodes.barycentric().y
    return Vector(1.0 - x - y, x, 0.0)


GEOMETRY: dict[str, Callable[[], Expression]] = {
    "Position": nodes.position,
    "Normal": nodes.normal,
    "True Normal": nodes.geometric_normal,
    "Incoming": nodes.towards_viewer,
    "Backfacing": nodes.backfacing,
    "Parametric": _parametric,
    "Tangent": lambda: around("Z"),
    "Pointiness": lambda: nodes.attribute(POINTINESS).x,
    "Random Per Island": lambda: nodes.attribute(RANDOM_PER_ISLAND).x,
}


CURVES_INFO = {
    "Is Strand": IS_CURVE,
    "Intercept": CURVE_INTERCEPT,
    "Length": CURVE_LENGTH,
    "Thickness": CURVE_THICKNESS,
    "Random": CURVE_RANDOM,
}


def _curves_info(inputs: NodeInputs) -> Expression:
    if inputs.output.identifier in CURVES_INFO:
        return nodes.attribute(CURVES_INFO[inputs.output.identifier]).x
    inputs.remark(f"'{inputs.output.identifier}' is not supported; the normal is used")
    return nodes.normal()


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


def _wireframe(inputs: NodeInputs) -> Value:
    width, view = inputs.number("Size"), inputs.reader.surroundings.view
    if inputs.node.use_pixel_size:
        if view is None:
            inputs.remark("the camera is not known here; a pixel is 0 wide")
        width = width * (number(0.0) if view is None else _pixel(view))
    return nodes.edge_distance() < 0.5 * width


def _pixel(view: View) -> Value:
    """The width of a pixel where the hit is, the mean of two directions across the surface that Cycles takes for it."""
    n, place = nodes.geometric_normal(), _in_camera(view)
    first = normalize(Vector(n.z - n.y, n.x - n.z, n.y - n.x))
    to_viewer = nodes.towards_viewer()
    width = _across(dot(first, to_viewer), dot(cross(n, first), to_viewer)) * view.pixel
    ray = normalize(place)
    return width if view.orthographic else width * place.z * _across(ray.x, ray.y)


def _across(first: Value, second: Value) -> Value:
    """The mean length of two unit vectors without their parts along a direction."""
    return 0.5 * (sqrt(1.0 - first * first) + sqrt(1.0 - second * second))


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


LIGHT_PATH: dict[str, Callable[[], Value]] = {
    "Is Camera Ray": nodes.rays.camera_ray,
    "Is Shadow Ray": nodes.rays.shadow_ray,
    "Ray Length": nodes.inputs.ray_length,
    "Transparent Depth": nodes.inputs.transparent_depth,
}


def _light_falloff(inputs: NodeInputs) -> Value:
    if inputs.output.identifier != "Quadratic" or inputs.number("Smooth").constant != 0.0:
        inputs.remark("only Quadratic, the falloff of real light, is supported, without Smooth; it is used")
    return inputs.number("Strength")


def _normal_map(inputs: NodeInputs) -> Vector:
    inputs.remark_bumps()
    node = inputs.node
    space = {"TANGENT": "tangent", "OBJECT": "object", "BLENDER_OBJECT": "object"}.get(node.space, "world")
    color: Vector = inputs.color("Color")
    if node.space.startswith("BLENDER"):
        color = Vector(color.x, 1.0 - color.y, 1.0 - color.z)
    if getattr(node, "convention", "") == "DIRECTX":
        color = Vector(color.x, 1.0 - color.y, color.z)
    return nodes.normal_map(
        color,
        inputs.number("Strength"),
        space=space,
        tangents=f"{TANGENT}{name_of(node, 'uv_map')}",
        unit_normal=TANGENT_SPACE_IS_UNIT,
    )


def _bump(inputs: NodeInputs) -> Vector:
    at = inputs.linked_vector("Normal")
    height, strength, distance = (inputs.number(name) for name in ("Height", "Strength", "Distance"))
    if not inputs.is_linked("Height"):
        return nodes.normal() if at is None else at
    inputs.remark_bumps()
    return nodes.bump(
        height, strength, distance, at=at, invert=inputs.node.invert, filter_width=filter_width(inputs.node)
    )


def _bevel(inputs: NodeInputs) -> Vector:
    inputs.remark("Bevel is not supported; the normal without it is used")
    return _own_normal(inputs)


def _ambient_occlusion(inputs: NodeInputs) -> Expression:
    inputs.remark("Ambient Occlusion is not supported; it is as if nothing were near")
    return inputs.color("Color") if inputs.output.identifier == "Color" else number(1.0)


INPUT_NODES: dict[str, ReadNode] = {
    "TEX_COORD": _texture_coordinate,
    "CAMERA": _camera_data,
    "VECT_TRANSFORM": _vector_transform,
    "TANGENT": _tangent,
    "UVMAP": _uv_map,
    "ATTRIBUTE": _attribute,
    "VERTEX_COLOR": _color_attribute,
    "NEW_GEOMETRY": lambda inputs: GEOMETRY[inputs.output.identifier](),
    "OBJECT_INFO": _object_info,
    "HAIR_INFO": _curves_info,
    "FRESNEL": _fresnel,
    "LAYER_WEIGHT": _layer_weight,
    "LIGHT_FALLOFF": _light_falloff,
    "LIGHT_PATH": lambda inputs: LIGHT_PATH.get(inputs.output.identifier, lambda: number(0.0))(),
    "NORMAL_MAP": _normal_map,
    "BUMP": _bump,
    "BEVEL": _bevel,
    "WIREFRAME": _wireframe,
    "AMBIENT_OCCLUSION": _ambient_occlusion,
}
