# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Geometry node says of the shape of a mesh, per vertex and as Cycles finds it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import values_of
from .random_numbers import hashed, share

Array = NDArray[np.float64]
Index = NDArray[np.int64]


def _edges(mesh: Any) -> Index:
    return values_of(mesh.edges, "vertices", np.int32, 2).astype(np.int64)


def _vectors(collection: Any, name: str) -> Array:
    return values_of(collection, name, np.float32, 3).astype(np.float64)


def _unit(v: Array) -> Array:
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return np.divide(v, length, out=np.zeros_like(v), where=length > 0.0)


def pointiness(mesh: Any) -> Array:
    """Per vertex how far its edges lean towards its normal: 0.5 where it is flat, more on crests, less in grooves.

    Vertices in the same place count as one; each takes the mean of itself and its neighbours.
    """
    places, one_of = np.unique(_vectors(mesh.vertices, "co"), axis=0, return_inverse=True)
    one_of = one_of.reshape(-1)
    count = len(places)
    normals = np.zeros((count, 3))
    np.add.at(normals, one_of, _vectors(mesh.vertices, "normal"))
    edges = np.unique(np.sort(one_of[_edges(mesh)], axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    both = np.concatenate([edges, edges[:, ::-1]])
    degree = np.bincount(both[:, 0], minlength=count)
    leaning = np.zeros((count, 3))
    np.add.at(leaning, both[:, 0], _unit(places[both[:, 1]] - places[both[:, 0]]))
    leaning /= np.maximum(degree, 1)[:, None]
    cosine = np.clip((_unit(normals) * leaning).sum(axis=1), -1.0, 1.0)
    raw = np.where(degree > 0, np.arccos(cosine) / np.pi, 0.0)
    smooth = (raw + np.bincount(both[:, 0], weights=raw[both[:, 1]], minlength=count)) / (degree + 1)
    found: Array = smooth[one_of]
    return found


def random_per_island(mesh: Any) -> Array:
    """Per vertex a random number that all vertices joined by edges share.

    It is that of the vertex on which a union of sets by rank, edge by edge, settles.
    """
    parent = list(range(len(mesh.vertices)))
    rank = [0] * len(parent)

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b in _edges(mesh).tolist():
        first, second = root(a), root(b)
        if first == second:
            continue
        if rank[first] < rank[second]:
            first, second = second, first
        parent[second] = first
        rank[first] += rank[first] == rank[second]
    roots = [root(i) for i in range(len(parent))]
    numbers = {i: share(hashed(i)) for i in set(roots)}
    return np.array([numbers[i] for i in roots])
