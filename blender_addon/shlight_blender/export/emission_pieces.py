# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles whose emission varies, cut into pieces of even light.

A triangle is quartered at the middles of its edges as often as its radiance asks for. Each piece shines with the mean
of the radiance over it; then pieces of similar means are given one radiance, their mean by area, because pieces of the
same radiance are one light to the core. Both steps keep the total light.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Radiance = Callable[[Array], Array]  # of places (n, c), linear RGB (n, 3), or (n, 6) of two sides

# Error that the pieces, and then their colours, may have: root mean square ÷ that of the radiance.
TOLERANCE = 0.05
MOST_PIECES = 256
MOST_COLORS = 12
# Quarterings into parts whose means are kept, at most, and how many more there are to the samples of each mean.
MOST_LEVELS = 7
FINER_LEVELS = 3
# Quarterings to the samples; samples, and parts whose means are kept, of all triangles together.
LEAST_SAMPLING_LEVELS = 8
MOST_SAMPLING_LEVELS = 11
MOST_SAMPLES = 1 << 20
MOST_PARTS = 1 << 18
SAMPLES_AT_ONCE = 1 << 18

# Corners of a quarter, from those of the triangle; wound as it is.
QUARTERS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)


class Pieces(NamedTuple):
    """Parts of triangles; `error` is their root mean square deviation, as a part of the radiance's own."""

    triangle: IntArray  # (n,) which triangle it is of
    corners: Array  # (n, 3, 3): row i are the barycentric coordinates of corner i
    radiance: Array  # (n, 3 or 6) linear RGB, the mean over the piece
    area: Array  # (n,)
    error: float


@lru_cache
def corners_at(level: int) -> Array:
    """Barycentric corners (4^level, 3, 3) of a triangle's parts; part i has the quarters 4 i … 4 i + 3."""
    corners = np.eye(3)[None]
    for _ in range(level):
        corners = np.einsum("qij,pjk->pqik", QUARTERS, corners).reshape(-1, 3, 3)
    return corners


@dataclass(frozen=True)
class _Pyramid:
    """Means (4^level, 3 or 6) and mean squares (4^level,) of a triangle's parts, for each level."""

    means: list[Array]
    squares: list[Array]

    def variance(self, level: int, part: int) -> float:
        return max(float(self.squares[level][part] - (self.means[level][part] ** 2).sum()), 0.0)


def sampling_levels(texels: Array) -> IntArray:
    """How often to quarter triangles (n, 3, 2), given in texels, for samples.

    They are an eighth of a texel apart or closer, unless all triangles together would have more than MOST_SAMPLES.
    """
    longest = np.linalg.norm(texels - np.roll(texels, 1, axis=1), axis=2).max(axis=1)
    levels = np.ceil(np.log2(np.maximum(8.0 * longest, 1.0)))
    levels = np.clip(levels, LEAST_SAMPLING_LEVELS, MOST_SAMPLING_LEVELS).astype(np.int64)
    while (4.0**levels).sum() > MOST_SAMPLES and levels.max() > 0:
        levels = np.minimum(levels, levels.max() - 1)
    return levels


def _pyramid(radiance: Radiance, uvs: Array, kept: int, finer: int) -> _Pyramid:
    parts = np.einsum("pij,jk->pik", corners_at(kept), uvs)
    centers = corners_at(finer).mean(axis=1)
    step = max(SAMPLES_AT_ONCE >> (2 * finer), 1)
    mean, square = [], []
    for first in range(0, len(parts), step):
        places = np.einsum("sj,pjk->psk", centers, parts[first : first + step])
        found = radiance(places.reshape(-1, places.shape[-1])).reshape(*places.shape[:2], -1)
        mean.append(found.mean(axis=1))
        square.append((found**2).sum(axis=2).mean(axis=1))
    means, squares = [np.concatenate(mean)], [np.concatenate(square)]
    for _ in range(kept):
        means.insert(0, means[0].reshape(-1, 4, means[0].shape[1]).mean(axis=1))
        squares.insert(0, squares[0].reshape(-1, 4).mean(axis=1))
    return _Pyramid(means, squares)


def cut(radiance: Radiance, uvs: Array, levels: IntArray, area: Array, most: int = MOST_PIECES) -> Pieces:
    """Cuts triangles into pieces of even light, those first whose squared deviation times area is the largest.

    uvs: (n, 3, c), what `radiance` is a function of at the corners; levels: (n,), from `sampling_levels`; area: (n,).
    At most `most` pieces, or n if that is more.
    """
    kept = np.clip(levels - FINER_LEVELS, 0, MOST_LEVELS)
    while (4.0**kept).sum() > MOST_PARTS and kept.max() > 0:
        kept = np.minimum(kept, kept.max() - 1)
    pyramids = [
        _pyramid(radiance, triangle, int(keep), int(level - keep))
        for triangle, keep, level in zip(uvs, kept, levels, strict=True)
    ]

    def entry(triangle: int, level: int, part: int) -> tuple[float, int, int, int]:
        return (-area[triangle] / 4.0**level * pyramids[triangle].variance(level, part), triangle, level, part)

    open_pieces = [entry(triangle, 0, 0) for triangle in range(len(uvs))]
    heapq.heapify(open_pieces)
    whole = sum(a * float(pyramid.squares[0][0]) for a, pyramid in zip(area, pyramids, strict=True))
    left = -sum(piece[0] for piece in open_pieces)
    done: list[tuple[float, int, int, int]] = []
    while open_pieces and left > TOLERANCE**2 * whole and len(open_pieces) + len(done) + 3 <= most:
        worst, triangle, level, part = heapq.heappop(open_pieces)
        if level == kept[triangle] or worst == 0.0:
            done.append((worst, triangle, level, part))
            continue
        left += worst
        for quarter in range(4 * part, 4 * part + 4):
            piece = entry(triangle, level + 1, quarter)
            left -= piece[0]
            heapq.heappush(open_pieces, piece)
    return _gathered(sorted(piece[1:] for piece in done + open_pieces), pyramids, area, _part(left, whole))


def _gathered(places: list[tuple[int, int, int]], pyramids: list[_Pyramid], area: Array, error: float) -> Pieces:
    tables = [corners_at(level) for level in range(1 + max(level for _, level, _ in places))]
    triangles = np.array([triangle for triangle, _, _ in places], dtype=np.int64)
    return Pieces(
        triangles,
        np.array([tables[level][part] for _, level, part in places]),
        np.array([pyramids[triangle].means[level][part] for triangle, level, part in places]),
        area[triangles] / 4.0 ** np.array([level for _, level, _ in places]),
        error,
    )


def _part(squares: float, whole: float) -> float:
    return float(np.sqrt(max(squares, 0.0) / whole)) if whole > 0.0 else 0.0


class Colors(NamedTuple):
    """Few colours for many pieces; `error` as of Pieces, but only what the colours add to it."""

    color_of: IntArray  # (n,) which colour a piece has
    radiance: Array  # (k, 3 or 6) linear RGB, the mean by area over the pieces that have it
    error: float


def share_colors(radiance: Array, area: Array, most: int = MOST_COLORS) -> Colors:
    """Gives pieces of radiance (n, 3 or 6) and area (n,) at most `most` colours besides black, which stays black.

    The group that deviates most is cut in two across its longest axis; after each cut every piece goes to the colour
    that is nearest to it (Linde, Buzo & Gray 1980).
    """
    lit = radiance.any(axis=1) & (area > 0.0)
    values, weights = radiance[lit], area[lit]
    whole = float(weights @ (values**2).sum(axis=1))
    labels: IntArray = np.zeros(len(values), dtype=np.int64)
    colors = np.zeros((0, radiance.shape[1]))
    squares: NDArray[Any] = np.zeros(0)
    for _ in range(most if len(values) else 0):
        if len(squares):
            labels = _nearest(values, weights, _divided(values, weights, labels, int(squares.argmax())))
        colors = _means(values, weights, labels)
        squares = np.bincount(labels, weights * ((values - colors[labels]) ** 2).sum(axis=1))
        if squares.sum() <= TOLERANCE**2 * whole:
            break
    color_of = np.full(len(radiance), len(colors))
    color_of[lit] = labels
    black = np.zeros((0 if lit.all() else 1, radiance.shape[1]))
    return Colors(color_of, np.concatenate([colors, black]), _part(float(squares.sum()), whole))


def _nearest(values: Array, weights: Array, labels: IntArray, rounds: int = 4) -> IntArray:
    for _ in range(rounds):
        colors = _means(values, weights, labels)
        nearest = ((values[:, None] - colors[None]) ** 2).sum(axis=2).argmin(axis=1)
        labels = np.unique(nearest, return_inverse=True)[1].reshape(-1).astype(np.int64)
    return labels


def _means(values: Array, weights: Array, labels: IntArray) -> Array:
    total = np.bincount(labels, weights)
    return np.stack([np.bincount(labels, weights * channel) / total for channel in values.T], axis=1)


def _divided(values: Array, weights: Array, labels: IntArray, which: int) -> IntArray:
    """The labels with the upper part of group `which`, along its longest axis, as a group of its own."""
    inside = labels == which
    deviation = values[inside] - np.average(values[inside], axis=0, weights=weights[inside])
    axis = np.linalg.eigh((weights[inside, None] * deviation).T @ deviation)[1][:, -1]
    divided = labels.copy()
    divided[np.flatnonzero(inside)[deviation @ axis > 0.0]] = labels.max() + 1
    return divided
