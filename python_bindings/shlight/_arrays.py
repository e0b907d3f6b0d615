# SPDX-License-Identifier: MIT
"""Arguments of batch functions: checked, converted and broadcast, with errors that name them."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Floats = NDArray[Any]

MAX_ORDER = 64

_TYPES = (np.dtype(np.float32), np.dtype(np.float64))


def shaped(flat: Floats, shape: tuple[int, ...]) -> Floats:
    """Results without axes are numpy scalars, as numpy's own functions return them."""
    return flat.reshape(shape)[()]


def checked_order(order: int) -> int:
    try:
        n = operator.index(order)
    except TypeError:
        raise ValueError(f"order must be an integer 1 … {MAX_ORDER}, got {order!r}") from None
    if not 1 <= n <= MAX_ORDER:
        raise ValueError(f"order must be 1 … {MAX_ORDER}, got {n}")
    return n


def checked_threads(threads: int) -> int:
    try:
        n = operator.index(threads)
    except TypeError:
        raise ValueError(f"threads must be an integer ≥ 0, got {threads!r}") from None
    if n < 0:
        raise ValueError(f"threads must be ≥ 0, got {n}")
    return n


def common_type(*arrays: ArrayLike) -> DTypeLike:
    return np.float64 if any(getattr(a, "dtype", None) == np.float64 for a in arrays) else np.float32


def checked_array(name: str, value: ArrayLike, dtype: DTypeLike, *, core_axes: int = 0) -> Floats:
    wanted = np.dtype(dtype)
    if wanted not in _TYPES:
        raise ValueError(f"dtype must be float32 or float64, got {wanted}")
    if type(value) is np.ndarray and value.dtype == wanted and value.flags.c_contiguous:
        array: Floats = value  # finding out with numpy that nothing is to be done takes as long as a hundred lights
    else:
        array = _converted(name, value, wanted)
    if array.ndim < core_axes:
        raise ValueError(f"{name} must have at least {core_axes} axes, got shape {array.shape}")
    return array


def _converted(name: str, value: ArrayLike, dtype: np.dtype[Any]) -> Floats:
    try:
        given = np.asarray(value)
        if not (np.issubdtype(given.dtype, np.floating) or np.issubdtype(given.dtype, np.integer)):
            raise ValueError
        with np.errstate(over="ignore"):  # what does not fit becomes infinite and is refused as such
            return np.ascontiguousarray(given, dtype=dtype).reshape(given.shape)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array of real numbers") from None


def check_last(name: str, array: Floats, size: int) -> None:
    if array.shape[-1] != size:
        raise ValueError(f"{name} must have shape (..., {size}), got {array.shape}")


def checked_disks(
    centers: ArrayLike, half_axes_u: ArrayLike, half_axes_v: ArrayLike, dtype: DTypeLike
) -> tuple[Floats, Floats, Floats]:
    """The arrays (..., 3) of disks and ellipses: the points centre + a u + b v with a² + b² ≤ 1."""
    given = {"centers": centers, "half_axes_u": half_axes_u, "half_axes_v": half_axes_v}
    checked = {name: checked_array(name, value, dtype, core_axes=1) for name, value in given.items()}
    for name, array in checked.items():
        check_last(name, array, 3)
    return checked["centers"], checked["half_axes_u"], checked["half_axes_v"]


def broadcast(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    distinct = {shape for shape in shapes.values() if shape}
    if len(distinct) <= 1:
        return next(iter(distinct), ())
    try:
        return np.broadcast_shapes(*distinct)
    except ValueError:
        described = " and ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"the leading axes of {described} do not broadcast") from None


def rows(array: Floats, shape: tuple[int, ...], *core: int) -> Floats:
    """The array as contiguous rows of the broadcast shape; copied only if it really has to be spread."""
    full = (*shape, *core)
    spread = array if array.shape == full else np.ascontiguousarray(np.broadcast_to(array, full))
    return spread.reshape(-1, *core)
