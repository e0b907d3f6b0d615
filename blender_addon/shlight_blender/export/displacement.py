# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement of surfaces, as Cycles does it: the normals that it bends, and the vertices that it moves.

Each vertex is moved by what the nodes make of the first corner of a displaced triangle that it is. Where a material
only displaces, normals of smooth faces are made of those of the moved faces around a vertex, all of which count alike.
Where it bends normals too, they stay, and a bump of what the displacement is along the normal bends them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Shader, Vector
from shlight.nodes.inputs import normal_to_object, normal_to_world, point_to_world, vector_to_world
from shlight.nodes.normals import near, raised
from shlight.nodes.rays import Ray, beside, on_ray, unfiltered, with_vectors
from shlight.nodes.values import Value, cross, dot, length, normalize

from ..compat import (
    BENDS_OLD_NORMAL,
    BENDS_VERTEX_NORMAL,
    COMPARES_AT_MEAN_STEPS,
    DISPLACED_KEEP_CORNERS,
    DISPLACEMENT_FILTER_WIDTH,
    displacement_method,
)
from .corner_values import at_corners
from .emission import VaryingColor
from .mesh_arrays import MeshArrays, Undisplaced
from .mesh_attributes import TANGENT, UNDISPLACED, UNDISPLACED_NORMAL
from .nodes import NodeInputs, ReadNode, TreeReader, origin
from .triangle_geometry import face_normals, unit

Array = NDArray[np.float64]
Corners = NDArray[np.int64]  # (n,), numbered through all triangles
LARGEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True)
class Displacement:
    """How a material moves the vertices of a mesh: `offset` in the world.

    keeps_normals: those of smooth faces stay as they were; else they follow the faces.
    """

    offset: VaryingColor
    keeps_normals: bool


def _height(inputs: NodeInputs) -> Value:
    return (inputs.number("Height") - inputs.number("Midlevel")) * inputs.number("Scale")


def _along(inputs: NodeInputs) -> Vector:
    """The offset that a Displacement node makes of a height of 1."""
    n = inputs.vector_or("Normal", nodes.normal())
    return vector_to_world(normalize(normal_to_object(n))) if inputs.node.space == "OBJECT" else n


def _vector_displacement(inputs: NodeInputs) -> Vector:
    space = inputs.node.space
    moved = (inputs.vector("Vector") - inputs.number("Midlevel")) * inputs.number("Scale")
    if space == "TANGENT":
        tangent, n = nodes.attribute(TANGENT), normalize(normal_to_object(nodes.normal()))
        along = Vector(*tangent)
        across = normalize(cross(n, along)) * tangent.alpha
        moved = along * moved.x + n * moved.y + across * moved.z
    return moved if space == "WORLD" else vector_to_world(moved)


DISPLACEMENT_NODES: dict[str, ReadNode] = {
    "DISPLACEMENT": lambda inputs: _along(inputs) * _height(inputs),
    "VECTOR_DISPLACEMENT": _vector_displacement,
}


def displaced(shader: Shader, material: Any, socket: Any, reader: TreeReader) -> tuple[Shader, Displacement | None]:
    """The shader of a material with the normals that its displacement bends, and how it moves vertices.

    socket: Displacement of the output of the material.
    """
    if origin(socket).node is None:
        return shader, None
    method = displacement_method(material)
    moves, bends = method != "BUMP", method != "DISPLACEMENT"
    offset = nodes.values.vector(reader.expression(socket))
    if bends:
        shader = _bent(shader, socket, offset, reader, as_undisplaced=moves)
    return shader, Displacement(VaryingColor(Vector(*on_ray(offset, Ray.LIGHT))), bends) if moves else None


def _bent(shader: Shader, socket: Any, offset: Vector, reader: TreeReader, *, as_undisplaced: bool) -> Shader:
    """The shader with a bump of the part of an offset that is along the normal.

    as_undisplaced: the slope is that of the surface before it is displaced, in the frame of the object.
    """
    source = origin(socket)
    inputs = NodeInputs(reader, source.node, source.output, source.groups)
    height, scale = dot(offset, nodes.normal()), nodes.values.number(1.0)
    if source.node.type == "DISPLACEMENT" and not inputs.is_linked("Normal"):
        # Cycles compares heights along one normal, which this factor is of; the one beside it may lean otherwise.
        height, scale = _height(inputs), dot(_along(inputs), nodes.normal())
    if height.constant is not None:
        return shader
    inputs.remark_bumps()
    width = DISPLACEMENT_FILTER_WIDTH
    if not as_undisplaced:
        rises = _rises(unfiltered(height), {}, width)
        return shader.with_normal(raised(rises, scale, nodes.normal(), nodes.position(), width))
    place = Vector(*nodes.attribute(UNDISPLACED))
    n = normalize(normal_to_object(nodes.normal()))
    if BENDS_OLD_NORMAL:
        n = normalize(Vector(*nodes.attribute(UNDISPLACED_NORMAL))) * (1.0 - 2.0 * nodes.backfacing())
    known = {"position": point_to_world(place), "normal": normalize(normal_to_world(n))}
    rises = _rises(unfiltered(height), known, width)
    (scale,) = with_vectors((scale,), known)
    return shader.with_normal(normalize(normal_to_world(raised(rises, scale, n, place, width))))


def _rises(height: Value, known: dict[str, Vector], width: float) -> tuple[Value, Value]:
    """Returns how much higher a surface is beside the hit, in the picture's x and y, as Cycles has it.

    known: the position and the normal before displacement, if others count. Cycles goes from that place along the
    displaced face.
    """
    (here,) = with_vectors((height,), known)
    vectors = dict.fromkeys(("near_x", "near_y"), known)
    if known:
        before, after = ([near(at, side, width) for side in vectors] for at in (known["position"], nodes.position()))
        ratio = _lengths(before) / _lengths(after) if COMPARES_AT_MEAN_STEPS else 1.0
        for side, along in zip(vectors, after, strict=True):
            vectors[side] = known | {"position": known["position"] + along * ratio}
    x, y = (beside(height, side, width, own) - here for side, own in vectors.items())
    return x, y


def _lengths(vectors: Sequence[Vector]) -> Value:
    return length(vectors[0]) + length(vectors[1])


def displace(
    arrays: MeshArrays, displacements: Sequence[Displacement | None], to_world: Array, object_values: Sequence[float]
) -> MeshArrays:
    """A mesh whose vertices are moved by the displacements of its materials, None for one that moves nothing.

    to_world, object_values: of the instance where the displacement is looked up.
    """
    if BENDS_OLD_NORMAL:
        arrays = replace(arrays, attributes=arrays.attributes | {UNDISPLACED_NORMAL: _bent_normals(arrays)})
    slots = np.clip(arrays.material_indices, 0, len(displacements) - 1)
    moves = np.array([own is not None for own in displacements])[slots]
    corners = np.flatnonzero(np.repeat(moves, 3))
    if not len(corners):
        return arrays
    moved, first = np.unique(arrays.triangles.ravel()[corners], return_index=True)
    corner = corners[first]  # of all corners, the one that moves a vertex
    offset = np.zeros((len(moved), 3))
    for slot, own in enumerate(displacements):
        here = slots[corner // 3] == slot
        if own is not None and here.any():
            offset[here] = _offsets(arrays, own, corner[here], to_world, object_values)
    offset = offset @ np.linalg.pinv(to_world[:3, :3]).T
    vertices = arrays.vertices.copy()
    vertices[moved] += np.where(np.abs(offset) <= LARGEST, offset, 0.0).astype(np.float32)
    follows = np.array([own is not None and not own.keeps_normals for own in displacements])[slots]
    return replace(arrays, vertices=vertices, normals=_normals_after(arrays, vertices, follows))


def _undisplaced(arrays: MeshArrays) -> Undisplaced:
    assert arrays.before is not None
    return arrays.before


def _bent_normals(arrays: MeshArrays) -> NDArray[np.float32]:
    """The normals per corner that a bump of the displacement bends."""
    normals, smooth = _undisplaced(arrays)
    if BENDS_VERTEX_NORMAL:
        return normals[arrays.triangles]
    faces = face_normals(arrays.vertices, arrays.triangles)[:, None]
    return np.where(smooth[:, None, None], normals[arrays.triangles], faces).astype(np.float32)


def _offsets(
    arrays: MeshArrays, displacement: Displacement, corner: Corners, to_world: Array, object_values: Sequence[float]
) -> Array:
    """Offsets in the world (n, 3) at corners."""
    triangles, inverse = np.unique(corner // 3, return_inverse=True)
    place = (inverse.reshape(-1), corner % 3)
    part = arrays.chosen(triangles, arrays.material_indices)
    normals = _world_normals(arrays, corner, to_world)
    known = {}
    for entry in displacement.offset.inputs:
        if entry[0] in ("normal", "towards_viewer"):  # a vertex is seen along its normal
            known[entry] = normals[:, entry[2]]
        else:
            known[entry] = at_corners(part, to_world, object_values, entry)[place]
    return displacement.offset.values(known, len(corner))


def _world_normals(arrays: MeshArrays, corner: Corners, to_world: Array) -> Array:
    """Unit normals (n, 3) in the world of the vertices at corners; those of the triangles where a vertex has none."""
    to_object = np.linalg.pinv(to_world[:3, :3])
    own = _undisplaced(arrays).normals[arrays.triangles.ravel()[corner]].astype(np.float64) @ to_object
    faces = face_normals(arrays.vertices, arrays.triangles[corner // 3]) @ to_object
    return unit(own, unit(faces, (0.0, 0.0, 1.0)))


def _normals_after(before: MeshArrays, vertices: NDArray[np.float32], follows: NDArray[np.bool_]) -> Any:
    """Normals of a mesh with moved vertices; follows: (k,), whether those of a triangle follow the faces."""
    if before.normals is None:
        return None
    triangles, faces = before.triangles, face_normals(vertices, before.triangles)
    if before.normals.ndim == 2:
        is_new = np.zeros(len(vertices), bool)
        is_new[triangles[follows]] = True
        around = _around_vertices(faces[follows], triangles[follows], len(vertices))
        return np.where(is_new[:, None], unit(around, before.normals), before.normals).astype(np.float32)
    if DISPLACED_KEEP_CORNERS:
        states = (face_normals(before.vertices, triangles), faces)
        old, new = (unit(_around_vertices(own, triangles, len(vertices)), 0.0) for own in states)
        normals = before.normals + (new - old)[triangles]
    else:
        around = _around_vertices(faces[follows], triangles[follows], len(vertices))
        normals = np.where(around.any(axis=1)[triangles][..., None], around[triangles], before.normals)
    flat = np.broadcast_to(faces[:, None], normals.shape)
    return unit(np.where(_undisplaced(before).smooth[:, None, None], normals, flat), flat).astype(np.float32)


def _around_vertices(faces: Array, triangles: NDArray[np.int32], count: int) -> Array:
    """The sums (count, 3) of the normals of all triangles at each vertex."""
    ends, weight = triangles.ravel(), np.repeat(faces, 3, axis=0)
    return np.stack([np.bincount(ends, weight[:, i], count) for i in range(3)], axis=1)
