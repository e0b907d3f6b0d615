# SPDX-License-Identifier: MIT
"""Functions of colours, as Blender's colour nodes have them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import add, mul, sub

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight.nodes.footprint_variance import mean_of, unresolved_variance
from shlight.nodes.mathematics import floor, fraction, power
from shlight.nodes.program import Table
from shlight.nodes.rays import unfiltered
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    equal,
    in_order,
    maximum,
    minimum,
    number,
    operation,
    select,
)


def _map(function: Callable[..., Value], *colors: Vector) -> Color:
    return Color(*(function(*components) for components in zip(*colors, strict=True)))


def _lerp(a: Vector, b: Vector, t: Value) -> Color:
    return _map(lambda x, y: (1.0 - t) * x + t * y, a, b)


def hsv_from_rgb(c: Vector) -> Vector:
    """Hue, saturation and value, each 0 … 1 for colours in 0 … 1."""
    r, g, b = c
    high, low = maximum(r, maximum(g, b)), minimum(r, minimum(g, b))
    span = high - low
    saturation = select(equal(high, 0.0), 0.0, span / high)
    x, y, z = ((high - component) / span for component in (r, g, b))
    hue = select(
        equal(r, high),
        z - y,
        select(equal(g, high), 2.0 + x - z, 4.0 + y - x),
    )
    hue = hue / 6.0
    hue = select(hue < 0.0, hue + 1.0, hue)
    return Vector(select(equal(saturation, 0.0), 0.0, hue), saturation, high)


def rgb_from_hsv(c: Vector) -> Color:
    """The colour of a hue, saturation and value."""
    hue, s, v = c
    h = select(equal(hue, 1.0), 0.0, hue) * 6.0
    sector = floor(h)
    f = h - sector
    p, q, t = v * (1.0 - s), v * (1.0 - s * f), v * (1.0 - s * (1.0 - f))

    def chosen(*by_sector: Value) -> Value:
        result = by_sector[-1]
        for i, value in reversed(list(enumerate(by_sector[:-1]))):
            result = select(equal(sector, float(i)), value, result)
        return select(equal(s, 0.0), v, result)

    return Color(chosen(v, q, p, p, t, v), chosen(t, v, v, q, p, p), chosen(p, p, t, v, v, q))


def hsl_from_rgb(c: Vector) -> Vector:
    """Hue, saturation and lightness."""
    r, g, b = (clamp(component) for component in c)
    high, low = maximum(r, maximum(g, b)), minimum(r, minimum(g, b))
    span, light = high - low, minimum(1.0, (high + low) / 2.0)
    grey = equal(high, low)
    saturation = select(light > 0.5, span / (2.0 - high - low), span / (high + low))
    hue = select(
        equal(high, r),
        (g - b) / span + select(g < b, 6.0, 0.0),
        select(equal(high, g), (b - r) / span + 2.0, (r - g) / span + 4.0),
    )
    return Vector(select(grey, 0.0, hue / 6.0), select(grey, 0.0, saturation), light)


def rgb_from_hsl(c: Vector) -> Color:
    """The colour of a hue, saturation and lightness."""
    hue, s, light = c
    chroma = (1.0 - abs(2.0 * light - 1.0)) * s
    r = clamp(abs(hue * 6.0 - 3.0) - 1.0)
    g = clamp(2.0 - abs(hue * 6.0 - 2.0))
    b = clamp(2.0 - abs(hue * 6.0 - 4.0))
    return Color(*((component - 0.5) * chroma + light for component in (r, g, b)))


def _overlay(a: Value, b: Value, t: Value) -> Value:
    rest = 1.0 - t
    return select(a < 0.5, a * (rest + 2.0 * t * b), 1.0 - (rest + 2.0 * t * (1.0 - b)) * (1.0 - a))


def _dodge(a: Value, b: Value, t: Value) -> Value:
    below = 1.0 - t * b
    return select(equal(a, 0.0), a, select(below > 0.0, minimum(a / below, 1.0), 1.0))


def _burn(a: Value, b: Value, t: Value) -> Value:
    below = (1.0 - t) + t * b
    return select(below > 0.0, clamp(1.0 - (1.0 - a) / below), 0.0)


def _soft(a: Value, b: Value, t: Value) -> Value:
    screen = 1.0 - (1.0 - b) * (1.0 - a)
    return (1.0 - t) * a + t * ((1.0 - a) * b * a + a * screen)


def _hue(a: Vector, b: Vector, t: Value, *, saturated: bool = False) -> Color:
    """The hue of b, and its saturation too where that is wanted."""
    of_a, of_b = hsv_from_rgb(a), hsv_from_rgb(b)
    changed = _lerp(a, rgb_from_hsv(Vector(of_b.x, of_b.y if saturated else of_a.y, of_a.z)), t)
    return _map(lambda new, old: select(equal(of_b.y, 0.0), old, new), changed, a)


def _saturation(a: Vector, b: Vector, t: Value) -> Color:
    of_a, of_b = hsv_from_rgb(a), hsv_from_rgb(b)
    changed = rgb_from_hsv(Vector(of_a.x, (1.0 - t) * of_a.y + t * of_b.y, of_a.z))
    return _map(lambda new, old: select(equal(of_a.y, 0.0), old, new), changed, a)


def _value(a: Vector, b: Vector, t: Value) -> Color:
    of_a, of_b = hsv_from_rgb(a), hsv_from_rgb(b)
    return rgb_from_hsv(Vector(of_a.x, of_a.y, (1.0 - t) * of_a.z + t * of_b.z))


Blend = Callable[[Vector, Vector, Value], Color]


def _by_channel(blend: Callable[[Value, Value, Value], Value]) -> Blend:
    return lambda a, b, t: _map(lambda x, y: blend(x, y, t), a, b)


def _share_of(blend: Callable[[Value, Value], Value]) -> Blend:
    """Lays what two colours make of each other over the first."""
    return lambda a, b, t: _lerp(a, _map(blend, a, b), t)


# Blend modes by Blender's names: b is laid over a with weight t.
BLENDS: dict[str, Blend] = {
    "MIX": _lerp,
    "DARKEN": _share_of(minimum),
    "MULTIPLY": _share_of(mul),
    "BURN": _by_channel(_burn),
    "LIGHTEN": _share_of(maximum),
    "SCREEN": _by_channel(lambda x, y, t: 1.0 - ((1.0 - t) + t * (1.0 - y)) * (1.0 - x)),
    "DODGE": _by_channel(_dodge),
    "ADD": _share_of(add),
    "OVERLAY": _by_channel(_overlay),
    "SOFT_LIGHT": _by_channel(_soft),
    "LINEAR_LIGHT": _by_channel(lambda x, y, t: x + t * (2.0 * y - 1.0)),
    "DIFFERENCE": _share_of(lambda x, y: abs(x - y)),
    "EXCLUSION": _by_channel(lambda x, y, t: maximum((1.0 - t) * x + t * (x + y - 2.0 * x * y), 0.0)),
    "SUBTRACT": _share_of(sub),
    "DIVIDE": _by_channel(lambda x, y, t: select(equal(y, 0.0), x, (1.0 - t) * x + t * x / y)),
    "HUE": _hue,
    "SATURATION": _saturation,
    "COLOR": partial(_hue, saturated=True),
    "VALUE": _value,
}


def mix_color(a: Varying, b: Varying, factor: Number, blend: str = "mix") -> Color:
    """One colour laid over another, by a share that is clamped to 0 … 1; blend: as Blender's Mix node names it."""
    if blend.upper() not in BLENDS:
        raise ValueError(f"blend must be one of {', '.join(sorted(BLENDS)).lower()}, got {blend!r}")
    return BLENDS[blend.upper()](color(a), color(b), clamp(number(factor)))


def hue_saturation(
    c: Varying, hue: Number = 0.5, saturation: Number = 1.0, value: Number = 1.0, factor: Number = 1.0
) -> Color:
    """Blender's Hue/Saturation/Value node."""
    own, t = color(c), number(factor)
    h, s, v = hsv_from_rgb(own)
    changed = rgb_from_hsv(Vector(fraction(h + hue + 0.5), clamp(s * saturation), v * value))
    return _map(lambda new, old: maximum(t * new + (1.0 - t) * old, 0.0), changed, own)


def brightness_contrast(c: Varying, brightness: Number, contrast: Number) -> Color:
    """Blender's Brightness/Contrast node."""
    slope = 1.0 + number(contrast)
    shift = number(brightness) - number(contrast) * 0.5
    return _map(lambda x: maximum(slope * x + shift, 0.0), color(c))


def gamma(c: Varying, exponent: Number) -> Color:
    """Blender's Gamma node; what is not positive stays."""
    e = number(exponent)
    return _map(lambda x: select(equal(e, 0.0), 1.0, select(x > 0.0, power(x, e), x)), color(c))


def invert(c: Varying, factor: Number = 1.0) -> Color:
    """Blender's Invert node."""
    t = number(factor)
    return _map(lambda x: t * (1.0 - x) + (1.0 - t) * x, color(c))


LEAST_BEND = 1e-5  # difference of the steps before and after one of a ramp; below it is rounding


def ramp(factor: Number, colors: ArrayLike, *, interpolate: bool = True) -> Color:
    """A colour by a number in 0 … 1, from (n, 4) RGBA at even steps.

    Where the number is made of means of `noise` over a footprint, the colour is the mean of those for the noise there.
    Pictures, waves and other kinds of noise in it are looked up without footprints. Colours on a straight line need
    neither.
    """
    table = np.asarray(colors, dtype=np.float32)
    own, last = number(factor), float(len(table) - 1)
    is_bent = len(table) > 2 and np.abs(np.diff(table, 2, axis=0)).max() > LEAST_BEND
    variance = unresolved_variance(own) if is_bent else None
    if is_bent and (variance is None or any(step.name == "image" for step in in_order([own.step]))):
        own, variance = unfiltered(own), None
    place = clamp(own)
    stepped = place if interpolate else floor(place * last) / last

    def of_channel(channel: NDArray[np.float32]) -> Value:
        exact = operation("table1", stepped, data=Table(channel))
        if variance is None or not np.ptp(channel):
            return exact
        return mean_of(channel, place, exact, variance, interpolate=interpolate)

    return Color(*(of_channel(channel) for channel in table.T))
