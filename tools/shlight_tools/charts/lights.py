# SPDX-License-Identifier: MIT
"""The classes of lights that the figures measure.

All numbers are float32 numbers, held in float64: both precisions are given the very same lights, and the truth is
computed from exactly those.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import DTypeLike, NDArray

Array = NDArray[Any]
Kind = Literal["sphere", "polygon"]


@dataclass(frozen=True)
class Lights:
    """Sphere lights (centres, radii) or polygons (vertices), in the shading frame; clipped at the horizon."""

    kind: Kind
    arrays: tuple[Array, ...]

    def __len__(self) -> int:
        return len(self.arrays[0])

    def take(self, which: Any) -> Lights:
        """Some of the lights: a slice, indices or a mask."""
        return Lights(self.kind, tuple(np.ascontiguousarray(array[which]) for array in self.arrays))

    def repeated(self, count: int) -> Lights:
        """`count` lights: these, over and over."""
        return self.take(np.arange(count) % len(self))

    def in_type(self, dtype: DTypeLike) -> Lights:
        """The same lights, held in this type."""
        return Lights(self.kind, tuple(array.astype(dtype) for array in self.arrays))


def spheres(elevation: Array, half_angle: Array | float, azimuth: Array | float = 0.0) -> Lights:
    """Sphere lights at distance 1. elevation: of the centre above the horizon."""
    el, half, around = np.broadcast_arrays(elevation, half_angle, azimuth)
    centers = np.stack([np.cos(el) * np.cos(around), np.cos(el) * np.sin(around), np.sin(el)], axis=-1)
    return Lights("sphere", (_rounded(centers), _rounded(np.sin(half))))


def squares(elevation: Array, half_angle: Array | float, azimuth: Array | float = 0.0) -> Lights:
    """Squares at distance 1 that face the shading point, two edges level; the middles of the edges are seen at
    `half_angle` from the centre."""
    el, half, around = np.broadcast_arrays(elevation, half_angle, azimuth)
    # Distance and height of the lower and of the upper edge, without a difference that cancels at the horizon.
    out, up = (np.stack([f(el - half), f(el + half)], axis=-1) / np.cos(half)[..., None] for f in (np.cos, np.sin))
    toward = np.stack([np.cos(around), np.sin(around)], axis=-1)
    level = np.tan(half)[..., None] * np.stack([-np.sin(around), np.cos(around)], axis=-1)
    middles = out[..., None] * toward[..., None, :]
    # Fixed-point x and y keep the level edges parallel and the corners coplanar, also in float32.
    step = _grid(np.abs(middles).max(axis=(-1, -2)) + np.abs(level).max(axis=-1))[..., None]
    across = step * np.round(level / step)
    lower, upper = (step * np.round(middles[..., i, :] / step) for i in (0, 1))
    corners = [
        np.concatenate([flat, up[..., i : i + 1]], axis=-1)
        for flat, i in ((lower - across, 0), (lower + across, 0), (upper + across, 1), (upper - across, 1))
    ]
    return Lights("polygon", (_rounded(np.stack(corners, axis=-2)),))


def _grid(largest: Array) -> Array:
    """The step of fixed-point numbers up to `largest` that float32 holds."""
    step: Array = 2.0 ** (np.ceil(np.log2(largest)) - 24)
    return step


def _rounded(values: Array) -> Array:
    return values.astype(np.float32).astype(np.float64)


@dataclass(frozen=True)
class LightClass:
    """Random lights of one sort."""

    name: str
    title: str
    kind: Kind
    draw: Callable[[np.random.Generator, int], Lights]

    def lights(self, seed: int, count: int) -> Lights:
        return self.draw(np.random.default_rng(seed), count)


def _whole(rng: np.random.Generator, count: int) -> Lights:
    half = rng.uniform(0.2, 1.0, count)
    return spheres(half + rng.uniform(0.05, 1, count) * (np.pi / 2 - half), half, _around(rng, count))


def _clipped(rng: np.random.Generator, count: int) -> Lights:
    half = rng.uniform(0.2, 1.0, count)
    return spheres(rng.uniform(-0.8, 0.95, count) * half, half, _around(rng, count))


def _small(rng: np.random.Generator, count: int) -> Lights:
    half = _log_uniform(rng, 1e-3, 3e-2, count)
    return spheres(rng.uniform(0.05, np.pi / 2, count), half, _around(rng, count))


def _polygon_clipped(rng: np.random.Generator, count: int) -> Lights:
    size = rng.uniform(0.2, 1.0, count)
    return parallelograms(rng, rng.uniform(-0.3, 0.5, count) * size, size)


def _polygon_small(rng: np.random.Generator, count: int) -> Lights:
    return parallelograms(rng, rng.uniform(0.1, np.pi / 2, count), _log_uniform(rng, 1e-3, 3e-2, count))


def parallelograms(rng: np.random.Generator, elevation: Array, size: Array) -> Lights:
    """Parallelograms about a centre at distance 1: half diagonals of 0.8 … 1.2 times `size`, tilt up to 0.7 rad."""
    count = len(size)
    center = spheres(elevation, size, _around(rng, count)).arrays[0]
    tilt = rng.uniform(-1, 1, (count, 3)) * np.tan(0.7) / np.sqrt(3)
    normal = _unit(center + tilt - center * np.sum(tilt * center, axis=-1, keepdims=True))
    u = _unit(np.cross(normal, rng.normal(size=(count, 3))))
    v = np.cross(normal, u)
    skew = np.pi / 2 + rng.uniform(-0.5, 0.5, (count, 1))
    reach = size[:, None] * rng.uniform(0.8, 1.2, (count, 2))
    # In fixed point their sums are exact, and the corners in one plane, in float32 too.
    step = _grid(np.full((count, 1), 4.0))
    middle, first, second = (
        step * np.round(part / step)
        for part in (center, reach[:, :1] * u, reach[:, 1:] * (np.cos(skew) * u + np.sin(skew) * v))
    )
    corners = [middle + first, middle + second, middle - first, middle - second]
    return Lights("polygon", (_rounded(np.stack(corners, axis=1)),))


def _around(rng: np.random.Generator, count: int) -> Array:
    return rng.uniform(0, 2 * np.pi, count)


def _log_uniform(rng: np.random.Generator, low: float, high: float, count: int) -> Array:
    return low * (high / low) ** rng.random(count)


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


CLASSES = [
    LightClass("sphere_whole", "spheres above the horizon, half angle 0.2 … 1 rad", "sphere", _whole),
    LightClass("sphere_clipped", "spheres cut by the horizon, half angle 0.2 … 1 rad", "sphere", _clipped),
    LightClass("sphere_small", "small spheres, half angle 0.001 … 0.03 rad", "sphere", _small),
    LightClass("polygon_clipped", "parallelograms at the horizon, half diagonal 0.2 … 1", "polygon", _polygon_clipped),
    LightClass("polygon_small", "small parallelograms, half diagonal 0.001 … 0.03", "polygon", _polygon_small),
]
