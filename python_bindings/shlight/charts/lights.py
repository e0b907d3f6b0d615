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

import shlight

Array = NDArray[Any]
Kind = Literal["sphere", "polygon"]


@dataclass(frozen=True)
class Lights:
    """Sphere lights (centres, radii) or polygons (vertices), in the shading frame; clipped at the horizon."""

    kind: Kind
    arrays: tuple[Array, ...]

    def __len__(self) -> int:
        return len(self.arrays[0])

    def coefficients(
        self, method: str, order: int, dtype: DTypeLike, *, threads: int = 1, **options: Any
    ) -> NDArray[Any]:
        function = shlight.sphere_coefficients if self.kind == "sphere" else shlight.polygon_coefficients
        given = [np.asarray(array, dtype=dtype) for array in self.arrays]
        call: Callable[..., Any] = function
        return call(*given, order=order, method=method, dtype=dtype, threads=threads, **options)

    def take(self, which: Any) -> Lights:
        """Some of the lights: a slice, indices or a mask."""
        return Lights(self.kind, tuple(np.ascontiguousarray(array[which]) for array in self.arrays))

    def repeated(self, count: int) -> Lights:
        """`count` lights: these, over and over."""
        return self.take(np.arange(count) % len(self))

    def in_type(self, dtype: DTypeLike) -> Lights:
        """The same lights, held in this type."""
        return Lights(self.kind, tuple(array.astype(dtype) for array in self.arrays))


def spheres(elevation: Array, half_angle: Array, azimuth: Array | float = 0.0) -> Lights:
    """Sphere lights at distance 1. elevation: of the centre above the horizon."""
    up, flat, around = np.broadcast_arrays(np.sin(elevation), np.cos(elevation), azimuth)
    centers = np.stack([flat * np.cos(around), flat * np.sin(around), up], axis=-1)
    return Lights("sphere", (_rounded(centers), _rounded(np.sin(half_angle))))


def squares(elevation: Array, half_angle: Array, azimuth: Array | float = 0.0) -> Lights:
    """Squares at distance 1 that face the shading point, two edges level; the middles of the edges are seen at
    `half_angle` from the centre."""
    el, half, around = np.broadcast_arrays(elevation, half_angle, azimuth)
    corners = []
    for side, top in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        # Height and distance of an edge, without a difference that cancels where it is level with the horizon.
        up, out = np.sin(el + top * half) / np.cos(half), np.cos(el + top * half) / np.cos(half)
        across = side * np.tan(half)
        corner = [out * np.cos(around) - across * np.sin(around), out * np.sin(around) + across * np.cos(around), up]
        corners.append(np.stack(corner, axis=-1))
    return Lights("polygon", (_rounded(np.stack(corners, axis=-2)),))


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
    return _quads(rng, rng.uniform(-0.5, 0.5, count) * size, size)


def _polygon_small(rng: np.random.Generator, count: int) -> Lights:
    return _quads(rng, rng.uniform(0.1, np.pi / 2, count), _log_uniform(rng, 1e-3, 3e-2, count))


def _quads(rng: np.random.Generator, elevation: Array, size: Array) -> Lights:
    """Quadrangles about a centre at distance 1, corners at 0.7 … 1.3 times `size` from it, tilted by up to 1 rad."""
    count = len(size)
    center = spheres(elevation, size, _around(rng, count)).arrays[0]
    tilt = rng.uniform(-1, 1, (count, 3)) * np.tan(1.0) / np.sqrt(3)
    normal = _unit(center + tilt - center * np.sum(tilt * center, axis=-1, keepdims=True))
    u = _unit(np.cross(normal, rng.normal(size=(count, 3))))
    v = np.cross(normal, u)
    angle = np.pi / 2 * (np.arange(4) + rng.uniform(-0.3, 0.3, (count, 4)))
    reach = size[:, None] * rng.uniform(0.7, 1.3, (count, 4))
    across, along = (reach * np.cos(angle))[..., None], (reach * np.sin(angle))[..., None]
    return Lights("polygon", (_rounded(center[:, None] + across * u[:, None] + along * v[:, None]),))


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
    LightClass("polygon_clipped", "quadrangles at the horizon, half size 0.2 … 1", "polygon", _polygon_clipped),
    LightClass("polygon_small", "small quadrangles, half size 0.001 … 0.03", "polygon", _polygon_small),
]
