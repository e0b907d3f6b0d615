# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lamps whose emission has a texture, as even lamps side by side.

A lamp's own rectangle is (0, 0) … (1, 1) along its x and y, which is where Cycles looks textures up. It is cut into few
rectangles that each shine with the mean of the radiance over them. A round lamp is cut as a square that a map of
constant area takes to its disk (Shirley & Chiu 1997).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compat import Lamps
from .emission import Input, VaryingEmission, divided, share_of
from .nodes import RGB

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

    def part(bounds: Bounds) -> tuple[float, Bounds]:
        return float(_deviation(sums.over(bounds), _count(bounds))), bounds

    def halves(bounds: Bounds) -> list[tuple[float, Bounds]]:
        return [part(half) for half in _cut_in_two(sums, bounds)] if _count(bounds) > 1 else []

    found, left = divided([part(everything)], halves, TOLERANCE**2 * whole, most)
    means = np.array([np.maximum(sums.over(bounds)[:3], 0.0) / _count(bounds) for bounds in found])
    return Cells(np.array(found) / (*samples, *samples), means, share_of(left, whole))


Remark = Callable[[str], None]

# Each part is a lamp of its own to the core, and takes a lamp's time.
MOST_PARTS = 64
UNIT_SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
# Vertices of a whole round lamp's outline, a quarter of them on each side of the square.
ROUND_SIDES = 64


class EvenPart(NamedTuple):
    """A part of an area lamp that shines evenly."""

    corners: Array  # (k, 2), (0, 0) … (1, 1) along the lamp's x and y; counter-clockwise
    emission: RGB  # what the lamp's radiance is multiplied with


class EvenLamp(NamedTuple):
    """A textured lamp; no parts: its mean stands for all of it.

    profile: factors of its light by direction, as of `shlight.Scene.add_point_light`; None: the same in all.
    """

    mean: RGB
    parts: list[EvenPart]
    profile: Array | None = None


def even_lamp(emission: VaryingEmission, is_round: bool, remark: Remark) -> EvenLamp:
    """A lamp that shines as `emission`; `remark` is told what is not as in Cycles."""
    lacking = sorted({_name_of(entry) for entry in emission.inputs if entry[2] < 2} - {""})
    if lacking:
        remark(f"a lamp has no {', '.join(lacking)}; one colour of its texture is used")
    cells = _cut_lamp(emission, is_round)
    left, bottom, right, top = cells.bounds.T
    mean = ((right - left) * (top - bottom)) @ cells.radiance
    if len(cells.radiance) == 1:
        return EvenLamp(mean, [])
    part_of = _round_part if is_round else _straight_part
    both = zip(cells.bounds, cells.radiance, strict=True)
    lit = [part_of(emission, cell) for cell, emission in both if emission.any()]
    _report_error(cells.error, len(lit), remark)
    return EvenLamp(mean, lit)


def _report_error(error: float, count: int, remark: Remark) -> None:
    if error > TOLERANCE:
        remark(
            f"its texture is drawn as {count} lamps of even light side by side, which differ from it by"
            f" {100 * error:.0f} % (root mean square); the total is kept"
        )


def _cut_lamp(emission: VaryingEmission, is_round: bool) -> Cells:
    """The square in cells; of a round lamp, the square that becomes its disk."""

    def radiance(places: Array) -> Array:
        return emission.radiance(_inputs_at(disk_places(places) if is_round else places), len(places))

    textures = emission.texels(_inputs_at(UNIT_SQUARE), len(UNIT_SQUARE)) or [UNIT_SQUARE]
    wide, high = np.max([samples_along(texels) for texels in textures], axis=0)
    return cut_square(radiance, (int(wide), int(high)), MOST_PARTS)


def _name_of(entry: Input) -> str:
    """The name of an input that a lamp does not have, "" if it has it."""
    if entry in _inputs_at(UNIT_SQUARE):
        return ""
    source, index, _ = entry
    if source != "attribute" or str(index).endswith(":"):
        return f"coordinates of the kind '{str(index).rstrip(':') or source}'" if index else f"'{source}'"
    return f"UV map '{index}'" if index else "UV map in this version of Blender"


def _inputs_at(places: Array) -> dict[Input, Array]:
    """A program's inputs at places (n, 2) of the lamp: its UV map, if it has one here, and Parametric."""
    x, y = places.T
    # The lamp counts as a triangle whose corners 0 and 1 lie along its x and y.
    inputs: dict[Input, Array] = {("barycentric", 0, 0): y, ("barycentric", 0, 1): 1.0 - x - y}
    if Lamps.area_has_uvs:
        inputs |= {("attribute", "", i): places[:, i] for i in range(2)}
    return inputs


def disk_places(places: Array) -> Array:
    """Maps places (n, 2) of the unit square to the disk that touches its sides; areas keep their ratios."""
    a, b = 2.0 * places.T - 1.0
    # In the quarters on the right and the left the radius is a, in the others b.
    sideways = np.abs(a) > np.abs(b)
    radius = np.where(sideways, a, b)
    ratio = np.divide(np.where(sideways, b, a), radius, out=np.zeros_like(radius), where=radius != 0.0)
    angle = np.where(sideways, 0.25 * math.pi * ratio, 0.5 * math.pi - 0.25 * math.pi * ratio)
    return 0.5 + 0.5 * radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _straight_part(emission: RGB, cell: Array) -> EvenPart:
    left, bottom, right, top = cell
    return EvenPart(np.array([(left, bottom), (right, bottom), (right, top), (left, top)]), emission)


def _round_part(emission: RGB, cell: Array) -> EvenPart:
    """A cell of the square in the disk, as a polygon that gives the light of its curved outline."""
    corners = _straight_part(emission, cell).corners
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    curved = disk_places(np.concatenate([_between(a, b) for a, b in sides]))
    x, y = curved.T
    area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    left, bottom, right, top = cell
    return EvenPart(curved, emission * (0.25 * math.pi * (right - left) * (top - bottom) / area))


def _between(start: Array, end: Array) -> Array:
    """Places on one side of a cell, from its start on but without its end; those on the diagonals are among them."""
    along = 0 if start[0] != end[0] else 1
    low, high = sorted((float(start[along]), float(end[along])))
    across = float(start[1 - along])
    inner = np.array([*(4.0 / ROUND_SIDES * np.arange(ROUND_SIDES // 4 + 1)), across, 1.0 - across])
    stops = np.unique([low, high, *inner[(inner > low) & (inner < high)]])
    places = np.full((len(stops), 2), across)
    places[:, along] = stops
    return (places if start[along] < end[along] else places[::-1])[:-1]
