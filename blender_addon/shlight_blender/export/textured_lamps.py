# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lamps whose emission has a texture, as even lamps side by side.

A lamp's own rectangle is (0, 0) … (1, 1) along its x and y, which is where Cycles looks textures up. A round lamp is
cut as a square that a map of constant area takes to its disk (Shirley & Chiu 1997).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compat import LAMPS
from .emission import Input, VaryingEmission
from .even_cells import TOLERANCE, Cells, cut_square, samples_along
from .nodes import RGB

Array = NDArray[np.float64]
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
    """A textured lamp; no parts: its mean stands for all of it."""

    mean: RGB
    parts: list[EvenPart]


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
    if LAMPS.area_has_uvs:
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
