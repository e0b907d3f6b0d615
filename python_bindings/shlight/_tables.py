# SPDX-License-Identifier: MIT
"""Materials of one's own: functions that are sampled, tables, and files of measured BRDFs."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight import _core
from shlight._arrays import checked_array, checked_callable, checked_flag, checked_integer, checked_order
from shlight.images import checked_path

Doubles = NDArray[np.float64]
Order = int | Literal["auto"]
Function = Callable[[Doubles, Doubles], ArrayLike]

_RIGHT = math.pi / 2
_TURN = 2 * math.pi
_LARGEST = 1e10

# Steps of a right angle, and the directions of one call of a function.
_SAMPLES = {True: 64, False: 20}
_ROWS = 1 << 18
# Cosine of directions that stand for those below the horizon.
_LEAST_COSINE = 1e-3
# Values of an isotropic function that should be equal differ by less than these shares, of them and of the largest.
_SAME, _SAME_OF_LARGEST = 1e-3, 1e-6
_ERROR_VIEWS, _ERROR_POINTS, _ERROR_AZIMUTHS = 17, 48, 8

_UTIA_THETAS, _UTIA_PHIS = 6, 48
_MERL_SHAPE = (90, 90, 180)
_MERL_SCALES = np.array([1.0, 1.15, 1.66]) / 1500


def from_function(
    f: Function, *, isotropic: bool = True, order: Order = "auto", samples: int | None = None
) -> _core.Bsdf:
    checked_callable("f", f)
    is_isotropic, only = checked_flag("isotropic", isotropic), _only_order(order)
    steps = _SAMPLES[is_isotropic] if samples is None else checked_integer("samples", samples, 8, 128)
    if is_isotropic:
        _check_isotropy(f)
    theta_h = _RIGHT * np.linspace(0, 1, 2 * steps) ** 2  # dense where peaks are
    phi_h = np.linspace(0, _TURN, 1 if is_isotropic else 3 * steps, endpoint=False)
    theta_d = np.linspace(0, _RIGHT, steps)
    phi_d = np.linspace(0, _TURN, (2 if is_isotropic else 3) * steps, endpoint=False)
    axes = [theta_h, phi_h, theta_d, phi_d]
    parts = []
    shape = tuple(len(axis) for axis in axes)
    total = math.prod(shape)
    for first in range(0, total, _ROWS):
        index = np.unravel_index(np.arange(first, min(first + _ROWS, total)), shape)
        view, light = _directions(*(axis[i] for axis, i in zip(axes, index, strict=True)))
        parts.append((_called(f, view, light) * (view + light)[:, 2:]).astype(np.float32))
    if len({part.shape[1] for part in parts}) != 1:
        raise ValueError("f must return one number, or RGB, for every row")
    table = _table(True, axes, np.concatenate(parts).reshape(*shape, -1), [0, _TURN, 0, _TURN])
    return table.with_sampling_errors(_sampling_errors(f, table, is_isotropic)).bsdf(only)


def from_table(
    values: ArrayLike,
    theta_in: ArrayLike,
    phi_in: ArrayLike,
    theta_out: ArrayLike,
    phi_out: ArrayLike,
    *,
    order: Order = "auto",
) -> _core.Bsdf:
    only = _only_order(order)
    given = {"theta_in": theta_in, "phi_in": phi_in, "theta_out": theta_out, "phi_out": phi_out}
    axes = [_checked_angles(name, angles) for name, angles in given.items()]
    table = _checked_values(values, tuple(len(axis) for axis in axes))
    return _from_angles(table, *axes).bsdf(only)


def read(path: str | os.PathLike[str], *, order: Order = "auto") -> _core.Bsdf:
    only = _only_order(order)
    file = checked_path(path)
    size = file.stat().st_size
    utia = 3 * (_UTIA_THETAS * _UTIA_PHIS) ** 2 * 8
    merl = 12 + 3 * math.prod(_MERL_SHAPE) * 8
    if size == utia:
        return _read_utia(file).bsdf(only)
    if size == merl:
        return _read_merl(file).bsdf(only)
    raise ValueError(
        f"path {str(path)!r} has {size} bytes, but UTIA's .bin files have {utia} and MERL's .binary files {merl}"
    )


def _only_order(order: Order) -> int:
    return 0 if isinstance(order, str) and order == "auto" else checked_order(order)


def _table(half_vector: bool, axes: list[Doubles], values: NDArray[Any], periods: list[float]) -> _core.LobeTable:
    listed = [(axis.tolist(), period) for axis, period in zip(axes, periods, strict=True)]
    entries = np.ascontiguousarray(values, np.float32).reshape(-1)
    return _core.lobe_table(half_vector, listed, values.shape[-1], entries, [])


def _directions(theta_h: Doubles, phi_h: Doubles, theta_d: Doubles, phi_d: Doubles) -> tuple[Doubles, Doubles]:
    """View and light of half vectors (n,) and of the light beside them, with those below the horizon lifted to it."""
    half = _direction(theta_h, phi_h)
    along = _direction(theta_h + _RIGHT, phi_h)
    beside = _direction(np.full_like(phi_h, _RIGHT), phi_h + _RIGHT)
    away = np.cos(phi_d)[:, None] * along + np.sin(phi_d)[:, None] * beside
    middle, aside = np.cos(theta_d)[:, None] * half, np.sin(theta_d)[:, None] * away
    return _lifted(middle - aside), _lifted(middle + aside)


def _direction(theta: Doubles, phi: Doubles) -> Doubles:
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def _lifted(directions: Doubles) -> Doubles:
    z = np.maximum(directions[:, 2], _LEAST_COSINE)
    across = np.hypot(directions[:, 0], directions[:, 1])
    scale = np.sqrt(1 - np.minimum(z, 1) ** 2) / np.where(across > 0, across, 1)
    lifted = np.stack([directions[:, 0] * scale, directions[:, 1] * scale, np.minimum(z, 1)], axis=-1)
    return np.where(directions[:, 2:] < _LEAST_COSINE, lifted, directions)


def _called(f: Function, view: Doubles, light: Doubles) -> Doubles:
    """The values of a function, as (n, 1) or (n, 3)."""
    try:
        result = checked_array("f", np.asarray(f(view.copy(), light.copy())), np.float64)
    except (TypeError, ValueError) as error:
        if str(error).startswith("f "):
            raise ValueError(f"f must return real numbers: {error}") from None
        raise
    count = len(view)
    if result.shape not in ((count,), (count, 3)):
        raise ValueError(f"f must return an array ({count},) or ({count}, 3) for {count} rows, got {result.shape}")
    if not (np.isfinite(result).all() and result.min() >= 0 and result.max() <= _LARGEST):
        bad = np.argmax(~(np.isfinite(result) & (result >= 0) & (result <= _LARGEST)).reshape(count, -1).all(axis=1))
        raise ValueError(
            f"f must return numbers in 0 … 1e10, got {result[bad]} for view {view[bad]} and light {light[bad]}"
        )
    return result.reshape(count, -1)


def _check_isotropy(f: Function) -> None:
    rng = np.random.default_rng(0)
    count = 512
    view, light = (_direction(np.arccos(rng.uniform(0.05, 1, count)), rng.uniform(0, _TURN, count)) for _ in range(2))
    turn = rng.uniform(0, _TURN, count)
    turned = [_turned(direction, turn) for direction in (view, light)]
    mirrored = [direction * [1, -1, 1] for direction in (view, light)]
    values = _called(f, view, light)
    for how, others in (("turned about the normal", turned), ("mirrored", mirrored)):
        same = _called(f, *others)
        if (
            same.shape != values.shape
            or (np.abs(values - same) > _SAME * np.maximum(values, same) + _SAME_OF_LARGEST * values.max()).any()
        ):
            raise ValueError(f"f must return the same for directions that are {how}, or pass isotropic=False")


def _turned(directions: Doubles, angles: ArrayLike) -> Doubles:
    c, s = np.cos(angles), np.sin(angles)
    x, y, z = directions.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def _sampling_errors(f: Function, table: _core.LobeTable, isotropic: bool) -> list[float]:
    """The numbers that LobeTable::sampling_error interpolates: the largest over azimuths of the view."""
    nodes, weights = np.polynomial.legendre.leggauss(_ERROR_POINTS)
    theta = (nodes + 1) * (_RIGHT / 2)
    phi = (np.arange(2 * _ERROR_POINTS) + 0.5) * (math.pi / _ERROR_POINTS)
    light = _direction(np.repeat(theta, len(phi)), np.tile(phi, len(theta)))
    weight = np.repeat(weights * np.sin(theta) * np.cos(theta) ** 2, len(phi))[:, None]
    errors: list[float] = []
    for theta_o in np.linspace(0, _RIGHT, _ERROR_VIEWS):
        of_azimuths = []
        for phi_o in np.arange(1 if isotropic else _ERROR_AZIMUTHS) * (math.pi / _ERROR_AZIMUTHS):
            angle = min(theta_o, math.acos(_LEAST_COSINE))
            view = np.broadcast_to(_direction(np.array(angle), np.array(phi_o)), light.shape).copy()
            truth = _called(f, view, light)
            square = (weight * (table.values(light, view) - truth) ** 2).sum(axis=0)
            norm = (weight * truth**2).sum(axis=0)
            of_azimuths.append(np.sqrt(square / np.where(norm > 0, norm, 1)))
        errors.extend(np.max(of_azimuths, axis=0).tolist())
    return errors


def _checked_angles(name: str, angles: ArrayLike) -> Doubles:
    array = checked_array(name, angles, np.float64)
    if array.ndim != 1 or len(array) == 0:
        raise ValueError(f"{name} must have shape (n,) with n ≥ 1, got {array.shape}")
    if not (np.isfinite(array).all() and (np.diff(array) > 0).all()):
        raise ValueError(f"{name} must be finite and increasing")
    if name.startswith("theta") and not (array[0] >= 0 and array[-1] <= _RIGHT + 1e-6):
        raise ValueError(f"{name} must lie in [0, π/2]")
    if name.startswith("phi") and not array[-1] - array[0] <= _TURN + 1e-6:
        raise ValueError(f"{name} must span one turn at most")
    return array


def _checked_values(values: ArrayLike, shape: tuple[int, ...]) -> Doubles:
    table = checked_array("values", values, np.float64)
    if table.shape not in (shape, (*shape, 3)):
        raise ValueError(f"values must have shape {shape} of the angles, or {(*shape, 3)}, got {table.shape}")
    if not (np.isfinite(table).all() and table.min() >= 0 and table.max() <= _LARGEST):
        raise ValueError("values must lie in [0, 1e10]")
    return table.reshape(*shape, -1)


def _from_angles(
    values: Doubles, theta_in: Doubles, phi_in: Doubles, theta_out: Doubles, phi_out: Doubles
) -> _core.LobeTable:
    if len(phi_in) == 1 and len(phi_out) > 1 and abs(phi_out[0]) < 1e-6 and abs(phi_out[-1] - math.pi) < 1e-6:
        phi_out = np.concatenate([phi_out, _TURN - phi_out[-2:0:-1]])
        values = np.concatenate([values, values[..., -2:0:-1, :]], axis=3)
    values, theta_in = _to_horizon(values, theta_in, 0)
    values, phi_in = _without_repeat("phi_in", values, phi_in, 1)
    values, theta_out = _to_horizon(values, theta_out, 2)
    values, phi_out = _without_repeat("phi_out", values, phi_out, 3)
    return _table(False, [theta_in, phi_in, theta_out, phi_out], values, [0, _TURN, 0, _TURN])


def _to_horizon(values: Doubles, theta: Doubles, axis: int) -> tuple[Doubles, Doubles]:
    if len(theta) == 1 or theta[-1] > _RIGHT - 1e-6:
        return values, theta
    last, before = values.take(-1, axis), values.take(-2, axis)
    share = (_RIGHT - theta[-1]) / (theta[-1] - theta[-2])
    beyond = np.maximum(last + share * (last - before), 0)
    return np.concatenate([values, np.expand_dims(beyond, axis)], axis=axis), np.append(theta, _RIGHT)


def _without_repeat(name: str, values: Doubles, phi: Doubles, axis: int) -> tuple[Doubles, Doubles]:
    if len(phi) == 1 or phi[-1] - phi[0] < _TURN - 1e-6:
        return values, phi
    if not np.allclose(values.take(0, axis), values.take(-1, axis), rtol=1e-3, atol=1e-6 * values.max()):
        raise ValueError(f"{name} has the same direction first and last, but values differ there")
    return values.take(np.arange(len(phi) - 1), axis), phi[:-1]


def _numbers(file: Path, offset: int) -> Doubles:
    numbers = np.fromfile(file, "<f8", offset=offset)
    if not np.isfinite(numbers).all() or np.abs(numbers).max() > _LARGEST:
        raise ValueError(f"path {str(file)!r} contains numbers that are not finite, or beyond 1e10")
    return numbers


def _read_utia(file: Path) -> _core.LobeTable:
    shape = (3, _UTIA_THETAS, _UTIA_PHIS, _UTIA_THETAS, _UTIA_PHIS)
    values = np.moveaxis(_numbers(file, 0).reshape(shape), 0, -1)
    if values.min() < 0:
        raise ValueError(f"path {str(file)!r} contains negative numbers, which no BRDF of UTIA has")
    theta, phi = np.radians(15.0 * np.arange(_UTIA_THETAS)), np.radians(7.5 * np.arange(_UTIA_PHIS))
    return _from_angles(values, theta, phi, theta, phi)


def _read_merl(file: Path) -> _core.LobeTable:
    sizes = tuple(int(n) for n in np.fromfile(file, "<i4", count=3))
    if sizes != _MERL_SHAPE:
        raise ValueError(f"path {str(file)!r} begins with {sizes}, but MERL's files with {_MERL_SHAPE}")
    values = np.moveaxis(_numbers(file, 12).reshape(3, *_MERL_SHAPE), 0, -1)
    for axis in (1, 0):
        values = _filled(values, axis)
    values = np.maximum(values, 0) * _MERL_SCALES
    values = (values + values[:, :, -np.arange(_MERL_SHAPE[2])]) / 2
    theta_h = _RIGHT * (np.arange(_MERL_SHAPE[0]) / _MERL_SHAPE[0]) ** 2
    theta_d = np.radians(np.arange(_MERL_SHAPE[1]))
    phi_d = np.radians(np.arange(_MERL_SHAPE[2]))
    values *= 2 * (np.cos(theta_h)[:, None] * np.cos(theta_d))[:, :, None, None]  # cosθ_i + cosθ_o
    axes = [theta_h, np.zeros(1), theta_d, phi_d]
    return _table(True, axes, values[:, None], [0, _TURN, 0, math.pi])


def _filled(values: Doubles, axis: int) -> Doubles:
    """Negative entries replaced by the last one before them along an axis that is not."""
    count = values.shape[axis]
    steps = np.arange(count).reshape([-1 if i == axis else 1 for i in range(values.ndim)])
    last = np.maximum.accumulate(np.where(values >= 0, steps, 0), axis=axis)
    return np.take_along_axis(values, last, axis)
