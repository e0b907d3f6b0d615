# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose emission has a texture, as meshes of pieces that each shine evenly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .emission_pieces import MOST_PIECES, TOLERANCE, Colors, Pieces, cut, sampling_levels, share_colors
from .surface import Surface

FloatArray = NDArray[np.float32]
Array = NDArray[np.float64]
Remark = Callable[[str], None]


@dataclass
class MeshArrays:
    """A triangulated mesh in its own frame; normals (k, 3, 3) per corner, None where all faces are flat."""

    vertices: FloatArray
    triangles: NDArray[np.int32]
    normals: FloatArray | None
    material_indices: NDArray[np.int32]


def corner_uvs(mesh: Any, name: str) -> Array | None:
    """Of a mesh whose triangles are calculated, the UV map `name` ("": the one for rendering) per corner (k, 3, 2)."""
    layer = mesh.uv_layers.get(name) if name else next((map_ for map_ in mesh.uv_layers if map_.active_render), None)
    if layer is None:
        return None
    uvs = np.empty(len(mesh.loops) * 2, dtype=np.float32)
    layer.data.foreach_get("uv", uvs)
    loops = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    corners = np.nan_to_num(uvs.reshape(-1, 2)[loops].astype(np.float64), posinf=0.0, neginf=0.0)
    return corners.reshape(-1, 3, 2)


def with_even_emission(
    arrays: MeshArrays, surfaces: list[Surface], uvs: Mapping[str, Array], remark: Remark
) -> tuple[MeshArrays, list[Surface]]:
    """The mesh with all textured emission in pieces of even light, and a surface for each colour of them.

    uvs: each UV map that `surfaces` name, (k, 3, 2).
    """
    slots = np.clip(arrays.material_indices, 0, len(surfaces) - 1)
    textured = [slot for slot in np.unique(slots) if surfaces[slot].textured]
    made, parts = list(surfaces), [_chosen(arrays, ~np.isin(slots, textured), slots)]
    for slot in textured:
        chosen = slots == slot
        part = _chosen(arrays, chosen, slots)
        chosen_uvs = {name: of_all[chosen] for name, of_all in uvs.items()}
        pieces = _cut_surface(part, surfaces[slot], chosen_uvs, MOST_PIECES // len(textured))
        colors = share_colors(pieces.radiance, pieces.area)
        _report_error(pieces, colors, remark)
        parts.append(_of_pieces(part, pieces, len(made) + colors.color_of))
        made += [replace(surfaces[slot], emission=color, textured=()) for color in colors.radiance]
    return _joined(parts), made


def _report_error(pieces: Pieces, colors: Colors, remark: Remark) -> None:
    error = float(np.hypot(pieces.error, colors.error))
    if error > 1.5 * TOLERANCE:
        remark(
            f"the texture of its emission is drawn in {len(pieces.area)} pieces of even light, of"
            f" {len(colors.radiance)} colours, which differ from it by {100 * error:.0f} % (root mean square);"
            " the total is kept"
        )


def _cut_surface(part: MeshArrays, surface: Surface, uvs: Mapping[str, Array], most: int) -> Pieces:
    corners = part.vertices[part.triangles].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    textures = [texture for glow in surface.textured for texture in glow.textures]
    levels = np.max([sampling_levels(texture.texels(uvs[texture.uv_map])) for texture in textures], axis=0)
    names = list(uvs)
    joined = np.concatenate([uvs[name] for name in names], axis=2)

    def radiance(places: Array) -> Array:
        return surface.radiance({name: places[:, 2 * i : 2 * i + 2] for i, name in enumerate(names)})

    return cut(radiance, joined, levels, area, most)


def _chosen(arrays: MeshArrays, which: NDArray[np.bool_], slots: NDArray[Any]) -> MeshArrays:
    normals = None if arrays.normals is None else arrays.normals[which]
    return MeshArrays(arrays.vertices, arrays.triangles[which], normals, slots[which].astype(np.int32))


def _of_pieces(part: MeshArrays, pieces: Pieces, slots: NDArray[Any]) -> MeshArrays:
    """The pieces as triangles; corners at the same place are one vertex, so that neighbours share an edge."""
    places = pieces.corners @ part.vertices[part.triangles[pieces.triangle]].astype(np.float64)
    vertices, index = np.unique(places.astype(np.float32).reshape(-1, 3), axis=0, return_inverse=True)
    normals = None
    if part.normals is not None:
        normals = pieces.corners @ part.normals[pieces.triangle].astype(np.float64)
        length = np.linalg.norm(normals, axis=2, keepdims=True)
        normals = np.where(length > 1e-6, normals / np.maximum(length, 1e-6), part.normals[pieces.triangle])
        normals = normals.astype(np.float32)
    return MeshArrays(vertices, index.reshape(-1, 3).astype(np.int32), normals, slots.astype(np.int32))


def _joined(parts: list[MeshArrays]) -> MeshArrays:
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    triangles = [part.triangles + np.int32(start) for part, start in zip(parts, starts, strict=False)]
    normals = [part.normals for part in parts if part.normals is not None]
    return MeshArrays(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate(triangles),
        np.concatenate(normals) if normals else None,
        np.concatenate([part.material_indices for part in parts]),
    )
