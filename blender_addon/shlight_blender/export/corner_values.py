# SPDX-License-Identifier: GPL-3.0-or-later
"""What programs read at the corners of a mesh's triangles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .emission import TURNED, Input
from .mesh_arrays import MeshArrays
from .mesh_attributes import attribute_component

Array = NDArray[np.float64]


def at_corners(
    part: MeshArrays, to_world: Array, object_values: Sequence[float], entry: Input, view: Array | None = None
) -> Array:
    """A number that a program reads, at the corners (k, 3); it is linear between them, or taken to be.

    view: unit, towards the viewer, where each normal is z and each first edge x; without one, along the normal.
    """
    source, index, component = entry
    corners = part.vertices[part.triangles].astype(np.float64)
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
    if source == "height":
        edge = places[:, (component + 2) % 3] - places[:, (component + 1) % 3]
        up = np.cross(edge, places[:, component] - places[:, (component + 1) % 3])
        heights = np.linalg.norm(up, axis=1) / np.maximum(np.linalg.norm(edge, axis=1), 1e-30)
        return np.repeat(heights[:, None], 3, axis=1)
    if source == "object_value" and int(index) < len(object_values):
        return np.full(corners.shape[:2], object_values[int(index)])
    face = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    face *= np.sign(np.linalg.det(to_world[:3, :3])) / np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
    if source == "towards_viewer" and view is not None:
        along = places[:, 1] - places[:, 0]
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
        face = view[0] * along + view[1] * np.cross(face, along) + view[2] * face
    if source in TURNED:
        return np.repeat(face[:, None, component], 3, axis=1)
    return np.zeros(corners.shape[:2])
