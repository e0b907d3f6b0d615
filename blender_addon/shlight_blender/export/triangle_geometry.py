# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals and tangents of triangles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float32]


def unit(v: NDArray[np.float64], otherwise: Any) -> NDArray[np.float64]:
    """Vectors of length 1, and others where their length is 0."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    found: NDArray[np.float64] = np.where(length > 0.0, v / np.where(length > 0.0, length, 1.0), otherwise)
    return found


def face_normals(
    vertices: FloatArray, triangles: NDArray[np.int32], otherwise: Sequence[float] = (1.0, 0.0, 0.0)
) -> NDArray[np.float64]:
    """Unit normals of triangles (k, 3); of those without area what is given, by default what Cycles takes."""
    a, b, c = (vertices[triangles[:, i]].astype(np.float64) for i in range(3))
    return unit(np.cross(b - a, c - a), otherwise)


def triangle_tangents(
    vertices: FloatArray,
    triangles: NDArray[np.int32],
    normals: FloatArray | None,
    uvs: FloatArray,
    *,
    u_turns: bool = False,
) -> FloatArray:
    """The direction in which u grows, and the sign of the bitangent, at corners of triangles (k, 3, 4).

    normals: of corners (k, 3, 3) or vertices (n, 3); None if the triangles are flat. uvs: (k, 3, 2). Corners that agree
    in place, normal, UV and sign share the mean of what their triangles say, weighed by the angle at the corner, in the
    plane of the normal (Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008). Where none says anything, it is
    the x axis, as in Blender. u_turns: u counts turns, and a triangle's edges take the shorter way round from its
    first corner.
    """
    if normals is None:
        normals = np.repeat(face_normals(vertices, triangles)[:, None], 3, axis=1)
    elif normals.ndim == 2:
        normals = normals[triangles]
    p, n, uv = (values.astype(np.float64) for values in (vertices[triangles], normals, uvs))
    (a, b), (s, t) = ((own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]) for own in (p, uv))
    if u_turns:
        for edge in (s, t):
            edge[:, 0] -= np.floor(edge[:, 0] + 0.5)
    area = s[:, 0] * t[:, 1] - s[:, 1] * t[:, 0]
    sign = np.where(area > 0.0, 1.0, -1.0)
    along = np.where(area != 0.0, sign, 0.0)[:, None] * (t[:, 1:] * a - s[:, 1:] * b)
    to_next, to_previous, own = (
        unit(v - n * (v * n).sum(axis=-1, keepdims=True), 0.0)
        for v in (np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p, along[:, None] + np.zeros_like(p))
    )
    weighed = np.arccos(np.clip((to_next * to_previous).sum(axis=-1), -1.0, 1.0))[..., None] * own
    signs = np.repeat(sign, 3)
    told_by = np.concatenate([np.concatenate([p, n, uv], axis=-1).reshape(-1, 8), signs[:, None]], axis=1)
    group = _equal_rows(told_by)
    mean = np.stack([np.bincount(group, each) for each in weighed.reshape(-1, 3).T], axis=1).astype(np.float64)
    found = np.concatenate([unit(mean, (1.0, 0.0, 0.0))[group], signs[:, None]], axis=1)
    return found.reshape(-1, 3, 4).astype(np.float32)


def _equal_rows(rows: NDArray[np.float64]) -> NDArray[np.intp]:
    """A number for each row, which equal ones have in common. Bytes are sorted three times as fast as numbers."""
    single = rows.astype(np.float32) + np.float32(0.0)  # of -0 and 0 the same bytes
    whole = single.view(np.dtype((np.void, single.itemsize * single.shape[1])))
    group: NDArray[np.intp] = np.unique(whole, return_inverse=True)[1].reshape(-1)
    return group
