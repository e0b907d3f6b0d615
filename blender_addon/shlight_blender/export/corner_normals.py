# SPDX-License-Identifier: GPL-3.0-or-later
"""The normals that Cycles keeps where Blender has several at a vertex.

Cycles splits a mesh along its sharp edges and around its flat faces, and then keeps for each vertex the normal of the
last of its corners. Corners that are still at one vertex but have other normals, as at a smooth edge of three faces,
lose theirs. In Blender 3.4 the mesh is split wherever normals differ.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import values_of

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
