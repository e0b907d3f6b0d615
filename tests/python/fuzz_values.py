# SPDX-License-Identifier: MIT
"""Random numbers, arrays and light shapes for fuzz.py, most of them at the limits of what a function takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import Bsdf

Array = NDArray[Any]
Rng = np.random.Generator
Expected = bool | None  # whether it is accepted; None: either
Zero = bool | None  # whether light of it is zero; None: it is no region, as where outlines cross

SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-12, -1e-12, 1e-7, 5e-324, 1e-45, 1e-40, 1.2e-38, 1e-30, 1e-19, 1e-15]
SPECIAL += [1e15, 1e19, 1e20, 3e38, 1.4e154, 1.3e154, 1e308, math.pi, math.nextafter(1, 0), math.nextafter(1, 2)]
# By what to type for them.
MATERIALS = {
    "Bsdf.lambert(0.7)": Bsdf.lambert(0.7),
    "Bsdf.lambert(0)": Bsdf.lambert(0),
    "Bsdf.ggx(0, 0.9)": Bsdf.ggx(0, 0.9),
    "Bsdf.ggx(0.003, 1)": Bsdf.ggx(0.003, 1),
    "Bsdf.ggx(0.05, [0.9, 0.5, 0.1])": Bsdf.ggx(0.05, [0.9, 0.5, 0.1]),
    "Bsdf.ggx(0.3, 1)": Bsdf.ggx(0.3, 1),
    "Bsdf.ggx(1, 1)": Bsdf.ggx(1, 1),
    "Bsdf.ggx(0.4, 0)": Bsdf.ggx(0.4, 0),
    "Bsdf.ggx(0.25, 0.04, ior=1.5)": Bsdf.ggx(0.25, 0.04, ior=1.5),
    "Bsdf.layer(Bsdf.ggx(0.2, 0.04, ior=1.45), Bsdf.lambert(0.8))": Bsdf.layer(
        Bsdf.ggx(0.2, 0.04, ior=1.45), Bsdf.lambert(0.8)
    ),
}


def material(rng: Rng) -> Bsdf:
    return list(MATERIALS.values())[rng.integers(len(MATERIALS))]


def one_of(rng: Rng, *values: Any) -> Any:
    return values[rng.integers(len(values))]


def chance(rng: Rng, share: float) -> bool:
    return bool(rng.random() < share)


def cast(values: Any, dtype: Any) -> Array:
    with np.errstate(all="ignore"):
        return np.asarray(values, np.float64).astype(dtype)


def numbers(rng: Rng, shape: Any, dtype: Any = np.float64) -> Array:
    """Half of them usual, the others of any size that the type holds."""
    least, most = (-45, 38) if dtype == np.float32 else (-323, 308)
    kinds, signs = rng.random(shape), rng.choice([-1, 1], shape)
    exponents = rng.uniform(-3, 3, shape), rng.uniform(least, most, shape)
    sizes = [rng.normal(size=shape), *(signs * 10.0**e for e in exponents)]
    return cast(np.select([kinds < 0.5, kinds < 0.7, kinds < 0.85], sizes, rng.choice(SPECIAL, shape)), dtype)


def number(rng: Rng, dtype: Any = np.float64) -> float:
    return float(numbers(rng, (), dtype))


def direction(rng: Rng) -> Array:
    """Also along axes, in the horizon and next to it."""
    if chance(rng, 0.2):
        return one_of(rng, 1.0, -1.0) * np.eye(3)[rng.integers(3)]
    d = rng.normal(size=3)
    if chance(rng, 0.2):
        d[2] = one_of(rng, 0.0, 1e-12, -1e-12, 1e-7, -1e-7)
    return np.asarray(d / np.linalg.norm(d))


def magnitude(rng: Rng, dtype: Any) -> float:
    """A unit of length in which coordinates, and for float32 their squares, stay in range or not."""
    most = 37 if dtype == np.float32 else 307
    return float(10.0 ** (rng.uniform(-3, 3) if chance(rng, 0.6) else rng.uniform(-most, most)))


def length(v: Array) -> Any:
    """In long doubles, whose squares stay in range."""
    return np.sqrt((v.astype(np.longdouble) ** 2).sum(-1))


def sphere(rng: Rng, dtype: Any) -> tuple[Array, Array, Expected]:
    kind = rng.integers(5)
    if kind == 0:
        center, radius = numbers(rng, (3,), dtype), cast(number(rng, dtype), dtype)
    else:
        center = cast(direction(rng) * magnitude(rng, dtype), dtype)
        distance = float(length(center))
        share = {1: math.sin(10 ** rng.uniform(-6, 0.19)), 2: 1.0, 3: rng.uniform(1, 3), 4: 10 ** rng.uniform(-300, 0)}
        radius = cast(share[int(kind)] * distance if chance(rng, 0.8) else abs(float(center[2])), dtype)
    if not (np.isfinite(center).all() and 0 < radius < math.inf):
        return center, radius, False
    ratio = np.longdouble(radius) / length(center) if center.any() else math.inf
    if abs(ratio - 1) < 1e-5 or length(center) < 2 * np.finfo(np.float32).tiny:
        return center, radius, None if ratio < 1 + 1e-5 else False
    return center, radius, bool(ratio < 1)


def plane(rng: Rng) -> Array:
    """Two axes of a plane and its normal, as rows."""
    if chance(rng, 0.4):
        return np.roll(np.eye(3), rng.integers(3), axis=0)
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(q)


def outline(rng: Rng, count: int) -> Array:
    """Star-shaped around 0, in the plane."""
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.7, count)) / count
    return np.stack([np.cos(angles), np.sin(angles)], -1) * rng.uniform(0.4, 1, (count, 1))


def polygon(rng: Rng, count: int, dtype: Any) -> tuple[Array, Expected, Zero]:
    """Vertices, whether they are accepted, and whether all light of them is zero."""
    v, accepted, zero = _polygon(rng, count, dtype)
    return v, accepted if np.isfinite(v).all() else False, zero


def _polygon(rng: Rng, count: int, dtype: Any) -> tuple[Array, Expected, Zero]:
    kind, axes = rng.integers(9), plane(rng)
    exact = bool(np.isin(axes, (0, 1)).all())
    unit = magnitude(rng, dtype)
    flat = outline(rng, count)
    if kind == 0:  # planar, or with luck
        return numbers(rng, (count, 3), dtype), None, None if count > 3 else False
    if kind == 1:  # the shading point inside
        return cast(flat * unit @ axes[:2], dtype), False if exact and count > 3 else None, False
    if kind == 2:  # on an edge or a vertex
        v = cast(flat * unit @ axes[:2], dtype)
        v[1] = -0.5 * v[0] if chance(rng, 0.5) else 0
        return v, False if exact and unit > 1e-30 else None, None
    if kind == 3:  # outside, edge-on
        shift = 10 ** rng.uniform(0.1, 3)
        return cast((flat + [shift, 0]) * unit @ axes[:2], dtype), True, exact
    if kind == 4:  # next to the horizon
        v = np.column_stack([flat + one_of(rng, 0, 0, 2), np.full(count, one_of(rng, -1, 1) * 1e-12)])
        return cast(v * one_of(rng, 1, 1e6, 1e-6), dtype), True, False
    offset = direction(rng) * 10 ** rng.uniform(-2, 2)
    if kind == 5:  # no area
        steps = cast(one_of(rng, np.zeros(count), rng.integers(-3, 3, count).astype(float)), dtype)
        return cast(offset * unit, dtype) * np.exp2(steps)[:, None], True, True
    if kind == 6:  # a sliver
        flat[:, 1] *= 10 ** rng.uniform(-30, -3)
    if kind == 7:  # repeated and collinear vertices
        flat = np.repeat(outline(rng, (count + 1) // 2), 2, axis=0)[:count]
        flat[1::2] += one_of(rng, 0, 0.5) * (np.roll(flat, -1, axis=0) - flat)[1::2]
    v = cast((flat @ axes[:2] + offset) * unit, dtype)
    height = abs(float(offset @ axes[2])) * unit / max(float(length(v).max()), 5e-324)
    return v, True if height > 1e-5 and kind == 8 and unit > 1e-30 else None, False


def disk(rng: Rng, dtype: Any) -> tuple[Array, Array, Array, Expected, Zero]:
    """Centre and half axes, and as of polygon."""
    c, u, v, accepted, zero = _disk(rng, dtype)
    return c, u, v, accepted if np.isfinite([c, u, v]).all() else False, zero


def _disk(rng: Rng, dtype: Any) -> tuple[Array, Array, Array, Expected, Zero]:
    kind, axes, unit = rng.integers(6), plane(rng), magnitude(rng, dtype)
    exact = bool(np.isin(axes, (0, 1)).all())
    u, v = axes[0] * unit, (axes[1] * 10 ** rng.uniform(-3, 0) + axes[0] * one_of(rng, 0, rng.normal())) * unit
    if kind == 0:
        c, u, v = numbers(rng, (3, 3), dtype)
        return c, u, v, None, False
    if kind == 1:  # the shading point inside
        return (*cast([0.3 * v + 0.3 * u, u, v], dtype), False if exact and 1e-30 < unit < 1e30 else None, False)
    if kind == 2:  # edge-on
        outside = axes[0] * unit * 10 ** rng.uniform(1.5, 5)
        return (*cast([outside, u, v], dtype), True if 1e-30 < unit < 1e30 else None, exact)
    if kind == 3:  # on the rim
        return (*cast([one_of(rng, u, v), u, v], dtype), None, False)
    if kind == 4:  # narrow half axes
        v = u * rng.normal() + v * 10 ** rng.uniform(-20, -1)
        return (*cast([direction(rng) * unit, u, v], dtype), None, False)
    offset = direction(rng) * unit * 10 ** rng.uniform(-2, 3)
    height = abs(float(offset @ axes[2])) / unit
    return (*cast([offset, u, v], dtype), True if height > 1e-3 and 1e-15 < unit < 1e15 else None, False)


def disguised(rng: Rng, array: Array) -> Array:
    """The same numbers in another order of memory."""
    kind = rng.integers(8)
    if array.ndim == 0:
        return array
    if kind == 0:
        array = np.asfortranarray(array)
    elif kind == 1:
        wide = np.zeros((*array.shape, 2), array.dtype)
        wide[..., 0] = array
        array = wide[..., 0]
    elif kind == 2:
        array = array[::-1].copy()[::-1]
    elif kind == 3:
        array = array.copy()
        array.flags.writeable = False
    return array
