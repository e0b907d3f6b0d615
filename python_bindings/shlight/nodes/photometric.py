# SPDX-License-Identifier: MIT
"""Light of luminaires as measured: files of IES LM-63, as a number of the direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from shlight._arrays import checked_flag
from shlight.nodes.inputs import towards_viewer
from shlight.nodes.program import Table
from shlight.nodes.values import Number, Value, Vector, clamp, minimum, normalize, number, operation, vector

Array: TypeAlias = NDArray[np.float64]

# [W] that a point lamp of Blender needs to shine with 1 cd: 4 pi sr at the 177.83 lm/W of daylight (D65).
WATTS_PER_CANDELA = 4.0 * math.pi / 177.83
MOST_ANGLES = 1 << 20
CLOSE = 1e-4  # angles [°] that count as the same
FINEST = 1e-3  # to which angles are rounded [°]


@dataclass(frozen=True)
class Luminaire:
    """Watts by angles [°]: from -z, rising, and around z from -y, rising."""

    heights: Array  # (v,)
    turns: Array  # (h,)
    watts: Array  # (h, v)


def luminaire(text: str) -> Luminaire:
    """The luminaire of a file of IES LM-63, of the types A, B and C; raises ValueError naming `text`."""
    numbers = iter(_numbers_of(text))
    try:
        _, _, candela, v, h, kind, _, _, _, _, ballast, factor, _ = (next(numbers) for _ in range(13))
        v_count, h_count = int(v), int(h)
        if kind not in (1, 2, 3) or not (0 < v_count < MOST_ANGLES and 0 < h_count < MOST_ANGLES):
            raise ValueError("text: the file is of no type that IES LM-63 has")
        read = [next(numbers) for _ in range(v_count + h_count + v_count * h_count)]
    except StopIteration:
        raise ValueError("text: the file ends before its last number") from None
    v_angles, h_angles, values = np.split(np.array(read), (v_count, v_count + h_count))
    own = Luminaire(v_angles, h_angles, candela * ballast * factor * WATTS_PER_CANDELA * values.reshape(h_count, -1))
    own = {1: _of_type_c, 2: _of_type_b, 3: _of_type_a}[int(kind)](own)
    rise = all(len(a) > 1 and (np.diff(a) > 0.0).all() for a in (own.heights, own.turns))
    if not (rise and np.isfinite(own.watts).all()):
        raise ValueError("text: the angles of the file do not rise, or a number is not finite")
    return own


def _numbers_of(text: str) -> list[float]:
    """The numbers of a file after its keywords and its table of tilts."""
    if not isinstance(text, str):
        raise ValueError(f"text must be a string, got {type(text).__name__}")
    _, found, rest = text.replace(",", " ").partition("\nTILT=")
    if not found:
        raise ValueError("text: no line of the file begins with TILT=")
    tilt, _, body = rest.partition("\n")
    try:
        numbers = [float(word) for word in body.split()]
        return numbers[2 + 2 * int(numbers[1]) :] if tilt.strip() == "INCLUDE" else numbers
    except (ValueError, IndexError, OverflowError):
        raise ValueError("text: what follows TILT= in the file are not all numbers") from None


def _is(angle: float, wanted: float) -> bool:
    return abs(angle - wanted) < CLOSE


def _from_both_sides(angles: Array, watts: Array) -> tuple[Array, Array]:
    """Angles -90 … 90, or 0 … 90 of what is alike on both sides, along the first axis, as 0 … 180."""
    if not _is(angles[0], 0.0):
        return angles + 90.0, watts
    return np.concatenate([90.0 - angles[:0:-1], 90.0 + angles]), np.concatenate([watts[:0:-1], watts])


def _of_type_b(own: Luminaire) -> Luminaire:
    """Its polar axis is horizontal; the angles are exchanged, so that the lamp has to be turned."""
    turns, watts = _from_both_sides(own.heights, own.watts.T)
    heights, watts = _from_both_sides(own.turns, watts.T)
    return Luminaire(heights, turns, watts.T)


def _of_type_a(own: Luminaire) -> Luminaire:
    turns, watts = 180.0 - own.turns[::-1], own.watts[::-1]
    if _is(own.turns[0], 0.0):
        turns, watts = np.concatenate([turns, 180.0 + own.turns[1:]]), np.concatenate([watts, own.watts[1:]])
    return Luminaire(own.heights + 90.0, turns, watts)


def _of_type_c(own: Luminaire) -> Luminaire:
    turns, watts = own.turns, own.watts
    if _is(turns[0], 90.0):
        turns = turns - 90.0
    if len(turns) == 1:
        return Luminaire(own.heights, np.array([0.0, 360.0]), np.repeat(watts, 2, axis=0))
    for quarter in (90.0, 180.0):
        if _is(turns[-1], quarter):
            turns = np.concatenate([turns, 2.0 * quarter - turns[-2::-1]])
            watts = np.concatenate([watts, watts[-2::-1]])
    gap = 360.0 - turns[-1]
    # Some files leave the last angle out, which has the values of the first.
    if _is(turns[0], 0.0) and gap > CLOSE and (_is(turns[-1] - turns[-2], gap) or _is(turns[1] - turns[0], gap)):
        turns, watts = np.append(turns, 360.0), np.concatenate([watts, watts[:1]])
    return Luminaire(own.heights, turns, watts)


def _padded(values: Array, before: int | None, behind: int | None) -> Array:
    """One more row at each end: copies of those with these numbers, or of zeros."""
    none = np.zeros_like(values[:1])
    first, last = (none if row is None else values[[row]] for row in (before, behind))
    return np.concatenate([first, values, last])


@lru_cache(maxsize=32)
def _tables(text: str, keeps_edges: bool) -> tuple[Luminaire, tuple[Table, Table], Table]:
    """The luminaire, places in its table by each angle, and the table, with what lies beyond its edges."""
    own = luminaire(text)
    # Around a full circle, too: Cycles takes none for one, since 2 pi is rounded.
    around = _padded(own.watts, *((0, -2) if keeps_edges else (None, None)))
    bottom = 1 if own.heights[0] < CLOSE else 0 if keeps_edges else None
    both = _padded(around.T, bottom, -1 if keeps_edges else None)
    return own, (_places(own.heights), _places(own.turns)), Table(both.T)


def _places(angles: Array) -> Table:
    """The place of an angle between the first and the last one, in steps of the list."""
    units = np.round((angles - angles[0]) / FINEST).astype(np.int64)
    step = max(int(np.gcd.reduce(units)), 1)
    even = np.arange(0, units[-1] + step, step)
    return Table(np.interp(even, units, np.arange(len(angles))))


def ies(text: str, direction: Vector | None = None, strength: Number = 1.0, *, keeps_edges: bool = True) -> Value:
    """Watts by which a lamp of Blender shines in a direction as a luminaire that was measured: its IES Texture.

    text: what a file of IES LM-63 holds. direction: from the lamp, in its frame, in which it looks along -z; None:
        `towards_viewer()`. Beyond the angles of the file the light is 0.
    keeps_edges: whether cubic interpolation goes on beyond the first and the last angle with their light, as since
        Blender 5.1, or with 0.
    Raises ValueError naming the argument.
    """
    own, (of_height, of_turn), watts = _tables(text, checked_flag("keeps_edges", keeps_edges))
    x, y, z = normalize(towards_viewer() if direction is None else vector(direction, "direction"))
    height = operation("arccosine", -z) * (180.0 / math.pi)
    turn = operation("arctangent2", x, y) * (180.0 / math.pi) + 180.0
    inside = number(1.0)
    places = []
    for angle, angles, table in ((turn, own.turns, of_turn), (height, own.heights, of_height)):
        low, high = float(angles[0]), float(angles[-1])
        inside = inside * (angle >= low) * (angle < high)
        place = operation("table1", (angle - low) / (high - low), data=table)
        whole = minimum(operation("floor", place), float(len(angles) - 2))
        places.append((whole, place - whole, len(angles) + 1))
    (turn_at, turn_share, last_turn), (height_at, height_share, last_height) = places

    def column(i: int) -> Value:
        u = (turn_at + float(i)) / float(last_turn)
        v = [(height_at + float(j)) / float(last_height) for j in range(4)]
        return _cubic([operation("table2", place, u, data=watts) for place in v], height_share)

    found = _cubic([column(i) for i in range(4)], turn_share)
    return number(strength, "strength") * inside * clamp(found, 0.0, math.inf)


def _cubic(values: list[Value], share: Value) -> Value:
    """Between the second and the third of four values, with the slopes to those beside them (Catmull-Rom)."""
    a, b, c, d = values
    third, second = d + 3.0 * (b - c) - a, 2.0 * a - 5.0 * b + 4.0 * c - d
    return 0.5 * ((third * share + second) * share + (c - a)) * share + b
