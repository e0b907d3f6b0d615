# SPDX-License-Identifier: MIT
"""What docs/theory.md, 6, says of warped lobes, written down once more in numpy: the warp, and brute force.

The formulas are those of core/src/warp.cpp in their plainest form, without care for rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import shlight
from shlight_tools.charts import lobes
from shlight_tools.charts.lobes import view_direction

Array = NDArray[Any]


class Warp(lobes.Warp):
    """The warp of a GGX lobe of width alpha seen under the cosine cos_o, and what it does to directions and caps."""

    def warped(self, directions: Array) -> Array:
        d = directions @ self.to_boost.T
        along = d[..., 2:]
        u = np.concatenate([d[..., :2] / self.gamma, along - self.b], axis=-1) / (1 - self.b * along)
        return u @ self.to_warped.T

    def cap(self, axis: Array, half_angle: float) -> tuple[Array, float]:
        """The image of a cap: unit axis and half angle."""
        d = self.to_boost @ axis
        c = np.cos(half_angle)
        image = np.array([d[0], d[1], self.gamma * (d[2] - self.b * c)])
        length = np.linalg.norm(image)
        # sinσ' = sinσ / length, and no arc cosine of a number near one.
        half = np.arctan2(np.sin(half_angle) / length, self.gamma * (c - self.b * d[2]) / length)
        return self.to_warped @ image / length, float(half)


def frame_about(axis: Array) -> tuple[Array, Array]:
    side = np.cross(axis, [0.0, 0, 1] if abs(axis[2]) < 0.9 else [1.0, 0, 0])
    side = side / np.linalg.norm(side)
    return side, np.cross(axis, side)


def circle(axis: Array, half_angle: float, points: int = 400) -> Array:
    u, v = frame_about(axis)
    phi = np.linspace(0, 2 * np.pi, points)[:, None]
    return np.cos(half_angle) * axis + np.sin(half_angle) * (np.cos(phi) * u + np.sin(phi) * v)


def brute_force(bsdf: shlight.Bsdf, warp: Warp, cos_o: float, axis: Array, half_angle: float, points: int) -> float:
    """∫ f·cos over a cap, above the horizon: points × 2 points, spread evenly over its image in the lobe's warp."""
    center, half = warp.cap(axis, half_angle)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    u, v = frame_about(center)
    phi = 2 * np.pi * (np.arange(2 * points) + 0.5) / (2 * points)
    theta = half * (1 + nodes[:, None]) / 2
    ring = np.cos(phi)[:, None] * u + np.sin(phi)[:, None] * v
    at = np.cos(theta)[..., None] * center + np.sin(theta)[..., None] * ring[None]
    values: Any = bsdf.evaluate(warp.direction(at), view_direction(cos_o)) * warp.density(at)
    around = values.sum(axis=1) * np.pi / points
    return float((around * np.sin(theta[:, 0]) * weights).sum() * half / 2)


def random_lights(rng: np.random.Generator, alpha: float, cos_o: float, count: int) -> tuple[Array, Array]:
    """Axes and half angles 0.01 … 1.4: a third cut by the horizon, a third about the mirror direction."""
    half = np.where(rng.random(count) < 0.5, rng.uniform(0.01, 1.4, count), 0.01 * 140 ** rng.random(count))
    axes = rng.normal(size=(count, 3))
    kind = np.arange(count) % 3
    height = np.sin(rng.uniform(-1, 1, count) * half)  # of those that the horizon cuts
    azimuth = np.where(rng.random(count) < 0.5, np.pi + rng.uniform(-0.6, 0.6, count), rng.uniform(0, 2 * np.pi, count))
    flat = np.sqrt(1 - height**2)
    cut = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), height], axis=-1)
    near = view_direction(cos_o) * [-1, 1, 1] + 0.4 * (half + 2 * alpha)[:, None] * axes
    axes[:, 2] = abs(axes[:, 2])
    near[:, 2] = abs(near[:, 2])
    axes = np.where((kind == 0)[:, None], cut, np.where((kind == 1)[:, None], near, axes))
    return axes / np.linalg.norm(axes, axis=-1, keepdims=True), half
