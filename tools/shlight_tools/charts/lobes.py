# SPDX-License-Identifier: MIT
"""Lobes f·cos of materials, and how well harmonics of each order describe them, in numpy and float64.

Shares nothing with the library's own fits but Bsdf.evaluate and sh_basis, so it applies to any material that is a
function. Directions are in the shading frame, the view is ω_o = (sinθ_o, 0, cosθ_o), and lobes are symmetric about the
plane y = 0: only cosine terms of the harmonics are left. docs/theory.md, 6.1, derives the warp.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import shlight
from shlight._arrays import MAX_ORDER, Floats

# Ridge terms of the library's fits, which bound an expansion outside of the fitted region.
HEMISPHERE_RIDGE = 1e-7
WARPED_RIDGE = 1e-6
CHUNK = 2048


def view_direction(cos_o: float) -> Floats:
    return np.array([math.sqrt((1 - cos_o) * (1 + cos_o)), 0.0, cos_o])


@dataclass(frozen=True)
class Lobe:
    """A material. value(ω, cosθ_o): f·cos of directions (..., 3) above the horizon."""

    name: str
    value: Callable[[Floats, float], Floats]
    bsdf: shlight.Bsdf | None = None  # where the library knows the material
    alpha: float | None = None  # width of a GGX lobe; None: no warp makes the lobe broader


def lambert() -> Lobe:
    return Lobe("Lambert", lambda directions, _: directions[..., 2] / math.pi, shlight.Bsdf.lambert(1.0))


def oren_nayar(sigma: float) -> Lobe:
    """Rough clay: Oren & Nayar 1994, their qualitative model, slopes of standard deviation sigma [rad], albedo 1."""

    def value(directions: Floats, cos_o: float) -> Floats:
        s2 = sigma**2
        a, b = 1 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09)
        cos_i = np.clip(directions[..., 2], 0, 1)
        sin_o = math.sqrt((1 - cos_o) * (1 + cos_o))
        # cos(φ_i - φ_o) sinθ_i sinθ_o = x sinθ_o, and sin·tan of the larger and the smaller angle divides by a cosine.
        towards = np.maximum(0, directions[..., 0]) * sin_o / np.maximum(cos_i, cos_o)
        return cos_i / math.pi * (a + b * towards)

    return Lobe(f"Oren–Nayar, σ = {math.degrees(sigma):.0f}°", value)


def ggx(roughness: float) -> Lobe:
    bsdf = shlight.Bsdf.ggx(roughness, 1.0)
    return Lobe(
        f"GGX, roughness {roughness:g}",
        lambda directions, cos_o: bsdf.evaluate(directions, view_direction(cos_o)),
        bsdf,
        roughness**2,
    )


class Warp:
    """The boost that broadens a GGX lobe of width alpha seen under cos_o: u ↔ ω, the mirror direction in the middle.

    The formulas of core/src/warp.cpp in their plainest form, without care for rounding. alpha None: no warp, u = ω.
    """

    def __init__(self, alpha: float | None, cos_o: float) -> None:
        self.b, self.gamma, self.horizon_height = 0.0, 1.0, 0.0
        self.to_boost = self.to_warped = np.eye(3)
        if alpha is None:
            return
        width = 5 * alpha * cos_o**0.4
        r = 1 - width / (1 + width**1.5) ** (2 / 3)
        self.b = 2 * r / (1 + r * r)
        self.gamma = 1 / math.sqrt((1 - self.b) * (1 + self.b))
        sin_o = math.sqrt((1 - cos_o) * (1 + cos_o))
        self.to_boost = np.array([[cos_o, 0, sin_o], [0, 1, 0], [-sin_o, 0, cos_o]])
        length = math.hypot(sin_o, self.gamma * cos_o)
        self.horizon_height = -self.gamma * self.b * cos_o / length
        x, z = sin_o / length, self.gamma * cos_o / length
        self.to_warped = np.array([[z, 0, -x], [0, 1, 0], [x, 0, z]])

    def direction(self, warped: Floats) -> Floats:
        u = warped @ self.to_warped
        along = u[..., 2:]
        d = np.concatenate([u[..., :2] / self.gamma, along + self.b], axis=-1) / (1 + self.b * along)
        return d @ self.to_boost

    def density(self, warped: Floats) -> Floats:
        """dω/du."""
        along = (warped @ self.to_warped)[..., 2]
        return 1 / (self.gamma * (1 + self.b * along)) ** 2


@dataclass(frozen=True)
class Grid:
    """Points over the upper hemisphere, evenly spread over its image in a lobe's warp; half of it, y > 0."""

    heights: Floats  # (k,) u_z
    height_weights: Floats
    azimuths: Floats  # (j,)
    warped: Floats  # (k, j, 3)
    weights: Floats  # (k, j) of du, for both halves together

    @classmethod
    def over(cls, warp: Warp, points: int) -> Grid:
        nodes, weights = np.polynomial.legendre.leggauss(points)
        half = (1 - warp.horizon_height) / 2
        heights = warp.horizon_height + half * (1 + nodes)
        azimuths = math.pi * (np.arange(points) + 0.5) / points
        sine = np.sqrt((1 - heights) * (1 + heights))[:, None]
        warped = np.stack(
            [sine * np.cos(azimuths), sine * np.sin(azimuths), np.broadcast_to(heights[:, None], (points, points))],
            axis=-1,
        )
        height_weights = half * weights
        return cls(
            heights, height_weights, azimuths, warped, np.outer(height_weights, np.full(points, 2 * math.pi / points))
        )


def zonal_rows(heights: Floats, m: int) -> Floats:
    """(k, 64 - m): the harmonics l = m … 63 of degree m ≥ 0 at azimuth 0."""
    directions = np.stack([np.sqrt((1 - heights) * (1 + heights)), np.zeros_like(heights), heights], axis=-1)
    return shlight.sh_basis(directions, MAX_ORDER, np.float64)[:, cosine_columns(m)]


def cosine_columns(m: int) -> Floats:
    degrees = np.arange(m, MAX_ORDER)
    return degrees * degrees + degrees + m


@functools.cache
def hemisphere_gram(m: int) -> Floats:
    """∫ Y_lm Y_km over the upper hemisphere: Gauss' rule is exact for these polynomials."""
    nodes, weights = np.polynomial.legendre.leggauss(MAX_ORDER)
    rows = zonal_rows((1 + nodes) / 2, m)
    return rows.T @ (rows * (weights / 2)[:, None]) * _turn(m)


def _turn(m: int) -> float:
    """∫ cos² mφ dφ."""
    return 2 * math.pi if m == 0 else math.pi


@dataclass(frozen=True)
class Residuals:
    """Relative L2 errors of f·cos over the hemisphere, one for each order."""

    projection: Floats
    hemisphere: Floats
    warped: Floats | None  # None: no warp makes the lobe broader


def residuals(lobe: Lobe, cos_o: float, orders: Sequence[int], points: int) -> Residuals:
    """points: of the grid, in each of its two directions. Of the fit over the hemisphere the library's own number,
    where it knows the material."""
    warp = Warp(lobe.alpha, cos_o)
    grid = Grid.over(warp, points)
    directions, density = warp.direction(grid.warped), warp.density(grid.warped)
    values = lobe.value(directions, cos_o)
    projection, hemisphere = plain_residuals(directions, values, grid.weights * density, orders)
    if lobe.bsdf is not None:
        hemisphere = np.array([float(lobe.bsdf.residual(cos_o, order)) for order in orders])
    warped = None if lobe.alpha is None else _warped(grid, values, density, orders)
    return Residuals(projection, hemisphere, warped)


def plain_residuals(
    directions: Floats, values: Floats, weights: Floats, orders: Sequence[int]
) -> tuple[Floats, Floats]:
    """Fits without a warp: the projection of f·cos with zeros below the horizon, and the best fit above it."""
    d, f, w = directions.reshape(-1, 3), values.ravel(), weights.ravel()
    columns = np.concatenate([cosine_columns(m) for m in range(MAX_ORDER)])
    starts = range(0, len(f), CHUNK)

    def basis(start: int) -> Floats:
        return shlight.sh_basis(d[start : start + CHUNK], MAX_ORDER, np.float64)[:, columns]

    moments = np.zeros(len(columns))
    for start in starts:
        part = slice(start, start + CHUNK)
        moments += (w[part] * f[part]) @ basis(start)
    fits = np.zeros((len(columns), 2 * len(orders)))
    first = 0
    for m in range(MAX_ORDER):
        gram, size = hemisphere_gram(m), MAX_ORDER - m
        for k, order in enumerate(orders):
            count = max(0, order - m)
            at = slice(first, first + count)
            ridged = gram[:count, :count] + HEMISPHERE_RIDGE * np.eye(count)
            fits[at, k] = moments[at]
            fits[at, len(orders) + k] = np.linalg.solve(ridged, moments[at])
        first += size
    squares = np.zeros(2 * len(orders))
    for start in starts:
        part = slice(start, start + CHUNK)
        squares += w[part] @ (basis(start) @ fits - f[part, None]) ** 2
    errors = np.sqrt(squares / (w @ f**2))
    return errors[: len(orders)], errors[len(orders) :]


def _warped(grid: Grid, values: Floats, density: Floats, orders: Sequence[int]) -> Floats:
    """The best fit of f·cos · dω/du over the warped hemisphere, uniform in u; its error is that of f·cos over ω."""
    lobe = values * density
    fitted = np.zeros((len(orders), *lobe.shape))
    for m in range(max(orders)):
        rows = zonal_rows(grid.heights, m)
        around = np.cos(m * grid.azimuths)
        weighted = rows * grid.height_weights[:, None]
        gram = weighted.T @ rows * _turn(m)
        moments = weighted.T @ (lobe @ around) * (2 * math.pi / len(around))
        for k, order in enumerate(orders):
            count = order - m
            if count > 0:
                ridged = gram[:count, :count] + WARPED_RIDGE * np.eye(count)
                fit = np.linalg.solve(ridged, moments[:count])
                fitted[k] += np.outer(rows[:, :count] @ fit, around)
    squares = ((fitted - lobe) ** 2 / density * grid.weights).sum(axis=(1, 2))
    return np.sqrt(squares / (grid.weights * density * values**2).sum())
