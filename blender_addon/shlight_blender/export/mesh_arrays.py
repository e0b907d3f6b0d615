# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays: triangles, normals, and the attributes that materials read.

Cycles splits a mesh along its sharp edges and around its flat faces, and then keeps for each vertex the normal of the
last of its corners. Corners that are still at one vertex but have other normals, as at a smooth edge of three faces,
lose theirs. In Blender 3.4 the mesh is split wherever normals differ.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import keeps_a_normal_per_vertex, mesh_triangles, smooth_corner_normals, smooth_vertex_normals, values_of
from ..names import name_of
from ..report import Effect, ExportReport
from .mesh_attributes import COLOR, mesh_attributes

Integers = NDArray[np.integer[Any]]

SAME = 1e-5  # differences of normals that are rounding errors


def as_cycles_keeps_them(mesh: Any, normals: NDArray[np.float32], corners: Integers) -> NDArray[np.float32]:
    """Normals (loops, 3) of a mesh as they are after that. corners: (n, 3), of its triangles."""
    vertex = values_of(mesh.loops, "vertex_index", np.int32)
    edge = values_of(mesh.loops, "edge_index", np.int32)
    start, count = (values_of(mesh.polygons, name, np.int32) for name in ("loop_start", "loop_total"))
    previous = np.arange(len(vertex)) - 1
    previous[start] = start + count - 1
    is_split = values_of(mesh.edges, "use_edge_sharp", bool)
    is_flat = ~values_of(mesh.polygons, "use_smooth", bool)
    is_split[edge[np.repeat(is_flat, count)]] = True
    ends = values_of(mesh.edges, "vertices", np.int32, 2)
    # Corners share the ends of edges that are not split; where no edge of a vertex is split, all share the vertex.
    corner = np.tile(np.arange(len(vertex)), 2)
    beside = np.concatenate([edge, edge[previous]])
    end = 2 * beside + (vertex[corner] == ends[beside, 1])
    is_cut = np.zeros(len(mesh.vertices), bool)
    is_cut[ends[is_split]] = True
    shares = ~is_split[beside] & is_cut[vertex[corner]]
    whole = np.flatnonzero(~is_cut[vertex])
    corner = np.concatenate([corner[shares], whole])
    place = np.concatenate([end[shares], 2 * len(ends) + vertex[whole]])
    return _last_of_each(normals, corners, corner, place, 2 * len(ends) + len(is_cut))


def _last_of_each(
    normals: NDArray[np.float32], corners: Integers, corner: Integers, place: Integers, place_count: int
) -> NDArray[np.float32]:
    """Normals of the last of all corners that are connected by places; corner number `corner[i]` is at `place[i]`."""
    any_corner = np.empty(place_count, np.int64)
    any_corner[place] = corner
    if np.abs(normals[corner] - normals[any_corner[place]]).max(initial=0.0) < SAME:
        return normals
    order = corners.ravel()
    last = np.zeros(len(normals), np.int64)
    last[order] = np.arange(len(order))
    while True:
        at_place = np.zeros(place_count, np.int64)
        np.maximum.at(at_place, place, last[corner])
        found = last.copy()
        np.maximum.at(found, corner, at_place[place])
        if np.array_equal(found, last):
            return normals[order[last]]
        last = found


# Triangles of a scene up to which doubled ones are looked for, in some 0.3 s.
MOST_TRIANGLES = 1_000_000
# Distance at which centres of triangles count as the same ÷ the scene's largest coordinate.
SAME_PLACE = 1e-6
# Odd numbers that make one of three coordinates; a chance hit among a million triangles has a probability of 3e-8.
MIXED = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


def doubled(centers: Sequence[NDArray[Any]]) -> list[bool]:
    """For each (n, 3) array of triangles' centres in the world: whether any is that of another triangle, too."""
    counts = [len(own) for own in centers]
    if sum(counts) == 0:
        return [False] * len(counts)
    places = np.concatenate(centers)
    grid = np.rint(places / max(float(np.abs(places).max()) * SAME_PLACE, np.finfo(np.float64).tiny))
    keys = (grid.astype(np.int64).astype(np.uint64) * MIXED).sum(axis=1)
    _, number, often = np.unique(keys, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return [bool((often[number[end - n : end]] > 1).any()) for n, end in zip(counts, ends, strict=True)]


FloatArray = NDArray[np.float32]


@dataclass
class MeshArrays:
    """A triangulated mesh in its own frame.

    normals: per vertex (n, 3) or per corner (k, 3, 3); None where all faces are flat.
    attributes: numbers per corner (k, 3, c) by name.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    normals: FloatArray | None
    material_indices: NDArray[np.int32]
    attributes: dict[str, FloatArray] = field(default_factory=dict)


def object_arrays(mesh_object: Any, place: str, names: Iterable[str], report: ExportReport) -> MeshArrays | None:
    """The triangles of an object; None if it has none that can be drawn."""
    mesh = mesh_object.to_mesh()
    try:
        arrays = _mesh_arrays(mesh, names)
    finally:
        mesh_object.to_mesh_clear()
    if arrays is None:
        return None
    if not np.isfinite(arrays.vertices).all():
        report.add(place, "some of its vertices are not finite; left out", Effect.THING)
        return None
    if arrays.normals is not None and not np.isfinite(arrays.normals).all():
        arrays.normals = None
    return arrays


def complete(arrays: MeshArrays, mesh_object: Any, names: Sequence[str], report: ExportReport) -> None:
    """Reports attributes that the mesh has not; a colour is then transparent black, others are 0 with an alpha of 1."""
    missing = [name for name in names if name not in arrays.attributes]
    for name in missing:
        shown = name.removeprefix("\0")
        what = f"attribute or UV map '{shown}'" if name else "UV map"
        text = f"it has no {what}, which its material reads; 0 is used, as in Cycles"
        report.add(f"Object '{name_of(mesh_object)}'", text, Effect.SLIGHT)
    black = np.zeros((len(arrays.triangles), 3, 4), dtype=np.float32)
    arrays.attributes |= {name: black for name in missing if name.startswith(COLOR)}


def flattened(arrays: MeshArrays, to_world: NDArray[np.float64]) -> MeshArrays | None:
    """The mesh as it stands at `to_world`, without smooth normals; None if a line or a point is left of it."""
    vertices = arrays.vertices @ to_world[:3, :3].T + to_world[:3, 3]
    if np.linalg.matrix_rank(vertices - vertices[0]) < 2:
        return None
    return replace(arrays, vertices=vertices.astype(np.float32), normals=None)


def _mesh_arrays(mesh: Any, attribute_names: Iterable[str]) -> MeshArrays | None:
    """Triangles of an evaluated mesh with those of the attributes that it has, None if it has no triangles."""
    triangles = mesh_triangles(mesh)
    if not len(triangles.corners):
        return None
    vertices, corner_vertices = triangles.vertices, triangles.corner_vertices
    normals = smooth_vertex_normals(mesh)
    if normals is None or not _good(normals).all():
        normals = smooth_corner_normals(mesh)
        if normals is not None:
            if keeps_a_normal_per_vertex(mesh):
                normals = as_cycles_keeps_them(mesh, normals, triangles.corners)
            normals = _repaired(normals[triangles.corners], vertices, corner_vertices)
    attributes = mesh_attributes(mesh, triangles, attribute_names)
    return MeshArrays(vertices, corner_vertices, normals, triangles.materials, attributes)


def _good(normals: FloatArray) -> NDArray[np.bool_]:
    """Which normals have a length; those of vertices without a face have none."""
    good: NDArray[np.bool_] = np.einsum("...k,...k->...", normals, normals) > 1e-12
    return good


def _repaired(normals: FloatArray, vertices: FloatArray, triangles: NDArray[np.int32]) -> FloatArray:
    """Normals of length 1; where Blender has none (degenerate faces) the face's own, else +Z."""
    good = _good(normals)[:, :, None]
    if good.all():
        return normals
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    face = np.cross(b - a, c - a)
    face_length = np.linalg.norm(face, axis=1, keepdims=True)
    face = np.where(face_length > 0.0, face / np.where(face_length > 0.0, face_length, 1.0), (0.0, 0.0, 1.0))
    repaired: FloatArray = np.where(good, normals, face[:, None, :]).astype(np.float32)
    return repaired
