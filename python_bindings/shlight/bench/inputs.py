# SPDX-License-Identifier: MIT
"""Random lights and directions in float32, the same in every run, and the library's calls that take them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import shlight
from shlight import _core
from shlight._arrays import Floats
from shlight.charts.lights import CLASSES, Array, Lights, parallelograms

from .rounds import Work

SEED = 1
ROUGHNESS = 0.3  # of the surface under warped lobes
LAMBERT_COSINE = 0.6


def directions(count: int) -> Floats:
    """Unit vectors, uniform over the sphere."""
    vectors = np.random.default_rng(SEED).normal(size=(count, 3))
    return (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).astype(np.float32)


@dataclass(frozen=True)
class Spheres:
    centers: Floats
    radii: Floats

    def coefficients(self, order: int, *, method: str = "exact", threads: int = 1) -> Work:
        call = shlight.sphere_coefficients
        return Work(lambda: call(self.centers, self.radii, order, method=method, threads=threads), len(self.radii))

    def shaded(self, bsdf: _core.Bsdf, views: float | Floats, order: int, *, threads: int = 1) -> Work:
        call = shlight.shade_spheres
        return Work(lambda: call(self.centers, self.radii, bsdf, views, order=order, threads=threads), len(self.radii))

    def fused(self, order: int, *, threads: int = 1) -> Work:
        """Eq. 5 with every band, under a lobe without a warp."""
        call, terms = _core.contract_spheres, lobe_terms(order)
        return Work(lambda: call(self.centers, self.radii, terms, order, threads), len(self.radii))

    def lambert(self, order: int, *, threads: int = 1) -> Work:
        """Eq. 5 as far as the material has bands."""
        return self.shaded(shlight.Bsdf.lambert(1.0), LAMBERT_COSINE, order, threads=threads)

    def warped(self, order: int, *, shared_view: bool = False, threads: int = 1) -> Work:
        """Under a glossy lobe. The views, and with them the horizons' heights, differ from light to light."""
        views = 0.6 if shared_view else np.random.default_rng(SEED).uniform(0.05, 1, len(self.radii))
        return self.shaded(shlight.Bsdf.ggx(ROUGHNESS, 1.0), views, order, threads=threads)

    def first(self, count: int) -> Spheres:
        return Spheres(self.centers[:count], self.radii[:count])


@dataclass(frozen=True)
class Quads:
    vertices: Floats

    def coefficients(self, order: int, *, method: str = "exact", threads: int = 1) -> Work:
        call = shlight.polygon_coefficients
        return Work(lambda: call(self.vertices, order, method=method, threads=threads), len(self.vertices))

    def fused(self, order: int, *, threads: int = 1) -> Work:
        call, terms = _core.contract_polygons, lobe_terms(order)
        return Work(lambda: call(self.vertices, terms, order, threads), len(self.vertices))

    def lambert(self, order: int, *, threads: int = 1) -> Work:
        bsdf, call = shlight.Bsdf.lambert(1.0), shlight.shade_polygons
        return Work(lambda: call(self.vertices, bsdf, LAMBERT_COSINE, order=order, threads=threads), len(self.vertices))

    def first(self, count: int) -> Quads:
        return Quads(self.vertices[:count])


def spheres(kind: str, count: int) -> Spheres:
    """kind: "clipped" or "whole", all of them; "mixed": anywhere but below the horizon, a quarter of them clipped."""
    if kind == "mixed":
        quarter = count // 4
        parts = [spheres("clipped", quarter), spheres("whole", count - quarter)]
        order = np.random.default_rng(SEED).permutation(count)
        return Spheres(
            np.concatenate([part.centers for part in parts])[order],
            np.concatenate([part.radii for part in parts])[order],
        )
    lights = {light_class.name: light_class for light_class in CLASSES}[f"sphere_{kind}"].lights(SEED, count)
    return Spheres(*lights.in_type(np.float32).arrays)


def lobe_terms(order: int) -> Array:
    """Cosine terms of a lobe that has all of them."""
    return np.random.default_rng(SEED).normal(size=order * (order + 1) // 2).astype(np.float32)


def quads(count: int) -> Quads:
    """Parallelograms of half diagonals about 0.2 … 1 at distance 1, every other one cut by the horizon."""
    rng = np.random.default_rng(SEED)
    cut, above = (_drawn(rng, (count + odd) // 2, cut=cut) for odd, cut in ((1, True), (0, False)))
    vertices = np.empty((count, 4, 3), np.float32)
    vertices[0::2], vertices[1::2] = cut, above
    return Quads(vertices)


def _drawn(rng: np.random.Generator, count: int, *, cut: bool) -> Array:
    found = np.empty((0, 4, 3))
    while len(found) < count:
        size = rng.uniform(0.2, 1.0, count)
        lights: Lights = parallelograms(rng, rng.uniform(-0.5, 1.5, count) * size, size)
        vertices = lights.arrays[0]
        lowest, highest = vertices[..., 2].min(axis=1), vertices[..., 2].max(axis=1)
        found = np.concatenate([found, vertices[(lowest < 0) & (highest > 0) if cut else lowest >= 0]])
    return found[:count]
