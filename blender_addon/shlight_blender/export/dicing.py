# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive subdivision: meshes whose edges are about as long as the camera's pixels, for displacement to move.

The edges of all triangles that are too long are halved, and each triangle is cut between its corners and the middles of
its edges, until none is too long. What is known of corners and vertices is linear between them; the middle of an edge
of a curved surface is that of the cubic between its ends that is normal to their normals there, as in Vlachos et al.,
"Curved PN Triangles" (2001), which comes near the limit of a subdivision whose first levels are the mesh.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compat import Dicing
from .camera import View
from .mesh_arrays import MeshArrays, Undisplaced
from .mesh_attributes import UNDISPLACED
from .triangle_geometry import face_normals, unit

Array = NDArray[np.float64]
Index = NDArray[np.int64]

# Triangles of a mesh up to which edges are divided, in some seconds.
MOST_TRIANGLES = 500_000
# Length from which an edge is halved ÷ that which is wanted: halves are as much too short as others are too long.
LONGEST = 2.0**0.5
# Sine of the angle between an edge and a face, by the normal of its end, from which the edge is straight: the normal is
# the mean of those around a crease.
SHARP = 0.5
TINY = float(np.finfo(np.float64).tiny)

# Corners of a triangle's parts by the sum of 1, 2 and 4 for its edges that are halved; corner 3 + i is the middle of
# edge i, which starts at corner i.
PARTS = [
    np.array(parts)
    for parts in (
        [(0, 1, 2)],
        [(0, 3, 2), (3, 1, 2)],
        [(1, 4, 0), (4, 2, 0)],
        [(3, 1, 4), (0, 3, 4), (0, 4, 2)],
        [(2, 5, 1), (5, 0, 1)],
        [(5, 0, 3), (2, 5, 3), (2, 3, 1)],
        [(4, 2, 5), (1, 4, 5), (1, 5, 0)],
        [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    )
]


class _Edges(NamedTuple):
    ends: Index  # (n, 2) their vertices
    of_triangle: Index  # (k, 3): edge i starts at corner i


def diced(arrays: MeshArrays, dicing: Dicing, to_world: Array, view: View | None) -> tuple[MeshArrays, str]:
    """A mesh with more triangles, and what the report says of it.

    to_world: of the instance for which it is divided. view: the camera whose pixels lengths are in; None: in the mesh's
    own frame.
    """
    is_full = False
    for level in range(dicing.levels + 1):
        edges = _edges_of(arrays)
        length = _lengths(arrays.vertices[edges.ends].astype(np.float64), to_world, view, dicing) / dicing.length
        halved = np.flatnonzero(length > LONGEST)
        if is_full or level == dicing.levels or not len(halved):
            break
        room = max(MOST_TRIANGLES - len(arrays.triangles), 0) // 2  # an edge is one of two triangles
        is_full = len(halved) > room
        if is_full:
            halved = halved[np.argsort(-length[halved])[:room]]
        arrays = _divided(arrays, edges, halved, dicing.curved)
    if UNDISPLACED in arrays.attributes:
        arrays.attributes[UNDISPLACED] = arrays.vertices[arrays.triangles]
    text = f"adaptive subdivision ends at {MOST_TRIANGLES} triangles; edges are up to {length.max():.2g} times as long"
    return _with_normals(arrays), text if is_full else ""


def _with_normals(arrays: MeshArrays) -> MeshArrays:
    """The mesh with normals of its smooth faces that are those of vertices."""
    assert arrays.before is not None
    (normals, smooth), triangles = arrays.before, arrays.triangles
    faces = face_normals(arrays.vertices, triangles).astype(np.float32)
    own = normals if smooth.all() else np.where(smooth[:, None, None], normals[triangles], faces[:, None])
    return replace(arrays, normals=None if arrays.normals is None else own)


def _edges_of(arrays: MeshArrays) -> _Edges:
    start, count = arrays.triangles.astype(np.int64), len(arrays.vertices)
    end = np.roll(start, -1, axis=1)
    keys, of_triangle = np.unique(np.minimum(start, end) * count + np.maximum(start, end), return_inverse=True)
    return _Edges(np.stack([keys // count, keys % count], axis=1), of_triangle.reshape(start.shape))


def _lengths(ends: Array, to_world: Array, view: View | None, dicing: Dicing) -> Array:
    """The lengths of edges (n, 2, 3), in pixels of the view that are as far from the camera as their middles."""
    if view is None:
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    to_camera = np.array(view.to_camera)
    for matrix in (to_world, to_camera):
        ends = ends @ matrix[:3, :3].T + matrix[:3, 3]
    middles = ends.mean(axis=1)
    coarser = (dicing.offscreen - 1.0) * _distance_from_picture(middles, view)
    distance = 1.0 if view.orthographic else np.linalg.norm(middles, axis=1)
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / np.maximum(view.pixel * (distance + coarser), TINY)


def _distance_from_picture(points: Array, view: View) -> Array:
    """How far points in the camera's frame are from what it sees: in metres, or in half-diagonals of the picture."""
    if view.panoramic:
        return np.zeros(len(points))
    slope, offset = np.array(view.slope), np.array(view.offset)
    if view.orthographic:
        beside = np.maximum(np.abs(points[:, :2] * slope + offset) - 1.0, 0.0) / slope
        return np.linalg.norm(beside, axis=1) / np.sqrt(0.5 * (slope**-2.0).sum())
    # The planes through the camera and the picture's sides: x * slope + z * (offset ± 1) = 0.
    planes = [np.stack([sign * slope, sign * offset - 1.0], axis=1) for sign in (1.0, -1.0)]
    beyond = [points[:, [axis, 2]] @ plane[axis] / np.linalg.norm(plane[axis]) for plane in planes for axis in range(2)]
    return np.maximum(np.max(beyond, axis=0), 0.0)


def _on_curves(vertices: Array, normals: Array) -> tuple[Array, Array]:
    """How far the middles of edges (n, 3) are from the middles of their ends (n, 2, 3), and the normals there."""
    along, both = vertices[:, 1] - vertices[:, 0], normals.sum(axis=1)
    square = np.maximum((along * along).sum(axis=1, keepdims=True), TINY)
    lean = np.einsum("nk,nik->ni", along, normals)
    lean = np.where(np.abs(lean) <= SHARP * np.sqrt(square), lean, 0.0)
    offset = 0.125 * (lean[:, 1:] * normals[:, 1] - lean[:, :1] * normals[:, 0])
    return offset, unit(both - 2.0 * (lean.sum(axis=1, keepdims=True) / square) * along, both)


def _divided(arrays: MeshArrays, edges: _Edges, halved: Index, curved: bool) -> MeshArrays:
    """The mesh with a vertex in the middle of some of its edges, whose own normals stay those from before."""
    count, ends = len(arrays.vertices), edges.ends[halved]
    middle = np.full(len(edges.ends), -1, dtype=np.int32)
    middle[halved] = np.arange(count, count + len(halved))
    corners = np.concatenate([arrays.triangles, middle[edges.of_triangle]], axis=1)
    kind = (corners[:, 3:] >= 0) @ np.array([1, 2, 4])
    alike = [np.flatnonzero(kind == i) for i in range(len(PARTS))]
    triangle = np.concatenate([np.repeat(which, len(parts)) for which, parts in zip(alike, PARTS, strict=True)])
    corner = np.concatenate([np.tile(parts, (len(which), 1)) for which, parts in zip(alike, PARTS, strict=True)])
    order = np.argsort(triangle, kind="stable")  # parts stand in the place of their triangle
    triangle, corner = triangle[order], corner[order]
    place = (triangle[:, None], corner)

    def of_parts(values: NDArray[np.float32]) -> NDArray[np.float32]:
        middles = 0.5 * (values + np.roll(values, -1, axis=1))
        return np.concatenate([values, middles], axis=1)[place]

    def of_vertices(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.concatenate([values, 0.5 * (values[ends[:, 0]] + values[ends[:, 1]])])

    assert arrays.before is not None
    vertices, normals = of_vertices(arrays.vertices), of_vertices(arrays.before.normals)
    if curved:
        ends_of = (values[ends].astype(np.float64) for values in (arrays.vertices, arrays.before.normals))
        offset, normals[count:] = _on_curves(*ends_of)
        vertices[count:] += offset.astype(np.float32)
    attributes = {name: of_parts(values) for name, values in arrays.attributes.items()}
    before = Undisplaced(normals, arrays.before.smooth[triangle])
    return MeshArrays(vertices, corners[place], arrays.normals, arrays.material_indices[triangle], attributes, before)
