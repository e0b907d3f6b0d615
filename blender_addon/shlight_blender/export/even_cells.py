# SPDX-License-Identifier: GPL-3.0-or-later
"""A square whose emission varies, cut into few rectangles that each shine with the mean of the radiance over them."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bounds = tuple[int, int, int, int]  # left, bottom, right and top, in samples

# Error that the cells may have: root mean square ÷ that of the radiance.
TOLERANCE = 0.075
# Samples along a side of the square, at least and at most, and to a texel.
LEAST_SAMPLES = 512
MOST_SAMPLES = 1024
SAMPLES_TO_A_TEXEL = 8
SAMPLES_AT_ONCE = 1 << 18
# A cut that takes less than this part of a cell's deviation away tells nothing; the longer side is halved instead.
LEAST_GAIN = 0.02


class Cells(NamedTuple):
    """Rectangles side by side; `error` is their root mean square deviation, as a part of the radiance's own."""

    bounds: Array  # (n, 4): left, bottom, right and top, 0 … 1
    radiance: Array  # (n, 3) linear RGB, the mean over the cell
    error: float


def samples_along(texels: Array) -> tuple[int, int]:
    """Samples along both sides of the square, from its corners (4, 2) in texels, counter-clockwise from the lower left.

    Each texel has as many, so that the mean over them is right where a picture has edges, too.
    """
    wide, high = (_samples(float(np.linalg.norm(texels[corner] - texels[0]))) for corner in (1, 3))
    return wide, high


def _samples(texels: float) -> int:
    if not texels < MOST_SAMPLES:
        return MOST_SAMPLES
    count = max(math.ceil(texels - 1e-6), 1)
    to_each = max(SAMPLES_TO_A_TEXEL, math.ceil(LEAST_SAMPLES / count))
    return count * min(to_each, MOST_SAMPLES // count)


class _Sums:
    """Sums of the radiance and of its square over rectangles of samples, from a summed-area table (Crow 1984)."""

    def __init__(self, radiance: Callable[[Array], Array], wide: int, high: int) -> None:
        self.shape = wide, high
        self._table = np.zeros((high + 1, wide + 1, 4))
        u = (np.arange(wide) + 0.5) / wide
        rows = max(SAMPLES_AT_ONCE // wide, 1)
        for first in range(0, high, rows):
            v = (np.arange(first, min(first + rows, high)) + 0.5) / high
            places = np.stack(np.meshgrid(u, v), axis=-1)
            found = radiance(places.reshape(-1, 2)).reshape(*places.shape[:2], 3)
            part = self._table[first + 1 : first + 1 + len(v), 1:]
            part[..., :3] = found
            part[..., 3] = (found**2).sum(axis=2)
        np.cumsum(self._table, axis=0, out=self._table)
        np.cumsum(self._table, axis=1, out=self._table)

    def over(self, bounds: Bounds) -> Array:
        left, bottom, right, top = bounds
        table = self._table
        return table[top, right] - table[bottom, right] - table[top, left] + table[bottom, left]

    def before_columns(self, bounds: Bounds) -> Array:
        """Sums over the part of a rectangle left of each column between its own (right - left - 1, 4)."""
        left, bottom, right, top = bounds
        strip = self._table[top, left:right] - self._table[bottom, left:right]
        return strip[1:] - strip[0]

    def before_rows(self, bounds: Bounds) -> Array:
        """Sums over the part of a rectangle below each row between its own (top - bottom - 1, 4)."""
        left, bottom, right, top = bounds
        strip = self._table[bottom:top, right] - self._table[bottom:top, left]
        return strip[1:] - strip[0]


def _deviation(sums: Array, count: NDArray[np.int64] | int) -> Array:
    """Squared deviation from the mean, summed over `count` samples with sums (..., 4)."""
    return np.maximum(sums[..., 3] - (sums[..., :3] ** 2).sum(axis=-1) / count, 0.0)


def _count(bounds: Bounds) -> int:
    return (bounds[2] - bounds[0]) * (bounds[3] - bounds[1])


def _cut_in_two(sums: _Sums, bounds: Bounds) -> tuple[Bounds, Bounds]:
    """The cut along a column or a row that leaves the least deviation."""
    left, bottom, right, top = bounds
    whole = sums.over(bounds)
    best, upright, at = float(_deviation(whole, _count(bounds))) * (1.0 - LEAST_GAIN), right - left >= top - bottom, 0
    for is_upright, first in ((True, sums.before_columns(bounds)), (False, sums.before_rows(bounds))):
        if not len(first):
            continue
        count = np.arange(1, len(first) + 1) * (top - bottom if is_upright else right - left)
        left_over = _deviation(first, count) + _deviation(whole - first, _count(bounds) - count)
        if left_over.min() < best:
            best, upright, at = float(left_over.min()), is_upright, 1 + int(left_over.argmin())
    if upright:
        column = left + (at or (right - left) // 2)
        return (left, bottom, column, top), (column, bottom, right, top)
    row = bottom + (at or (top - bottom) // 2)
    return (left, bottom, right, row), (left, row, right, top)


def cut_square(radiance: Callable[[Array], Array], samples: tuple[int, int], most: int) -> Cells:
    """Cuts the unit square, always the cell in two whose squared deviation times area is the largest.

    radiance: linear RGB (n, 3) of places (n, 2). At most `most` cells.
    """
    sums = _Sums(radiance, *samples)
    everything = (0, 0, *samples)
    whole = float(sums.over(everything)[3])
    left_over = float(_deviation(sums.over(everything), _count(everything)))
    cells: list[tuple[float, Bounds]] = [(-left_over, everything)]
    while left_over > TOLERANCE**2 * whole and len(cells) < most and _count(cells[0][1]) > 1:
        worst, bounds = heapq.heappop(cells)
        left_over += worst
        for half in _cut_in_two(sums, bounds):
            deviation = float(_deviation(sums.over(half), _count(half)))
            left_over += deviation
            heapq.heappush(cells, (-deviation, half))
    found = sorted(bounds for _, bounds in cells)
    means = np.array([np.maximum(sums.over(bounds)[:3], 0.0) / _count(bounds) for bounds in found])
    error = float(np.sqrt(max(left_over, 0.0) / whole)) if whole > 0.0 else 0.0
    return Cells(np.array(found) / (*samples, *samples), means, error)
