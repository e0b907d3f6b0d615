# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that say where a hit or a vector lies in the frames of the object, of another object and of the camera."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Vector
from shlight.nodes.inputs import normal_to_object, normal_to_world, point_to_object, point_to_world, vector_to_object
from shlight.nodes.mathematics import reflect
from shlight.nodes.values import cross, dot, length, normalize

from ..names import name_of
from .camera import View
from .expressions import Expression, NodeInputs, ReadNode
from .mesh_attributes import GENERATED, TANGENT

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


def _texture_coordinate(inputs: NodeInputs) -> Expression:
    name, view = inputs.output.identifier, inputs.reader.surroundings.view
    if inputs.node.from_instancer and name in ("Generated", "UV"):
        inputs.remark("'From Instancer' is not supported; the object's own coordinates are used")
    if name == "UV":
        return nodes.uv("")
    if name == "Generated":
        return nodes.attribute(GENERATED)
    if name == "Normal":
        return normalize(normal_to_object(nodes.normal()))
    if name == "Object":
        other = inputs.node.object
        if other is None:
            return point_to_object(nodes.position())
        return _rows(np.linalg.pinv(np.array(other.matrix_world, dtype=np.float64))[:3], nodes.position())
    if name == "Reflection":
        return reflect(-nodes.towards_viewer(), nodes.normal())
    if view is None or (name == "Window" and view.panoramic):
        inputs.remark(f"'{name}' coordinates are not supported here; (0, 0, 0) is used")
        return Vector(0.0, 0.0, 0.0)
    return _in_camera(view) if name == "Camera" else _in_window(view)


def _camera_data(inputs: NodeInputs) -> Expression:
    view = inputs.reader.surroundings.view
    if view is None:
        inputs.remark("the camera is not known here; 0 is used")
        return nodes.values.number(0.0)
    place = _in_camera(view)
    outputs: dict[str, Expression] = {
        "View Vector": normalize(place),
        "View Z Depth": place.z,
        "View Distance": length(place),
    }
    return outputs[inputs.output.identifier]


Move = Callable[[Vector], Vector]


def _moves(kind: str, view: View | None) -> tuple[dict[str, Move], dict[str, Move]]:
    """How a vector gets from each frame to the world, and from the world to each."""
    to_camera = np.eye(3, 4) if view is None else np.array(view.to_camera)
    to_world = np.linalg.inv(np.vstack([to_camera, (0.0, 0.0, 0.0, 1.0)]))[:3]
    if kind == "NORMAL":
        return (
            {"OBJECT": lambda v: normalize(normal_to_world(v)), "CAMERA": _unit(to_camera[:, :3].T)},
            {"OBJECT": lambda v: normalize(normal_to_object(v)), "CAMERA": _unit(to_world[:, :3].T)},
        )
    if kind == "VECTOR":
        return (
            {"OBJECT": nodes.inputs.vector_to_world, "CAMERA": lambda v: _rows(to_world[:, :3], v)},
            {"OBJECT": vector_to_object, "CAMERA": lambda v: _rows(to_camera[:, :3], v)},
        )
    return (
        {"OBJECT": point_to_world, "CAMERA": lambda v: _rows(to_world, v)},
        {"OBJECT": point_to_object, "CAMERA": lambda v: _rows(to_camera, v)},
    )


def _unit(matrix: Array) -> Move:
    return lambda v: normalize(_rows(matrix, v))


def _vector_transform(inputs: NodeInputs) -> Vector:
    node, view, found = inputs.node, inputs.reader.surroundings.view, inputs.vector("Vector")
    if node.convert_from == node.convert_to:
        return found
    if view is None and "CAMERA" in (node.convert_from, node.convert_to):
        inputs.remark("the camera is not known here; the world's frame is used in its place")
    to_world, from_world = _moves(node.vector_type, view)
    if node.convert_from != "WORLD":
        found = to_world[node.convert_from](found)
    return found if node.convert_to == "WORLD" else from_world[node.convert_to](found)


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


FRAME_NODES: dict[str, ReadNode] = {
    "TEX_COORD": _texture_coordinate,
    "CAMERA": _camera_data,
    "VECT_TRANSFORM": _vector_transform,
    "TANGENT": _tangent,
}
