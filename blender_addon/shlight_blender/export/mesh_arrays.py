# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays: triangles, normals, and the attributes that materials read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import keeps_a_normal_per_vertex, mesh_triangles, smooth_corner_normals, smooth_vertex_normals
from ..names import name_of
from ..report import Effect, ExportReport
from .corner_normals import as_cycles_keeps_them
from .mesh_attributes import COLOR, mesh_attributes

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
