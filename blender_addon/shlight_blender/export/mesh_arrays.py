# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays: triangles, normals, and the attributes that materials read.

Cycles splits a mesh along its sharp edges and around its flat faces, and then keeps for each vertex the normal of the
last of its corners. Corners that are still at one vertex but have other normals, as at a smooth edge of three faces,
lose theirs. In Blender 3.4 the mesh is split wherever normals differ.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compat import (
    Triangles,
    keeps_a_normal_per_vertex,
    mesh_triangles,
    smooth_corner_normals,
    smooth_vertex_normals,
    splits_vertices,
    values_of,
)
from ..names import name_of
from ..report import Effect, ExportReport
from .mesh_attributes import COLOR, OF_CURVES, mesh_attributes
from .triangle_geometry import face_normals

Integers = NDArray[np.integer[Any]]
FloatArray = NDArray[np.float32]

SAME = 1e-5  # differences of normals that are rounding errors
FARTHEST = 1e9  # [m] coordinates of meshes; the core refuses ten times as much


class Joined(NamedTuple):
    """Corners of a mesh that are one in a mesh that is split: those at one of `places`.

    Loop `loop[i]` is at `place[i]`, and may be at several.
    """

    loop: Integers
    place: Integers
    places: int


def _joined_by_edges(mesh: Any) -> Joined:
    """The corners that stay joined where a mesh is split along its sharp edges and around its flat faces."""
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
    return Joined(corner, place, 2 * len(ends) + len(is_cut))


def _joined_by_normals(mesh: Any, normals: FloatArray) -> Joined:
    """The corners that stay joined where a mesh is split wherever their normals (loops, 3) differ."""
    vertex = values_of(mesh.loops, "vertex_index", np.int32)
    keys = np.concatenate([vertex[:, None], np.ascontiguousarray(normals).view(np.int32)], axis=1)
    _, place = np.unique(keys, axis=0, return_inverse=True)
    return Joined(np.arange(len(vertex)), place.reshape(-1), len(vertex))


def as_cycles_keeps_them(joined: Joined, normals: FloatArray, corners: Integers) -> FloatArray:
    """Normals (loops, 3): of joined corners all have that of the last. corners: (n, 3), of the mesh's triangles."""
    any_loop = np.empty(joined.places, np.int64)
    any_loop[joined.place] = joined.loop
    if np.abs(normals[joined.loop] - normals[any_loop[joined.place]]).max(initial=0.0) < SAME:
        return normals
    return normals[corners.ravel()[_last_of_each(joined, len(normals), corners)]]


def _last_of_each(joined: Joined, loops: int, corners: Integers) -> NDArray[np.int64]:
    """For each loop the last corner of a triangle, numbered through all, that it is joined with over any places."""
    order = corners.ravel()
    last = np.zeros(loops, np.int64)
    last[order] = np.arange(len(order))
    while True:
        at_place = np.zeros(joined.places, np.int64)
        np.maximum.at(at_place, joined.place, last[joined.loop])
        found = last.copy()
        np.maximum.at(found, joined.loop, at_place[joined.place])
        if np.array_equal(found, last):
            return last
        last = found


class Undisplaced(NamedTuple):
    """The normals of vertices (n, 3), whether their faces are smooth or flat, and which triangles are smooth (k,)."""

    normals: FloatArray
    smooth: NDArray[np.bool_]


@dataclass
class MeshArrays:
    """A triangulated mesh in its own frame.

    normals: per vertex (n, 3) or per corner (k, 3, 3); None where all faces are flat.
    attributes: numbers per corner (k, 3, c) by name.
    before: what displacement starts from, where it is asked for.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    normals: FloatArray | None
    material_indices: NDArray[np.int32]
    attributes: dict[str, FloatArray] = field(default_factory=dict)
    before: Undisplaced | None = None

    @property
    def corner_normals(self) -> FloatArray | None:
        """The normals per corner; None where all faces are flat."""
        normals = self.normals
        return normals[self.triangles] if normals is not None and normals.ndim == 2 else normals

    def within_reach(self) -> MeshArrays | None:
        """The triangles whose coordinates are at most `FARTHEST`: this mesh if all are, None if there are none."""
        known = (np.abs(self.vertices) <= FARTHEST).all(1)
        if known.all():
            return self
        kept = known[self.triangles].all(1)
        if not kept.any():
            return None
        arrays = self.chosen(kept, self.material_indices)
        before = None if self.before is None else self.before._replace(smooth=self.before.smooth[kept])
        return replace(arrays, vertices=np.where(known[:, None], self.vertices, np.float32(0)), before=before)

    def chosen(self, which: NDArray[Any], slots: NDArray[Any]) -> MeshArrays:
        """Some of the triangles, by number or by whether each is one, with the materials `slots` (k,) of all."""
        normals = None if self.corner_normals is None else self.corner_normals[which]
        attributes = {name: values[which] for name, values in self.attributes.items()}
        return MeshArrays(self.vertices, self.triangles[which], normals, slots[which].astype(np.int32), attributes)


def object_arrays(
    mesh_object: Any,
    place: str,
    names: Iterable[str],
    report: ExportReport,
    *,
    displaced: bool = False,
    whole: bool = False,
) -> MeshArrays | None:
    """The triangles of an object; None if it has none that can be drawn.

    displaced: it has what displacement starts from, and the vertices that Cycles' mesh has once it is split; whole: it
    is not split, as what Cycles subdivides.
    """
    mesh = mesh_object.to_mesh()
    try:
        arrays = _mesh_arrays(mesh, names, displaced, whole)
    finally:
        mesh_object.to_mesh_clear()
    if arrays is None:
        return None
    near = arrays.within_reach()
    if near is not arrays:
        text = "some of its vertices are not finite, or farther than 1e9 m away; their faces are left out"
        report.add(place, text, Effect.THING)
    if near is not None and near.normals is not None and not np.isfinite(near.normals).all():
        near.normals = None
    return near


def complete(
    attributes: dict[str, FloatArray], corners: tuple[int, ...], shown: Any, names: Sequence[str], report: ExportReport
) -> None:
    """Reports attributes that an object has not; a colour is then transparent black, others are 0 with an alpha of 1.

    corners: the shape of numbers of its corners, or of its points.
    """
    missing = [name for name in names if name not in attributes and name not in OF_CURVES]
    for name in missing:
        title = name.removeprefix("\0")
        what = f"attribute or UV map '{title}'" if name else "UV map"
        text = f"it has no {what}, which its material reads; 0 is used, as in Cycles"
        report.add(f"Object '{name_of(shown)}'", text, Effect.SLIGHT)
    black = np.zeros((*corners, 4), dtype=np.float32)
    attributes |= {name: black for name in missing if name.startswith(COLOR)}


def flattened(arrays: MeshArrays, to_world: NDArray[np.float64]) -> MeshArrays | None:
    """The mesh as it stands at `to_world`, without smooth normals; None if a line or a point is left of it."""
    vertices = arrays.vertices @ to_world[:3, :3].T + to_world[:3, 3]
    if np.linalg.matrix_rank(vertices - vertices[0]) < 2:
        return None
    return replace(arrays, vertices=vertices.astype(np.float32), normals=None)


def _mesh_arrays(mesh: Any, attribute_names: Iterable[str], displaced: bool, whole: bool) -> MeshArrays | None:
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
                normals = as_cycles_keeps_them(_joined_by_edges(mesh), normals, triangles.corners)
            normals = _repaired(normals[triangles.corners], vertices, corner_vertices)
    attributes = mesh_attributes(mesh, triangles, normals, attribute_names)
    arrays = MeshArrays(vertices, corner_vertices, normals, triangles.materials, attributes)
    if displaced:
        arrays = _split(arrays, mesh, triangles, "" if whole else splits_vertices(mesh))
    return arrays


def _split(arrays: MeshArrays, mesh: Any, triangles: Triangles, kind: str) -> MeshArrays:
    """A mesh with a vertex for all corners that are one in Cycles' mesh; kind: as of splits_vertices."""
    smooth = values_of(mesh.polygons, "use_smooth", bool)[triangles.polygons]
    normals, own = smooth_corner_normals(mesh), arrays.corner_normals
    if not kind or normals is None or own is None:
        return replace(arrays, before=Undisplaced(values_of(mesh.vertex_normals, "vector", np.float32, 3), smooth))
    joined = _joined_by_edges(mesh) if kind == "edges" else _joined_by_normals(mesh, normals)
    last = _last_of_each(joined, len(normals), triangles.corners)[triangles.corners]
    corner, vertex = np.unique(last, return_inverse=True)
    return replace(
        arrays,
        vertices=arrays.vertices[arrays.triangles.ravel()[corner]],
        triangles=vertex.reshape(last.shape).astype(np.int32),
        normals=own,
        before=Undisplaced(own.reshape(-1, 3)[corner], smooth),
    )


def _good(normals: FloatArray) -> NDArray[np.bool_]:
    """Which normals have a length; those of vertices without a face have none."""
    good: NDArray[np.bool_] = np.einsum("...k,...k->...", normals, normals) > 1e-12
    return good


def _repaired(normals: FloatArray, vertices: FloatArray, triangles: NDArray[np.int32]) -> FloatArray:
    """Normals of length 1; where Blender has none (degenerate faces) the face's own, else +Z."""
    good = _good(normals)[:, :, None]
    if good.all():
        return normals
    faces = face_normals(vertices, triangles, (0.0, 0.0, 1.0))
    repaired: FloatArray = np.where(good, normals, faces[:, None, :]).astype(np.float32)
    return repaired
