# SPDX-License-Identifier: MIT
"""Coefficients of lights, and what is done with them.

Every function broadcasts over leading axes, spreads them over `threads` cores (0: all; the result does not depend on
it), takes arrays of the right type without a copy, and raises ValueError naming the argument for bad input.
Arithmetic and result are float32 where all arrays are, else float64, unless `dtype` names one of the two; numbers of
Python decide nothing beside arrays.
`out`, a C-contiguous array of the result's shape and type, is filled and returned; it must not overlap the inputs.

`method` "exact" is the library's own; `tolerance`, `samples`, `seed` and `sampling` are options of some of the other
methods, which shlight_tools.methods lists where it is built.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from shlight import _core
from shlight._arrays import (
    MAX_ORDER,
    Floats,
    all_rows,
    broadcast,
    check_last,
    checked_array,
    checked_flag,
    checked_order,
    checked_threads,
    checked_vectors,
    given_type,
    rows,
    shaped,
    wanted_type,
)
from shlight._calls import names_rows
from shlight._methods import coefficient_function, is_own
from shlight.gradients import CoefficientGradient


class _Settings(TypedDict, total=False):
    clip: bool
    method: str
    dtype: DTypeLike | None
    threads: int
    out: Floats | None
    tolerance: float | None
    samples: int | None
    seed: int | None
    sampling: Literal["solid_angle", "area"] | None


@names_rows
def sh_basis(
    directions: ArrayLike,
    order: int,
    dtype: DTypeLike | None = None,
    *,
    threads: int = 0,
    out: Floats | None = None,
) -> Floats:
    """The real spherical harmonics of all bands below `order` in given directions.

    directions: (..., 3), of any length > 0. Returns (..., order²).

    >>> shlight.sh_basis([0, 0, 1], order=2).round(4)
    array([0.2821, 0.    , 0.4886, 0.    ])
    """
    d = checked_array("directions", directions, wanted_type(dtype, directions), core_axes=1)
    check_last("directions", d, 3)
    n = checked_order(order)
    return _result(_core.sh_basis, (d.reshape(-1, 3), n, checked_threads(threads)), d.shape[:-1], out)


@names_rows
def evaluate(coefficients: ArrayLike, directions: ArrayLike, *, threads: int = 0) -> Floats:
    """The value of expansions in given directions: Σ coefficient · basis.

    coefficients: (..., order²); directions: (..., 3), of any length > 0; their leading axes broadcast.
    Returns (...).

    >>> whole = shlight.cap_coefficients([0, 0, 1], np.pi, order=4, clip=False)  # the basis over all directions
    >>> shlight.evaluate(whole, [[0, 0, 1], [1, 0, 0]]).round(6)
    array([1., 1.])
    """
    dtype = given_type(coefficients, directions)
    c = checked_array("coefficients", coefficients, dtype, core_axes=1)
    d = checked_array("directions", directions, dtype, core_axes=1)
    check_last("directions", d, 3)
    order = _order_of("coefficients", c)
    shape = broadcast(coefficients=c.shape[:-1], directions=d.shape[:-1])
    flat = _core.evaluate(rows(c, shape, order * order), rows(d, shape, 3), order, checked_threads(threads))
    return shaped(flat, shape)


@overload
def sphere_coefficients(
    centers: ArrayLike,
    radii: ArrayLike,
    order: int,
    *,
    gradient: Literal[False] = ...,
    **settings: Unpack[_Settings],
) -> Floats: ...
@overload
def sphere_coefficients(
    centers: ArrayLike,
    radii: ArrayLike,
    order: int,
    *,
    gradient: Literal[True],
    **settings: Unpack[_Settings],
) -> tuple[Floats, CoefficientGradient]: ...
@names_rows
def sphere_coefficients(
    centers: ArrayLike,
    radii: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike | None = None,
    threads: int = 0,
    out: Floats | None = None,
    tolerance: float | None = None,
    samples: int | None = None,
    seed: int | None = None,
    sampling: Literal["solid_angle", "area"] | None = None,
    gradient: bool = False,
) -> Floats | tuple[Floats, CoefficientGradient]:
    """Coefficients of sphere lights of unit radiance: the basis integrated over the cap that each covers.

    centers: (..., 3), radii: (...), in the shading frame, any unit of length; 0 < radius ≤ |center|.
    clip: keep only what lies above the horizon z ≥ 0. Returns (..., order²).
    Zhou & Wei 2020, Eq. 4 with unit radiance; docs/theory.md, 3, derives the recurrences.

    gradient: return also a CoefficientGradient, the exact derivatives by centre and radius, for orders 1 … 63. A sphere
    that touches the shading point has infinite ones by its half angle; they count as 0.

    >>> light = shlight.sphere_coefficients([[0, 0, 2], [1, 0, 1]], 0.5, order=4)
    >>> light.shape
    (2, 16)
    >>> light[:, 0].round(4)  # solid angle / √4π
    array([0.0563, 0.1145])
    """
    wanted = checked_flag("gradient", gradient)
    if wanted and not is_own("exact", method):
        raise ValueError("method must be 'exact' with gradient")
    options = {"tolerance": tolerance, "samples": samples, "seed": seed, "sampling": sampling}
    compute = coefficient_function("sphere_coefficients", method, **options)
    arguments, shape = _arguments(order, clip, threads, dtype, centers=centers, radii=radii)
    if not wanted:
        return _result(compute, arguments, shape, out)
    full = (*shape, arguments[2] ** 2)
    into = None if out is None else _checked_out(out, full, arguments[:2]).reshape(-1, full[-1])
    arguments = (*arguments, into)
    value, center, radius = _core.sphere_coefficients_gradient(*arguments)
    derivatives = CoefficientGradient(center.reshape(*full, 3), radius.reshape(full))
    return value.reshape(full) if out is None else out, derivatives


@names_rows
def cap_coefficients(
    axes: ArrayLike,
    half_angles: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike | None = None,
    threads: int = 0,
    out: Floats | None = None,
    tolerance: float | None = None,
    samples: int | None = None,
    seed: int | None = None,
    sampling: Literal["solid_angle", "area"] | None = None,
) -> Floats:
    """Coefficients of spherical caps.

    axes: (..., 3), of any length > 0; half_angles: (...), radians in (0, π].
    clip: keep only what lies above the horizon z ≥ 0. Returns (..., order²).

    >>> half_sky = shlight.cap_coefficients([0, 0, 1], np.pi / 2, order=2)
    >>> half_sky.round(4)
    array([1.7725, 0.    , 1.535 , 0.    ])
    """
    options = {"tolerance": tolerance, "samples": samples, "seed": seed, "sampling": sampling}
    compute = coefficient_function("cap_coefficients", method, **options)
    return _result(compute, *_arguments(order, clip, threads, dtype, axes=axes, half_angles=half_angles), out)


@names_rows
def polygon_coefficients(
    vertices: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    method: str = "exact",
    dtype: DTypeLike | None = None,
    threads: int = 0,
    out: Floats | None = None,
    tolerance: float | None = None,
    samples: int | None = None,
    seed: int | None = None,
    sampling: Literal["solid_angle", "area"] | None = None,
) -> Floats:
    """Coefficients of planar polygons of unit radiance, seen from the origin.

    vertices: (..., k, 3) with k ≥ 3, in the shading frame, any unit of length, in either winding: the region counts.
    A polygon without area or seen edge-on gives zeros. clip: keep only what lies above the horizon z ≥ 0.
    Returns (..., order²). ValueError for vertices that are not planar and for a shading point in the polygon.

    >>> panel = [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]  # a face of a cube around the point: a sixth of 4π
    >>> light = shlight.polygon_coefficients(panel, order=4)
    >>> float((light[0] * np.sqrt(4 * np.pi)).round(4))  # 2π/3
    2.0944
    """
    options = {"tolerance": tolerance, "samples": samples, "seed": seed, "sampling": sampling}
    compute = coefficient_function("polygon_coefficients", method, **options)
    return _result(compute, *_arguments(order, clip, threads, dtype, vertices=vertices), out)


@names_rows
def disk_coefficients(
    centers: ArrayLike,
    half_axes_u: ArrayLike,
    half_axes_v: ArrayLike,
    order: int,
    *,
    clip: bool = True,
    dtype: DTypeLike | None = None,
    threads: int = 0,
    out: Floats | None = None,
) -> Floats:
    """Coefficients of planar disks and ellipses of unit radiance, seen from the origin.

    centers, half_axes_u, half_axes_v: (..., 3), in the shading frame, any unit of length; their leading axes broadcast.
    An ellipse holds the points center + a u + b v with a² + b² ≤ 1: any two half axes that are linearly independent, at
    right angles or not, in either order: the region counts, and both sides of it shine. Seen edge-on it gives zeros.
    clip: keep only what lies above the horizon z ≥ 0. Returns (..., order²), right to 1e-10 of L_00 in float64 and 1e-5
    in float32, at contact, too. ValueError for dependent half axes and for a shading point in the ellipse.
    Stokes' theorem along the outline as elliptic functions: docs/theory.md, 5.

    >>> disk = shlight.disk_coefficients([0, 0, 1], [1, 0, 0], [0, 1, 0], order=3)
    >>> disk[[0, 2, 6]].round(4)  # all others are 0
    array([0.5191, 0.7675, 0.7006])
    """
    axes = {"half_axes_u": half_axes_u, "half_axes_v": half_axes_v}
    return _result(_core.disk_coefficients, *_arguments(order, clip, threads, dtype, centers=centers, **axes), out)


@names_rows
def contract(light: ArrayLike, material: ArrayLike, *, threads: int = 0) -> Floats:
    """Outgoing radiance, Σ light · material over the coefficients (Zhou & Wei 2020, Eq. 5).

    light: (..., order²), the coefficients of lights, whose radiance they are proportional to.
    material: (..., order²), those of f·cos at a view, as `Bsdf.coefficients` returns them, of the same order.
    Leading axes broadcast. Returns (...).

    RGB is an axis like others, before the last: a coloured material has coefficients (..., 3, order²), for which light
    is light[..., None, :], and the result is (..., 3). The radiance of lights is a factor of it: multiply it by their
    RGB. Three lights that meet the three rows of a coloured material one by one give a UserWarning.

    >>> light = shlight.sphere_coefficients([0.0, 0.0, 2.0], 1.0, order=8)
    >>> matt = shlight.Bsdf.lambert(0.5).coefficients(cos_theta_o=0.8, order=8)
    >>> float(np.round(shlight.contract(light, matt), 3))  # albedo · sin²σ, sinσ = 1/2
    0.125
    """
    dtype = given_type(light, material)
    lights = checked_array("light", light, dtype, core_axes=1)
    materials = checked_array("material", material, dtype, core_axes=1)
    order = _order_of("light", lights)
    size = order * order
    if materials.shape[-1] != size:
        raise ValueError(f"material has {materials.shape[-1]} coefficients, light has {size}")
    shape = broadcast(light=lights.shape[:-1], material=materials.shape[:-1])
    if lights.ndim > 1 and lights.shape[-2:-1] == materials.shape[-2:-1] == (3,):
        text = "3 lights and 3 rows of material are paired; for RGB pass light[..., None, :]"
        warnings.warn(text, stacklevel=3)
    flat = _core.contract(rows(lights, shape, size), rows(materials, shape, size), order, checked_threads(threads))
    return shaped(flat, shape)


def shade(light_coefficients: ArrayLike, bsdf_coefficients: ArrayLike, *, threads: int = 0) -> Floats:
    """Deprecated name of `contract`."""
    warnings.warn("shlight.shade is deprecated; its name is shlight.contract", DeprecationWarning, stacklevel=2)
    return contract(light_coefficients, bsdf_coefficients, threads=threads)


def _arguments(
    order: int, clip: bool, threads: int, dtype: DTypeLike | None, **lights: ArrayLike
) -> tuple[tuple[Any, ...], tuple[int, ...]]:
    """Flat arrays of lights and what the core takes after them, and the leading axes of the result."""
    arrays, shapes = checked_vectors(wanted_type(dtype, *lights.values()), **lights)
    shape = broadcast(**shapes)
    settings = checked_order(order), checked_flag("clip", clip), checked_threads(threads)
    return (*all_rows(arrays, shape), *settings), shape


def _result(
    compute: Callable[..., Any], arguments: tuple[Any, ...], leading: tuple[int, ...], out: Floats | None
) -> Floats:
    """Coefficients (*leading, order²), in `out` if it is given. arguments: flat arrays, the order, and what follows."""
    arrays = [own for own in arguments if isinstance(own, np.ndarray)]
    shape = (*leading, arguments[len(arrays)] ** 2)
    if out is None:
        made: Floats = compute(*arguments).reshape(shape)
        return made
    _checked_out(out, shape, arrays)
    if compute.__module__ == _core.__name__:
        compute(*arguments, out=out.reshape(-1, shape[-1]))
    else:  # the methods to compare with
        out[...] = compute(*arguments).reshape(shape)
    return out


def _checked_out(out: Floats, shape: tuple[int, ...], arrays: Sequence[Floats]) -> Floats:
    dtype = arrays[0].dtype
    fits = isinstance(out, np.ndarray) and out.dtype == dtype and out.shape == shape
    if not (fits and out.flags.c_contiguous and out.flags.writeable):
        raise ValueError(f"out must be a C-contiguous, writeable array of {dtype} and shape {shape}")
    if any(np.may_share_memory(out, own) for own in arrays):
        raise ValueError("out must not overlap the inputs")
    return out


def _order_of(name: str, coefficients: Floats) -> int:
    count = coefficients.shape[-1]
    order = math.isqrt(count)
    if order * order != count or not 1 <= order <= MAX_ORDER:
        raise ValueError(f"{name}: the last axis must have order² entries with order 1 … {MAX_ORDER}, got {count}")
    return order
