# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose emission has a texture, as meshes of pieces that each shine evenly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .emission import TURNED, Input, VaryingEmission, of_both_sides
from .emission_pieces import MOST_PIECES, TOLERANCE, Colors, Pieces, cut, sampling_levels, share_colors
from .materials import Surface
from .mesh_arrays import MeshArrays
from .mesh_attributes import attribute_component

FloatArray = NDArray[np.float32]
Array = NDArray[np.float64]
Remark = Callable[[str], None]


def with_even_emission(
    arrays: MeshArrays, surfaces: list[Surface], to_world: Array, object_values: Sequence[float], remark: Remark
) -> tuple[MeshArrays, list[Surface]]:
    """The mesh with all varying emission in pieces of even light, and a surface for each colour of them.

    to_world, object_values: of the instance where emission that depends on the place or the object is looked up.
    """
    if arrays.normals is not None and arrays.normals.ndim == 2:
        arrays = replace(arrays, normals=arrays.normals[arrays.triangles])
    slots = np.clip(arrays.material_indices, 0, len(surfaces) - 1)
    varying = [slot for slot in np.unique(slots) if surfaces[slot].varying is not None]
    made, parts = list(surfaces), [_chosen(arrays, ~np.isin(slots, varying), slots)]
    for slot in varying:
        part = _chosen(arrays, slots == slot, slots)
        pieces = _cut_surface(part, surfaces[slot].varying, to_world, object_values, MOST_PIECES // len(varying))
        colors = share_colors(pieces.radiance, pieces.area)
        _report_error(pieces, colors, remark)
        parts.append(_of_pieces(part, pieces, len(made) + colors.color_of))
        made += [replace(surfaces[slot], emission=of_both_sides(color), varying=None) for color in colors.radiance]
    return _joined(parts), made


def _report_error(pieces: Pieces, colors: Colors, remark: Remark) -> None:
    error = float(np.hypot(pieces.error, colors.error))
    if error > 1.5 * TOLERANCE:
        remark(
            f"the texture of its emission is drawn in {len(pieces.area)} pieces of even light, of"
            f" {len(colors.radiance)} colours, which differ from it by {100 * error:.0f} % (root mean square);"
            " the total is kept"
        )


def _cut_surface(
    part: MeshArrays, emission: VaryingEmission | None, to_world: Array, object_values: Sequence[float], most: int
) -> Pieces:
    assert emission is not None
    corners = part.vertices[part.triangles].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    inputs = list(dict.fromkeys(emission.inputs))
    known = np.stack([_at_corners(part, corners, to_world, object_values, entry) for entry in inputs], axis=2)
    count = 3 * len(corners)
    at_corners = {entry: known[:, :, i].reshape(-1) for i, entry in enumerate(inputs)}
    texels = [places.reshape(-1, 3, 2) for places in emission.texels(at_corners, count)]
    levels = np.max([sampling_levels(places) for places in texels or [np.zeros((len(corners), 3, 2))]], axis=0)

    def radiance(places: Array) -> Array:
        return emission.of_sides({entry: places[:, i] for i, entry in enumerate(inputs)}, len(places))

    return cut(radiance, known, levels, area, most)


def _at_corners(
    part: MeshArrays, corners: Array, to_world: Array, object_values: Sequence[float], entry: Input
) -> Array:
    """A number that a program reads, at the corners (k, 3); it is linear between them, or taken to be."""
    source, index, component = entry
    places = corners @ to_world[:3, :3].T + to_world[:3, 3]
    if source == "position":
        return places[..., component]
    if source == "attribute":
        values = part.attributes.get(str(index))
        if values is None:
            return np.zeros(corners.shape[:2])
        return np.broadcast_to(attribute_component(values, component).astype(np.float64), corners.shape[:2])
    if source in ("object_to_world", "world_to_object"):
        matrix = to_world if source == "object_to_world" else np.linalg.pinv(to_world)
        return np.full(corners.shape[:2], matrix[component // 4, component % 4])
    if source == "barycentric":
        return np.broadcast_to(np.eye(3)[1 + component], corners.shape[:2])
    if source == "object_value" and int(index) < len(object_values):
        return np.full(corners.shape[:2], object_values[int(index)])
    face = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    face *= np.sign(np.linalg.det(to_world[:3, :3])) / np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
    if source in TURNED:
        return np.repeat(face[:, None, component], 3, axis=1)
    return np.zeros(corners.shape[:2])


def _chosen(arrays: MeshArrays, which: NDArray[np.bool_], slots: NDArray[Any]) -> MeshArrays:
    normals = None if arrays.normals is None else arrays.normals[which]
    attributes = {name: values[which] for name, values in arrays.attributes.items()}
    return MeshArrays(arrays.vertices, arrays.triangles[which], normals, slots[which].astype(np.int32), attributes)


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
    attributes = {
        name: (pieces.corners @ values[pieces.triangle].astype(np.float64)).astype(np.float32)
        for name, values in part.attributes.items()
    }
    return MeshArrays(vertices, index.reshape(-1, 3).astype(np.int32), normals, slots.astype(np.int32), attributes)


def _joined(parts: list[MeshArrays]) -> MeshArrays:
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    triangles = [part.triangles + np.int32(start) for part, start in zip(parts, starts, strict=False)]
    normals = [part.normals for part in parts if part.normals is not None]
    return MeshArrays(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate(triangles),
        np.concatenate(normals) if normals else None,
        np.concatenate([part.material_indices for part in parts]),
        {name: np.concatenate([part.attributes[name] for part in parts]) for name in parts[0].attributes},
    )
