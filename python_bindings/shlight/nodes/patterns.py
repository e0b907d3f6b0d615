# SPDX-License-Identifier: MIT
"""Patterns that are formulas: bricks, and sines of sines."""

from __future__ import annotations

import math
from typing import NamedTuple

from shlight._arrays import checked_flag, checked_integer, checked_number
from shlight.nodes.inputs import texture_place
from shlight.nodes.mathematics import floor
from shlight.nodes.values import Color, Number, Value, Vector, clamp, equal, minimum, number, operation, select

TURN = 2.0 * math.pi


class Bricks(NamedTuple):
    """The result of `bricks`: 0 … 1 within a brick, the same all over it; and how much of a place is mortar."""

    tint: Value
    mortar: Value


def bricks(
    place: Vector | None = None,
    *,
    scale: Number = 5.0,
    mortar_size: Number = 0.02,
    mortar_smooth: Number = 0.1,
    bias: Number = 0.0,
    brick_width: Number = 0.5,
    row_height: Number = 0.25,
    offset: float = 0.5,
    offset_frequency: int = 2,
    squash: float = 1.0,
    squash_frequency: int = 2,
) -> Bricks:
    """A wall along x and y of a place, as Blender's Brick Texture has it.

    place: where it is looked up; None: `position()`. The sizes are those of bricks at scale 1.
    mortar_smooth: share of the mortar that fades, 0 … 1. bias: added to tints, which are clamped to 0 … 1.
    offset: of rows whose number is a multiple of offset_frequency, relative to a brick's width.
    squash: factor on the width of bricks in rows whose number is a multiple of squash_frequency; both 1 … 99.
    Raises ValueError naming the argument.
    """
    x, y, _ = texture_place(place) * number(scale, "scale")
    width, height = number(brick_width, "brick_width"), number(row_height, "row_height")
    size, smooth = number(mortar_size, "mortar_size"), number(mortar_smooth, "mortar_smooth")
    row = floor(y / height)
    width = width * _every(squash_frequency, "squash_frequency", row, checked_number("squash", squash), 1.0)
    x = x + width * _every(offset_frequency, "offset_frequency", row, checked_number("offset", offset), 0.0)
    brick = floor(x / width)
    tint = clamp(operation("brick_noise", row, brick) + number(bias, "bias"))
    along, up = x - width * brick, y - height * row
    distance = minimum(minimum(along, up), minimum(width - along, height - up))
    t = clamp((1.0 - distance / size) / smooth)
    faded = select(equal(smooth, 0.0), 1.0, t * t * (3.0 - 2.0 * t))
    return Bricks(tint, select(distance < size, faded, 0.0))


def _every(frequency: int, name: str, row: Value, then: float, otherwise: float) -> Value:
    """One number in rows whose number is a multiple of a frequency, and another one in the other rows."""
    every = checked_integer(name, frequency, 1, 99)
    return select(operation("modulo", row, float(every)), otherwise, then)


# The steps of the magic texture: which number becomes sign times the sine or cosine of x, y and z with these signs.
_STEPS = (
    ("y", -1.0, "cosine", (1.0, -1.0, 1.0)),
    ("x", 1.0, "cosine", (1.0, -1.0, -1.0)),
    ("z", 1.0, "sine", (-1.0, -1.0, -1.0)),
    ("x", -1.0, "cosine", (-1.0, 1.0, -1.0)),
    ("y", -1.0, "sine", (-1.0, 1.0, 1.0)),
    ("y", -1.0, "cosine", (-1.0, 1.0, 1.0)),
    ("x", 1.0, "cosine", (1.0, 1.0, 1.0)),
    ("z", 1.0, "sine", (1.0, 1.0, -1.0)),
    ("x", -1.0, "cosine", (-1.0, -1.0, 1.0)),
    ("y", -1.0, "sine", (1.0, -1.0, 1.0)),
)


def _signed(of: dict[str, Value], signs: tuple[float, float, float]) -> Value:
    x, y, z = (value * sign for value, sign in zip(of.values(), signs, strict=True))
    return x + y + z


def magic(
    place: Vector | None = None,
    *,
    scale: Number = 5.0,
    distortion: Number = 1.0,
    depth: int = 2,
    wraps_scaled: bool = True,
) -> Color:
    """Sines of sums of sines, one for each colour, as Blender's Magic Texture has them.

    place: where it is looked up; None: `position()`.
    distortion: factor on each sine before it is an argument of the next.
    depth: number of steps, 0 … 10.
    wraps_scaled: whether coordinates are brought into one turn after they were scaled, as since Blender 5.2, or before.
    Raises ValueError naming the argument.
    """
    steps = checked_integer("depth", depth, 0, len(_STEPS))
    where = texture_place(place)
    size, factor = number(scale, "scale"), number(distortion, "distortion")
    before, after = (size, number(1.0)) if checked_flag("wraps_scaled", wraps_scaled) else (number(1.0), size)
    wrapped = {name: operation("modulo", c * before, TURN) for name, c in zip("xyz", where, strict=True)}
    found = {
        "x": operation("sine", _signed(wrapped, (1.0, 1.0, 1.0)) * 5.0 * after),
        "y": operation("cosine", _signed(wrapped, (-1.0, 1.0, -1.0)) * 5.0 * after),
        "z": -operation("cosine", _signed(wrapped, (-1.0, -1.0, 1.0)) * 5.0 * after),
    }
    if steps > 0:
        found = {name: c * factor for name, c in found.items()}
    for name, sign, function, signs in _STEPS[:steps]:
        found[name] = operation(function, _signed(found, signs)) * sign * factor
    twice = factor * 2.0
    return Color(*(0.5 - select(equal(factor, 0.0), c, c / twice) for c in found.values()))
