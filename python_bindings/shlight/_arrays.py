# SPDX-License-Identifier: MIT
"""Arguments of batch functions: checked, converted and broadcast, with errors that name them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from shlight._core import checked_flag, checked_integer, checked_number, converted_array

__all__ = ["checked_flag", "checked_integer", "checked_number"]

Floats = NDArray[Any]

MAX_ORDER = 64

# Arguments of batch functions, and how many of their last axes belong to one light.
CORE_AXES = {
    "directions": 1,
    "coefficients": 1,
    "centers": 1,
    "radii": 0,
    "axes": 1,
    "half_angles": 0,
    "vertices": 2,
    "bsdf": 0,
    "half_axes_u": 1,
    "half_axes_v": 1,
    "light": 1,
    "material": 1,
    "cos_theta_o": 0,
    "phi_o": 0,
    "eye": 1,
    "target": 1,
    "up": 1,
}

_TYPES = (np.dtype(np.float32), np.dtype(np.float64))


def shaped(flat: Floats, shape: tuple[int, ...]) -> Floats:
    """Results without axes are numpy scalars, as numpy's own functions return them."""
    return flat.reshape(shape)[()]


def checked_order(order: Any) -> int:
    return checked_integer("order", order, 1, MAX_ORDER)


def checked_threads(threads: Any) -> int:
    return checked_integer("threads", threads, 0, 2**31 - 1)


def checked_callable(name: str, value: Any) -> Any:
    if not callable(value):
        raise TypeError(f"{name} must be callable, got {type(value).__name__}")
    return value


def checked_tolerance(tolerance: Any) -> float:
    checked = checked_number("tolerance", tolerance)
    if not (math.isfinite(checked) and checked > 0):
        raise ValueError(f"tolerance must be positive and finite, got {checked}")
    return checked


def checked_name(name: str, value: Any, known: Iterable[str]) -> str:
    """One of some names."""
    if not isinstance(value, str) or value not in known:
        got = repr(value) if isinstance(value, str) else type(value).__name__
        raise ValueError(f"{name} must be one of {', '.join(map(repr, known))}, got {got}")
    return value


def given_type(*arrays: ArrayLike) -> type[np.floating[Any]]:
    """The type of results: float32 for arrays that are, float64 for all else. Python's own numbers decide nothing."""
    deciding = [own for own in arrays if type(own) not in (int, float)]
    return np.float32 if deciding and all(_is_single(own) for own in deciding) else np.float64


def _is_single(value: Any) -> bool:
    if not isinstance(value, np.ndarray | np.generic) and hasattr(value, "__dlpack__"):
        try:
            value = np.from_dlpack(value)
        except Exception:  # the conversion says what is wrong, and of which argument
            return False
    return getattr(getattr(value, "dtype", None), "type", None) is np.float32  # of either byte order


def wanted_type(dtype: DTypeLike | None, *arrays: ArrayLike) -> DTypeLike:
    """The type that the caller names, or that of the arrays."""
    return given_type(*arrays) if dtype is None else dtype


def checked_array(name: str, value: ArrayLike, dtype: DTypeLike, *, core_axes: int = 0) -> Floats:
    wanted = _checked_type(dtype)
    if type(value) is np.ndarray and value.dtype == wanted and value.flags.c_contiguous:
        array: Floats = value  # finding out with numpy that nothing is to be done takes as long as a hundred lights
    else:
        array = converted_array(name, value, wanted == np.float32)
    if array.ndim < core_axes:
        raise ValueError(f"{name} must have at least {core_axes} axes, got shape {array.shape}")
    return array


def _checked_type(dtype: DTypeLike) -> np.dtype[Any]:
    if dtype is np.float32 or dtype is np.float64:  # what follows takes as long as a hundred lights, too
        return _TYPES[dtype is np.float64]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy takes classes of types with a warning
            wanted = np.dtype(dtype)
    except (TypeError, ValueError, Warning):
        raise ValueError(f"dtype must be float32 or float64, got {type(dtype).__name__}") from None
    if wanted not in _TYPES:
        raise ValueError(f"dtype must be float32 or float64, got {wanted}")
    return wanted


def check_last(name: str, array: Floats, size: int) -> None:
    if array.shape[-1] != size:
        raise ValueError(f"{name} must have shape (..., {size}), got {array.shape}")


def checked_vectors(dtype: DTypeLike, **given: ArrayLike) -> tuple[dict[str, Floats], dict[str, tuple[int, ...]]]:
    """Arrays of numbers (...), vectors (..., 3) and polygons (..., k, 3) by CORE_AXES, and their leading axes."""
    arrays = {name: checked_array(name, value, dtype, core_axes=CORE_AXES[name]) for name, value in given.items()}
    for name, array in arrays.items():
        if CORE_AXES[name] > 0:
            check_last(name, array, 3)
        if CORE_AXES[name] == 2 and array.shape[-2] < 3:
            raise ValueError(f"{name}: a polygon needs at least 3, got {array.shape[-2]}")
    return arrays, {name: array.shape[: array.ndim - CORE_AXES[name]] for name, array in arrays.items()}


def check_rows(name: str, good: NDArray[np.bool_] | np.bool_, wrong: str) -> None:
    """Raises ValueError naming the argument and the first row that is not good, and what is wrong with it."""
    if not good.all():
        row = np.unravel_index(int(np.argmin(good)), good.shape)
        raise ValueError(f"{name}{list(map(int, row)) if row else ''} {wrong}")


def check_finite(name: str, array: Floats, core_axes: int = 0) -> None:
    check_rows(name, np.isfinite(array).all(axis=tuple(range(-core_axes, 0))), "must be finite")


def broadcast(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    distinct = {shape for shape in shapes.values() if shape}
    if len(distinct) <= 1:
        return next(iter(distinct), ())
    try:
        return np.broadcast_shapes(*distinct)
    except ValueError:
        described = " and ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"{described}: these leading axes do not broadcast") from None


def rows(array: Floats, shape: tuple[int, ...], *core: int) -> Floats:
    """The array as contiguous rows of the broadcast shape; copied only if it really has to be spread."""
    full = (*shape, *core)
    spread = array if array.shape == full else np.broadcast_to(array, full)
    return np.ascontiguousarray(spread).reshape(-1, *core)


def all_rows(arrays: Mapping[str, Floats], shape: tuple[int, ...]) -> list[Floats]:
    """The `rows` of arrays of `checked_vectors`."""
    return [rows(array, shape, *array.shape[array.ndim - CORE_AXES[name] :]) for name, array in arrays.items()]
