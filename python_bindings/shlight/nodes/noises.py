# SPDX-License-Identifier: MIT
"""Noise, and waves that it bends.

What is finer than the distance between camera rays is taken for its mean, so that a surface far away is smooth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from shlight._arrays import checked_flag, checked_name
from shlight.nodes.inputs import texture_coordinates, texture_place
from shlight.nodes.mathematics import floor
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Vector,
    below,
    clamp,
    length,
    maximum,
    minimum,
    number,
    operation,
    right,
    select,
    sqrt,
    steps,
)

# The core's fractals, by the numbers that are modes of its operations.
FRACTALS = (
    "fbm",
    "fbm_loss",
    "fbm_sum",
    "musgrave_sum",
    "multifractal",
    "hetero_terrain",
    "hybrid",
    "ridged",
)
# Fractals by kinds of noise that are not normalised.
KINDS = {
    "fbm": "fbm_sum",
    "multifractal": "multifractal",
    "hetero_terrain": "hetero_terrain",
    "hybrid_multifractal": "hybrid",
    "ridged_multifractal": "ridged",
}
PERIOD = 1e5
MOST_DETAIL = 15.0
LEAST = 1e-5  # lacunarity and dimension of a Musgrave Texture
TURN = 2.0 * math.pi
SHORTEST = 1.0 / 64.0  # interval over which a profile is averaged, in turns
# Mean squares of the slope of noise of 1 … 4 coordinates along one of them, of a million places.
SLOPES = (1.2255, 0.8552, 0.4643, 0.3594)


@dataclass(frozen=True)
class _Octaves:
    """A fractal, and its arguments beside the place."""

    kind: str
    octaves: Number
    roughness: Number = 0.5
    lacunarity: Number = 2.0
    offset: Number = 0.0
    gain: Number = 0.0
    period: float = 0.0

    def at(self, place: Sequence[Value], footprint: tuple[Value, ...]) -> Value:
        settings = (self.octaves, self.roughness, self.lacunarity, self.offset, self.gain, self.period)
        mode = FRACTALS.index(self.kind)
        return operation(f"noise{len(place)}", *place, *settings, *footprint, data=mode)


def _footprint(place: Sequence[Value]) -> tuple[Value, ...]:
    """Trace and determinant of the scalar products of the steps to the camera rays to the right and below, and the
    longer axis of what they span."""
    return steps(f"footprint{len(place)}", *(right(x) for x in place), *(below(x) for x in place))


def _seed(count: int, seed: int) -> list[Value]:
    """The way to a place whose noise is independent of that at this one: 100 … 200 along each axis."""
    keys = [(float(seed),)] if count == 1 else [(float(seed), float(axis)) for axis in range(count)]
    return [100.0 + operation(f"hash{len(key)}", *key) * 100.0 for key in keys]


def _moved(place: Sequence[Value], seed: int) -> list[Value]:
    return [x + offset for x, offset in zip(place, _seed(len(place), seed), strict=True)]


def _distorted(place: list[Value], distortion: Number, period: float) -> tuple[list[Value], tuple[Value, ...]]:
    """A place that noise has moved, and its footprint, which grows by the mean square of the noise's slope. Its
    axis does not turn with the slope: places along it are right where the distortion is small, and else as good as any.
    """
    footprint, amount, count = _footprint(place), number(distortion, "distortion"), len(place)
    if amount.constant == 0.0:
        return place, footprint
    plain = _Octaves("fbm_sum", 1.0, period=period)
    trace, determinant, *axis = footprint
    moved = [x + plain.at(_moved(place, axis), footprint) * amount for axis, x in enumerate(place)]
    grown = 1.0 + amount * amount * (count * SLOPES[count - 1])
    return moved, (trace * grown, determinant * (grown * grown), *axis)


def noise(
    place: Vector | None = None,
    w: Number = 0.0,
    *,
    dimensions: int = 3,
    kind: str = "fbm",
    normalize: bool = True,
    scale: Number = 5.0,
    detail: Number = 2.0,
    roughness: Number = 0.5,
    lacunarity: Number = 2.0,
    offset: Number = 0.0,
    gain: Number = 1.0,
    distortion: Number = 0.0,
    repeats: bool = True,
) -> Color:
    """Three independent noises, as Blender's Noise Texture has them: `.x` is its Fac, all three are its Color.

    place: a vector, of which two coordinates count where dimensions is 2; None: `position()`.
    w: the fourth coordinate, or the only one where dimensions is 1.
    dimensions: 1, 2, 3 or 4.
    kind: "fbm", "multifractal", "hetero_terrain", "hybrid_multifractal" or "ridged_multifractal" (Musgrave, in Ebert et
        al., Texturing and Modeling, 1994) of the gradient noise of Perlin 2002.
    normalize: brings "fbm" to 0 … 1; without it, as the other kinds, it has the size that it has.
    scale: what the place is multiplied with. Cells of the first octave have side 1 then.
    detail: octaves beside the first one, 0 … 15; what lies beyond is clamped.
    roughness, lacunarity: strength and frequency of an octave beside those of the one before.
    offset, gain: of kinds that have them.
    distortion: how far the place is moved by noise.
    repeats: whether the pattern repeats after 100 000, as in Blender since version 4.
    Octaves that are finer than the distance between camera rays are taken for their means.
    Raises ValueError naming the argument.
    """
    known = KINDS[checked_name("kind", kind, tuple(KINDS))]
    period = PERIOD if checked_flag("repeats", repeats) else 0.0
    moved, footprint = _distorted(texture_coordinates(place, w, scale, dimensions), distortion, period)
    octaves = _Octaves(
        "fbm" if known == "fbm_sum" and checked_flag("normalize", normalize) else known,
        clamp(number(detail, "detail"), 0.0, MOST_DETAIL) + 1.0,
        maximum(number(roughness, "roughness"), 0.0),
        number(lacunarity, "lacunarity"),
        number(offset, "offset"),
        number(gain, "gain"),
        period,
    )
    seeds = [dimensions, dimensions + 1]  # those before moved the place
    others = [octaves.at(_moved(moved, seed), footprint) for seed in seeds]
    return Color(octaves.at(moved, footprint), *others)


def musgrave(
    place: Vector | None = None,
    w: Number = 0.0,
    *,
    dimensions: int = 3,
    kind: str = "fbm",
    scale: Number = 5.0,
    detail: Number = 2.0,
    dimension: Number = 2.0,
    lacunarity: Number = 2.0,
    offset: Number = 0.0,
    gain: Number = 1.0,
    repeats: bool = True,
) -> Value:
    """The number of the Musgrave Texture, which Blender had until version 4.0; it differs from `noise` in these:

    detail: all octaves, 0 … 15.
    dimension: minus the logarithm of the octaves' strength to the base of lacunarity.
    Raises ValueError naming the argument.
    """
    known = KINDS[checked_name("kind", kind, tuple(KINDS))]
    where = texture_coordinates(place, w, scale, dimensions)
    count = clamp(number(detail, "detail"), 0.0, MOST_DETAIL)
    if known == "hetero_terrain":  # where part of the first octave is asked for, it is whole, and that is the second's
        count = select(count < 1.0, count + 1.0, count)
    frequency = maximum(number(lacunarity, "lacunarity"), LEAST)
    octaves = _Octaves(
        "musgrave_sum" if known == "fbm_sum" else known,
        count,
        operation("power", frequency, -maximum(number(dimension, "dimension"), LEAST)),
        frequency,
        number(offset, "offset"),
        number(gain, "gain"),
        PERIOD if checked_flag("repeats", repeats) else 0.0,
    )
    return octaves.at(where, _footprint(where))


# Phases of bands and of rings by their directions; rings run around an axis, or around the origin.
BANDS: dict[str, Callable[[Vector], Value]] = {
    "x": lambda p: p.x * 20.0,
    "y": lambda p: p.y * 20.0,
    "z": lambda p: p.z * 20.0,
    "diagonal": lambda p: (p.x + p.y + p.z) * 10.0,
}
RINGS: dict[str, Callable[[Vector], Value]] = {
    "x": lambda p: length(Vector(0.0, p.y, p.z)) * 20.0,
    "y": lambda p: length(Vector(p.x, 0.0, p.z)) * 20.0,
    "z": lambda p: length(Vector(p.x, p.y, 0.0)) * 20.0,
    "spherical": lambda p: length(p) * 20.0,
}


def _sine(phase: Value, variance: Value) -> Value:
    """Its mean over phases spread as in a Gaussian, raised so that it is the sine itself where those are few."""
    left = minimum(operation("exp", variance * -0.5) * (1.0 / 0.96), 1.0)
    return 0.5 + 0.5 * (operation("sine", phase - math.pi / 2.0) * left)


def _saw(turns: Value) -> tuple[Value, Value]:
    """A saw less its mean, and the integral of that."""
    own = turns - floor(turns) - 0.5
    return own, own * own * 0.5


def _triangle(turns: Value) -> tuple[Value, Value]:
    own = turns - floor(turns + 0.5)
    return abs(own) * 2.0 - 0.5, own * (abs(own) - 0.5)


def _periodic(profile: Callable[[Value], tuple[Value, Value]], phase: Value, variance: Value) -> Value:
    """A profile's mean over an interval of that variance, or where that is short the profile itself."""
    turns, width = phase / TURN, sqrt(variance * 12.0) / TURN
    here, half = turns - floor(turns), width * 0.5
    mean = (profile(here + half)[1] - profile(here - half)[1]) / width
    return 0.5 + select(width < SHORTEST, profile(turns)[0], mean)


PROFILES: dict[str, Callable[[Value, Value], Value]] = {
    "sine": _sine,
    "saw": partial(_periodic, _saw),
    "triangle": partial(_periodic, _triangle),
}


def wave(
    place: Vector | None = None,
    *,
    kind: str = "bands",
    direction: str = "x",
    profile: str = "sine",
    scale: Number = 5.0,
    distortion: Number = 0.0,
    detail: Number = 2.0,
    detail_scale: Number = 1.0,
    detail_roughness: Number = 0.5,
    phase: Number = 0.0,
    repeats: bool = True,
) -> Value:
    """Waves between 0 and 1, as Blender's Wave Texture has them.

    place: None: `position()`.
    kind: "bands", along a direction "x", "y", "z" or "diagonal", or "rings", around "x", "y", "z" or "spherical".
    profile: "sine", "saw" or "triangle".
    scale: what the place is multiplied with; a wave is π/10 long, and diagonally π/(5 √3).
    distortion: by how much, in radians, noise moves waves at most; detail, detail_scale, detail_roughness: of that
        noise, beside the waves' scale.
    phase: [radian].
    repeats: as of `noise`.
    Waves and octaves that are finer than the distance between camera rays are taken for their means.
    Raises ValueError naming the argument.
    """
    directions = {"bands": BANDS, "rings": RINGS}[checked_name("kind", kind, ("bands", "rings"))]
    chosen = directions[checked_name("direction", direction, tuple(directions))]
    shape = PROFILES[checked_name("profile", profile, tuple(PROFILES))]
    # Edges at whole coordinates would be noise, as in Blender.
    p = (texture_place(place) * number(scale, "scale") + 1e-6) * 0.999999
    turned = chosen(p) + number(phase, "phase")
    variance = _footprint([turned])[0] * (1.0 / 12.0)
    amount = number(distortion, "distortion")
    if amount.constant != 0.0:
        where = [x * number(detail_scale, "detail_scale") for x in p]
        octaves = _Octaves(
            "fbm",
            clamp(number(detail, "detail"), 0.0, MOST_DETAIL) + 1.0,
            number(detail_roughness, "detail_roughness"),
            period=PERIOD if checked_flag("repeats", repeats) else 0.0,
        )
        trace, determinant, *axis = _footprint(where)
        # A wave's mean is not the wave of the mean, so that noise is looked up at one place.
        footprint = (trace, determinant, *(number(0.0) for _ in axis))
        turned = turned + amount * (octaves.at(where, footprint) * 2.0 - 1.0)
        variance = variance + amount * amount * replace(octaves, kind="fbm_loss").at(where, footprint)
    return shape(turned, variance)
