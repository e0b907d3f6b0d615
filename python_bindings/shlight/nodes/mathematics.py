# SPDX-License-Identifier: MIT
"""Functions of numbers and vectors, as Blender's Math, Vector Math, Map Range and Mapping nodes have them."""

from __future__ import annotations

import math
from collections.abc import Callable

from shlight.nodes.rays import unfiltered
from shlight.nodes.values import (
    Number,
    Value,
    Vector,
    clamp,
    cross,
    dot,
    equal,
    length,
    maximum,
    minimum,
    normalize,
    number,
    operation,
    select,
    sqrt,
)

LEAST_DIFFERENCE = 1.1920929e-07  # of numbers that Compare tells apart


def floor(a: Number) -> Value:
    """The largest integer that is not greater."""
    return operation("floor", a)


def ceil(a: Number) -> Value:
    """The smallest integer that is not less."""
    return -floor(-number(a))


def fraction(a: Number) -> Value:
    """What is above the next lower integer."""
    return number(a) - floor(a)


def sign(a: Number) -> Value:
    """-1, 0 or 1."""
    return (number(a) > 0.0) - (number(a) < 0.0)


def power(a: Number, b: Number) -> Value:
    """a to the b; 0 where that is not real."""
    return operation("power", a, b)


def wrap(a: Number, high: Number, low: Number) -> Value:
    """The number, moved by multiples of high - low to between them."""
    span = number(high) - number(low)
    return select(equal(span, 0.0), low, number(a) - span * floor((number(a) - low) / span))


def ping_pong(a: Number, scale: Number) -> Value:
    """A zigzag between 0 and the scale."""
    s = number(scale)
    return select(equal(s, 0.0), 0.0, abs(fraction((number(a) - s) / (s * 2.0)) * s * 2.0 - s))


def smooth_minimum(a: Number, b: Number, distance: Number) -> Value:
    """The smaller number, rounded off where both are nearer than the distance."""
    d, least = number(distance), minimum(a, b)
    h = maximum(d - abs(number(a) - number(b)), 0.0) / d
    return select(equal(d, 0.0), least, least - h * h * h * d * (1.0 / 6.0))


def _compare(a: Value, b: Value, within: Value) -> Value:
    near = 1.0 - (abs(a - b) > maximum(within, LEAST_DIFFERENCE))
    return maximum(equal(a, b), near)


def _logarithm(a: Value, base: Value) -> Value:
    valid = (a > 0.0) * (base > 0.0)
    return select(valid, operation("log", a) / operation("log", base), 0.0)


def _floored_modulo(a: Value, b: Value) -> Value:
    return select(equal(b, 0.0), 0.0, a - floor(a / b) * b)


def _named(name: str) -> Callable[[Value, Value, Value], Value]:
    """The core's operation of one number."""
    return lambda a, b, c: operation(name, a)


# Operations of the Math node by Blender's names; b and c are the second and third input. A mean over a footprint may be
# above what most of it is below.
MATH: dict[str, Callable[[Value, Value, Value], Value]] = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: a / b,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: power(a, b),
    "LOGARITHM": lambda a, b, c: _logarithm(a, b),
    "SQRT": lambda a, b, c: sqrt(a),
    "INVERSE_SQRT": lambda a, b, c: select(a > 0.0, 1.0 / sqrt(a), 0.0),
    "ABSOLUTE": lambda a, b, c: abs(a),
    "EXPONENT": lambda a, b, c: operation("exp", a),
    "MINIMUM": lambda a, b, c: minimum(a, b),
    "MAXIMUM": lambda a, b, c: maximum(a, b),
    "LESS_THAN": lambda a, b, c: unfiltered(a) < unfiltered(b),
    "GREATER_THAN": lambda a, b, c: unfiltered(a) > unfiltered(b),
    "SIGN": lambda a, b, c: sign(a),
    "COMPARE": lambda a, b, c: _compare(unfiltered(a), unfiltered(b), c),
    "SMOOTH_MIN": smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -smooth_minimum(-a, -b, c),
    "ROUND": lambda a, b, c: floor(a + 0.5),
    "FLOOR": lambda a, b, c: floor(a),
    "CEIL": lambda a, b, c: ceil(a),
    "TRUNC": lambda a, b, c: select(a < 0.0, ceil(a), floor(a)),
    "FRACT": lambda a, b, c: fraction(a),
    "MODULO": lambda a, b, c: operation("modulo", a, b),
    "FLOORED_MODULO": lambda a, b, c: _floored_modulo(a, b),
    "WRAP": wrap,
    "SNAP": lambda a, b, c: floor(a / b) * b,
    "PINGPONG": lambda a, b, c: ping_pong(a, b),
    "ARCTAN2": lambda a, b, c: operation("arctangent2", a, b),
    **{name: _named(name.lower()) for name in ("SINE", "COSINE", "TANGENT", "ARCSINE", "ARCCOSINE", "ARCTANGENT")},
    **{name: _named(name.lower()) for name in ("SINH", "COSH", "TANH")},
    "RADIANS": lambda a, b, c: a * (math.pi / 180.0),
    "DEGREES": lambda a, b, c: a * (180.0 / math.pi),
}


def _each(name: str) -> Callable[[Vector, Vector, Vector, Value], Vector]:
    return lambda a, b, c, s: Vector(*(MATH[name](*three) for three in zip(a, b, c, strict=True)))


def reflect(a: Vector, n: Vector) -> Vector:
    """The mirror image of a vector."""
    unit = normalize(n)
    return a - unit * (2.0 * dot(a, unit))


def refract(a: Vector, n: Vector, ratio: Number) -> Vector:
    """The refracted vector, 0 under total reflection."""
    unit, eta = normalize(n), number(ratio)
    along = dot(unit, a)
    k = 1.0 - eta * eta * (1.0 - along * along)
    bent = a * eta - unit * (eta * along + sqrt(k))
    return Vector(*(select(k < 0.0, 0.0, component) for component in bent))


def _face_forward(a: Vector, b: Vector, c: Vector) -> Vector:
    return Vector(*(select(dot(c, b) < 0.0, component, -component) for component in a))


VECTOR_MATH: dict[str, Callable[[Vector, Vector, Vector, Value], Vector | Value]] = {
    **{
        name: _each(name)
        for name in (
            "ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "SNAP", "FLOOR", "CEIL", "MODULO", "WRAP",
            "ABSOLUTE", "POWER", "SIGN", "MINIMUM", "MAXIMUM", "SINE", "COSINE", "TANGENT", "ROUND",
        )
    },
    "FRACTION": _each("FRACT"),
    "CROSS_PRODUCT": lambda a, b, c, s: cross(a, b),
    "PROJECT": lambda a, b, c, s: b * (dot(a, b) / dot(b, b)),
    "REFLECT": lambda a, b, c, s: reflect(a, b),
    "REFRACT": lambda a, b, c, s: refract(a, b, s),
    "FACEFORWARD": lambda a, b, c, s: _face_forward(a, b, c),
    "DOT_PRODUCT": lambda a, b, c, s: dot(a, b),
    "DISTANCE": lambda a, b, c, s: length(a - b),
    "LENGTH": lambda a, b, c, s: length(a),
    "SCALE": lambda a, b, c, s: a * s,
    "NORMALIZE": lambda a, b, c, s: normalize(a),
}  # fmt: skip


def _smooth(low: Value, high: Value, value: Value) -> Value:
    t = clamp((value - low) / (high - low))
    return t * t * (3.0 - 2.0 * t)


def _smoother(low: Value, high: Value, value: Value) -> Value:
    t = clamp((value - low) / (high - low))
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def map_range(
    value: Number,
    from_low: Number = 0.0,
    from_high: Number = 1.0,
    to_low: Number = 0.0,
    to_high: Number = 1.0,
    *,
    interpolation: str = "linear",
    steps: Number = 4.0,
    clamped: bool = True,
) -> Value:
    """A number of one range in another; interpolation: "linear", "stepped", "smoothstep" or "smootherstep".

    Where the map is bent or clamped, noises and pictures in the number are looked up without footprints.

    >>> worn = nodes.map_range(nodes.noise(scale=4).x, 0.4, 0.6, 0.1, 0.5)  # roughness in spots
    >>> steel = nodes.glossy((0.6, 0.6, 0.6), worn)
    """
    x, a, b, c, d = (number(n) for n in (value, from_low, from_high, to_low, to_high))
    if clamped or interpolation != "linear":
        x = unfiltered(x)
    share = (x - a) / (b - a)
    if interpolation == "stepped":
        count = number(steps)
        share = select(count > 0.0, floor(share * (count + 1.0)) / count, 0.0)
    elif interpolation in ("smoothstep", "smootherstep"):
        curve = _smooth if interpolation == "smoothstep" else _smoother
        share = select(a > b, 1.0 - curve(b, a, x), curve(a, b, x))
    result = select(equal(a, b), 0.0, c + share * (d - c))
    if clamped and interpolation in ("linear", "stepped"):
        result = clamp_range(result, c, d)
    return result


def clamp_range(value: Number, a: Number, b: Number) -> Value:
    """The number, or the end of the interval that it lies beyond; the ends in either order."""
    return clamp(value, minimum(a, b), maximum(a, b))


def _rotation(angles: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of the matrix that turns about x, then y, then z."""
    (cx, sx), (cy, sy), (cz, sz) = ((operation("cosine", a), operation("sine", a)) for a in angles)
    return (
        Vector(cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz),
        Vector(cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz),
        Vector(-sy, sx * cy, cx * cy),
    )


def rotate_euler(v: Vector, angles: Vector, *, invert: bool = False) -> Vector:
    """A vector, turned about x, then y, then z; or back."""
    rows = _rotation(angles)
    turned = zip(*rows, strict=True) if invert else rows
    return Vector(*(dot(Vector(*row), v) for row in turned))


def rotate(v: Vector, axis: Vector, angle: Number) -> Vector:
    """A vector, turned about an axis of any length (Rodrigues); as it is where the axis is 0."""
    size = length(axis)
    k = axis / size
    c, s = operation("cosine", angle), operation("sine", angle)
    turned = v * c + cross(k, v) * s + k * (dot(k, v) * (1.0 - c))
    return Vector(*(select(size, a, b) for a, b in zip(turned, v, strict=True)))


def mapping(v: Vector, location: Vector, rotation: Vector, scale: Vector, kind: str = "point") -> Vector:
    """Blender's Mapping node; kind: "point", "texture", "vector" or "normal"."""
    if kind == "texture":
        return rotate_euler(v - location, rotation, invert=True) / scale
    if kind == "normal":
        return normalize(rotate_euler(v / scale, rotation))
    placed = rotate_euler(v * scale, rotation)
    return placed + location if kind == "point" else placed
