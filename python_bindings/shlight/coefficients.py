# SPDX-License-Identifier: MIT
"""Coefficients of lights, and what is done with them.

Every function broadcasts over leading axes, spreads them over `threads` cores (0: all; the result does not depend on
it), takes arrays of the right type without a copy, and raises ValueError naming the argument for bad input.
`dtype` (float32 or float64) is the precision of inputs, arithmetic and result.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from shlight import _core

Floats = NDArray[Any]

_MAX_ORDER = 64


def sh_basis(directions: ArrayLike, order: int, dtype: DTypeLike = np.float32, *, threads: int = 0) -> Floats:
    """The real spherical harmonics of all bands below `order` in given directions.

    directions: (..., 3), of any length > 0. Returns (..., order²).
    """
    d = _array("directions", directions, dtype, core_axes=1)
    _check_last("directions", d, 3)
    n = _order(order)
    flat = _core.sh_basis(d.reshape(-1, 3), n, _threads(threads))
    return flat.reshape(*d.shape[:-1], n * n)


def evaluate(coefficients: ArrayLike, directions: ArrayLike, *, threads: int = 0) -> Floats:
    """The value of expansions in given directions: Σ coefficient · basis.

    coefficients: (..., order²); directions: (..., 3), of any length > 0; their leading axes broadcast.
    Returns (...), float64 if either input is, else float32.
    """
    dtype = _common_type(coefficients, directions)
    c = _array("coefficients", coefficients, dtype, core_axes=1)
    d = _array("directions", directions, dtype, core_axes=1)
    _check_last("directions", d, 3)
    order = _order_of("coefficients", c)
    shape = _broadcast(coefficients=c.shape[:-1], directions=d.shape[:-1])
    flat = _core.evaluate(_rows(c, shape, order * order), _rows(d, shape, 3), order, _threads(threads))
    return _shaped(flat, shape)


def sphere_coefficients(
    centers: ArrayLike,
    radii: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike = np.float32,
    threads: int = 0,
) -> Floats:
    """Coefficients of sphere lights of unit radiance: the basis integrated over the cap that each covers.

    centers: (..., 3), radii: (...), in the shading frame, any unit of length; 0 < radius ≤ |center|.
    clip: keep only what lies above the horizon z ≥ 0. Returns (..., order²).
    Zhou & Wei 2020, Eq. 4 with unit radiance; the recurrence is derived in docs/algorithms.md.
    """
    _check_method(method)
    c = _array("centers", centers, dtype, core_axes=1)
    r = _array("radii", radii, dtype)
    _check_last("centers", c, 3)
    shape = _broadcast(centers=c.shape[:-1], radii=r.shape)
    n = _order(order)
    flat = _core.sphere_coefficients(_rows(c, shape, 3), _rows(r, shape), n, bool(clip), _threads(threads))
    return flat.reshape(*shape, n * n)


def cap_coefficients(
    axes: ArrayLike,
    half_angles: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike = np.float32,
    threads: int = 0,
) -> Floats:
    """Coefficients of spherical caps.

    axes: (..., 3), of any length > 0; half_angles: (...), radians in (0, π].
    clip: keep only what lies above the horizon z ≥ 0. Returns (..., order²).
    """
    _check_method(method)
    a = _array("axes", axes, dtype, core_axes=1)
    h = _array("half_angles", half_angles, dtype)
    _check_last("axes", a, 3)
    shape = _broadcast(axes=a.shape[:-1], half_angles=h.shape)
    n = _order(order)
    flat = _core.cap_coefficients(_rows(a, shape, 3), _rows(h, shape), n, bool(clip), _threads(threads))
    return flat.reshape(*shape, n * n)


def polygon_coefficients(
    vertices: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike = np.float32,
    threads: int = 0,
) -> Floats:
    """Coefficients of planar polygons of unit radiance, seen from the origin.

    vertices: (..., k, 3) with k ≥ 3, in the shading frame, any unit of length, in either winding: the region counts.
    A polygon without area or seen edge-on gives zeros. clip: keep only what lies above the horizon z ≥ 0.
    Returns (..., order²).
    """
    _check_method(method)
    v = _array("vertices", vertices, dtype, core_axes=2)
    _check_last("vertices", v, 3)
    if v.shape[-2] < 3:
        raise ValueError(f"vertices: a polygon needs at least 3, got {v.shape[-2]}")
    n = _order(order)
    flat = _core.polygon_coefficients(v.reshape(-1, *v.shape[-2:]), n, bool(clip), _threads(threads))
    return flat.reshape(*v.shape[:-2], n * n)


def shade(light_coefficients: ArrayLike, bsdf_coefficients: ArrayLike, *, threads: int = 0) -> Floats:
    """Outgoing radiance, Σ light · material (Zhou & Wei 2020, Eq. 5).

    light_coefficients, bsdf_coefficients: (..., order²) of the same order; their leading axes broadcast.
    Returns (...), float64 if either input is, else float32. A coloured material has coefficients (..., 3, order²):
    pass light_coefficients[..., None, :].
    """
    dtype = _common_type(light_coefficients, bsdf_coefficients)
    light = _array("light_coefficients", light_coefficients, dtype, core_axes=1)
    bsdf = _array("bsdf_coefficients", bsdf_coefficients, dtype, core_axes=1)
    order = _order_of("light_coefficients", light)
    if bsdf.shape[-1] != order * order:
        raise ValueError(f"bsdf_coefficients has {bsdf.shape[-1]} coefficients, light_coefficients has {order * order}")
    shape = _broadcast(light_coefficients=light.shape[:-1], bsdf_coefficients=bsdf.shape[:-1])
    size = order * order
    flat = _core.shade(_rows(light, shape, size), _rows(bsdf, shape, size), order, _threads(threads))
    return _shaped(flat, shape)


def _shaped(flat: Floats, shape: tuple[int, ...]) -> Floats:
    """Results without axes are numpy scalars, as numpy's own functions return them."""
    return flat.reshape(shape)[()]


def _order(order: int) -> int:
    try:
        n = operator.index(order)
    except TypeError:
        raise ValueError(f"order must be an integer 1 … {_MAX_ORDER}, got {order!r}") from None
    if not 1 <= n <= _MAX_ORDER:
        raise ValueError(f"order must be 1 … {_MAX_ORDER}, got {n}")
    return n


def _order_of(name: str, coefficients: Floats) -> int:
    count = coefficients.shape[-1]
    order = math.isqrt(count)
    if order * order != count or not 1 <= order <= _MAX_ORDER:
        raise ValueError(f"{name}: the last axis must have order² entries with order 1 … {_MAX_ORDER}, got {count}")
    return order


def _threads(threads: int) -> int:
    try:
        n = operator.index(threads)
    except TypeError:
        raise ValueError(f"threads must be an integer ≥ 0, got {threads!r}") from None
    if n < 0:
        raise ValueError(f"threads must be ≥ 0, got {n}")
    return n


def _check_method(method: str) -> None:
    if method != "exact":
        raise ValueError(f"method must be 'exact', got {method!r}")


def _common_type(*arrays: ArrayLike) -> DTypeLike:
    return np.float64 if any(getattr(a, "dtype", None) == np.float64 for a in arrays) else np.float32


def _array(name: str, value: ArrayLike, dtype: DTypeLike, *, core_axes: int = 0) -> Floats:
    wanted = np.dtype(dtype)
    if wanted not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise ValueError(f"dtype must be float32 or float64, got {wanted}")
    try:
        given = np.asarray(value)
        if not (np.issubdtype(given.dtype, np.floating) or np.issubdtype(given.dtype, np.integer)):
            raise ValueError
        with np.errstate(over="ignore"):  # what does not fit becomes infinite and is refused as such
            array = np.ascontiguousarray(given, dtype=wanted).reshape(given.shape)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array of real numbers") from None
    if array.ndim < core_axes:
        raise ValueError(f"{name} must have at least {core_axes} axes, got shape {array.shape}")
    return array


def _check_last(name: str, array: Floats, size: int) -> None:
    if array.shape[-1] != size:
        raise ValueError(f"{name} must have shape (..., {size}), got {array.shape}")


def _broadcast(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        described = " and ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"the leading axes of {described} do not broadcast") from None


def _rows(array: Floats, shape: tuple[int, ...], *core: int) -> Floats:
    """The array as contiguous rows of the broadcast shape; copied only if it really has to be spread."""
    full = (*shape, *core)
    spread = array if array.shape == full else np.ascontiguousarray(np.broadcast_to(array, full))
    return spread.reshape(-1, *core)
