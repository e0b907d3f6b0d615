# SPDX-License-Identifier: MIT
"""Random numbers, arrays and shapes for the fuzzer, many of them at the limits of what a function takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import Bsdf

Array = NDArray[Any]
Rng = np.random.Generator
# Arrays of a shape; whether they are accepted; whether all light of it is zero (None: it may be no region at all, as
# where outlines cross). None: either.
Shape = tuple[tuple[Any, ...], bool | None, bool | None]

SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-12, -1e-12, 1e-7, 5e-324, 1e-45, 1e-40, 1.2e-38, 1e-30, 1e-19, 1e-15, 1e15]
SPECIAL += [1e19, 1e20, 3e38, 1.3e154, 1.4e154, 1e308, math.pi, math.nextafter(1, 0), math.nextafter(1, 2)]
# Materials by their code. None reflects more than it receives.
MATERIALS = {
    code: eval(code, {"Bsdf": Bsdf})
    for code in (
        *("Bsdf.lambert(0.7)", "Bsdf.lambert(0)", "Bsdf.ggx(0, 0.9)", "Bsdf.ggx(0.003, 1)", "Bsdf.ggx(0.3, 1)"),
        *("Bsdf.ggx(0.05, [0.9, 0.5, 0.1])", "Bsdf.ggx(1, 1)", "Bsdf.ggx(0.4, 0)", "Bsdf.ggx(0.25, 0.04, ior=1.5)"),
        "Bsdf.layer(Bsdf.ggx(0.2, 0.04, ior=1.45), Bsdf.lambert(0.8))",
    )
}


def one_of(rng: Rng, *values: Any) -> Any:
    return values[rng.integers(len(values))]


def chance(rng: Rng, share: float) -> bool:
    return bool(rng.random() < share)


def material(rng: Rng) -> Bsdf:
    return one_of(rng, *MATERIALS.values())


def numbers(rng: Rng, shape: Any, dtype: Any = np.float64) -> Array:
    """Half of them usual, the others of any size that the type holds."""
    least, most = (-45, 38) if dtype == np.float32 else (-323, 308)
    signs, exponents = rng.choice([-1, 1], shape), [rng.uniform(-3, 3, shape), rng.uniform(least, most, shape)]
    sizes = [rng.normal(size=shape), *(signs * 10.0**e for e in exponents)]
    kinds = rng.random(shape)
    return np.select([kinds < 0.5, kinds < 0.7, kinds < 0.85], sizes, rng.choice(SPECIAL, shape)).astype(dtype)


def direction(rng: Rng) -> Array:
    """Also along axes, in the horizon and next to it."""
    if chance(rng, 0.2):
        return one_of(rng, 1.0, -1.0) * np.eye(3)[rng.integers(3)]
    d = rng.normal(size=3)
    if chance(rng, 0.2):
        d[2] = one_of(rng, 0.0, 1e-12, -1e-12, 1e-7, -1e-7)
    return np.asarray(d / np.linalg.norm(d))


def magnitude(rng: Rng, dtype: Any) -> float:
    """A unit of length in which coordinates stay in the type's range, and their squares not always."""
    most = 37 if dtype == np.float32 else 307
    return float(10.0 ** (rng.uniform(-3, 3) if chance(rng, 0.6) else rng.uniform(-most, most)))


def length(v: Array) -> Any:
    """In long doubles, whose squares stay in range."""
    return np.sqrt((v.astype(np.longdouble) ** 2).sum(-1))


def plane(rng: Rng) -> Array:
    """Two axes of a plane and its normal, as rows."""
    if chance(rng, 0.4):
        return np.roll(np.eye(3), rng.integers(3), axis=0)
    return np.asarray(np.linalg.qr(rng.normal(size=(3, 3)))[0])


def outline(rng: Rng, count: int) -> Array:
    """Plane corners ordered by angle around 0; with more than three corners 0 is inside."""
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.7, count)) / count
    return np.stack([np.cos(angles), np.sin(angles)], -1) * rng.uniform(0.4, 1, (count, 1))


def sphere(rng: Rng, corners: int, dtype: Any) -> Shape:
    if chance(rng, 0.2):
        center, radius = numbers(rng, 3, dtype), numbers(rng, (), dtype)[()]
    else:
        center = (direction(rng) * magnitude(rng, dtype)).astype(dtype)
        ratio = one_of(rng, math.sin(10 ** rng.uniform(-6, 0.19)), 1.0, rng.uniform(1, 3), 10 ** rng.uniform(-300, 0))
        to_touch = float(length(center)) * ratio, abs(float(center[2]))  # the shading point, the horizon
        radius = dtype(one_of(rng, to_touch[0], *to_touch))
    ratio = np.longdouble(radius) / max(length(center), np.longdouble("1e-4000"))
    if abs(ratio - 1) < 1e-5 or (ratio < 1 and length(center) < 2 * np.finfo(np.float32).tiny):
        return (center, radius), None if radius > 0 else False, False
    return (center, radius), bool(0 < ratio < 1), False


def cap(rng: Rng, corners: int, dtype: Any) -> Shape:
    axis = one_of(rng, direction(rng), numbers(rng, 3, dtype)).astype(dtype)
    half = dtype(one_of(rng, rng.uniform(0, math.pi), 10 ** rng.uniform(-45, 0.4), math.pi, numbers(rng, (), dtype)))
    return (axis, half), bool(axis.any() and 0 < half <= math.pi * (1 + 1e-7)), False


def polygon(rng: Rng, corners: int, dtype: Any) -> Shape:
    kind, axes, unit, flat = rng.integers(9), plane(rng), magnitude(rng, dtype), outline(rng, corners)
    exact = bool(np.isin(axes, (0, 1)).all())
    if kind == 0:  # planar, or with luck
        return (numbers(rng, (corners, 3), dtype),), None, None if corners > 3 else False
    if kind == 1:  # the shading point inside
        return ((flat * unit @ axes[:2]).astype(dtype),), False if exact and corners > 3 else None, False
    if kind == 2:  # on an edge or a vertex
        v = (flat * unit @ axes[:2]).astype(dtype)
        v[1] = -0.5 * v[0] if chance(rng, 0.5) else 0
        return (v,), False if exact and unit > 1e-30 else None, None
    if kind == 3:  # outside, edge-on
        shifted = flat + np.array([10 ** rng.uniform(0.1, 3), 0])
        return ((shifted * unit @ axes[:2]).astype(dtype),), True, exact
    if kind == 4:  # next to the horizon
        v = np.column_stack([flat + one_of(rng, 0, 0, 2), np.full(corners, one_of(rng, -1, 1) * 1e-12)])
        return ((v * one_of(rng, 1, 1e6, 1e-6)).astype(dtype),), True, False
    offset = direction(rng) * 10 ** rng.uniform(-2, 2)
    if kind == 5:  # no area
        steps = one_of(rng, np.zeros(corners), rng.integers(-3, 3, corners))
        return ((offset * unit).astype(dtype) * np.exp2(steps).astype(dtype)[:, None],), True, True
    if kind == 6:  # a sliver
        flat[:, 1] *= 10 ** rng.uniform(-30, -3)
    if kind == 7:  # repeated or collinear vertices
        flat = np.repeat(outline(rng, (corners + 1) // 2), 2, axis=0)[:corners]
        flat[1::2] += one_of(rng, 0, 0.5) * (np.roll(flat, -1, axis=0) - flat)[1::2]
    v = ((flat @ axes[:2] + offset) * unit).astype(dtype)
    usual = kind == 8 and unit > 1e-30 and abs(offset @ axes[2]) * unit > 1e-5 * float(length(v).max())
    return (v,), True if usual else None, False


def disk(rng: Rng, corners: int, dtype: Any) -> Shape:
    kind, axes, unit = rng.integers(6), plane(rng), magnitude(rng, dtype)
    exact = bool(np.isin(axes, (0, 1)).all()) and 1e-30 < unit < 1e30
    u, v = axes[0] * unit, (axes[1] * 10 ** rng.uniform(-3, 0) + axes[0] * one_of(rng, 0, rng.normal())) * unit
    c = direction(rng) * unit * 10 ** rng.uniform(-2, 3)
    accepted = True if abs(c @ axes[2]) > 1e-3 * unit and 1e-15 < unit < 1e15 else None
    if kind == 0:
        return tuple(numbers(rng, (3, 3), dtype)), None, False
    if kind == 1:  # the shading point inside
        c, accepted = 0.3 * v + 0.3 * u, False if exact else None
    if kind == 2:  # edge-on
        c, accepted = axes[0] * unit * 10 ** rng.uniform(1.5, 5), True if exact else None
    if kind == 3:  # the shading point on the rim
        c, accepted = one_of(rng, u, v), None
    if kind == 4:  # half axes that are nearly dependent
        v, accepted = u * rng.normal() + v * 10 ** rng.uniform(-20, -1), None
    return tuple(np.stack([c, u, v]).astype(dtype)), accepted, kind == 2 and exact


def disguised(rng: Rng, array: Any) -> Any:
    """The same numbers in another order of memory, or in memory that cannot be written."""
    kind = rng.integers(8) if np.ndim(array) else 8
    if kind == 0:
        return np.asfortranarray(array)
    if kind == 1:
        return np.stack([array, array], -1)[..., 0]
    if kind == 2:
        return array[::-1].copy()[::-1]
    if kind == 3:
        array = array.copy()
        array.flags.writeable = False
    return array
