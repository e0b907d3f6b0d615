# SPDX-License-Identifier: MIT
"""Random lights and directions in float32, the same in every run, as the package's functions take them."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from shlight._arrays import Floats
from shlight_tools.charts.lights import CLASSES, Array, parallelograms

SEED = 1


class Spheres(NamedTuple):
    centers: Floats
    radii: Floats


@cache
def directions(count: int) -> Floats:
    """Unit vectors, uniform over the sphere."""
    vectors = np.random.default_rng(SEED).normal(size=(count, 3))
    return (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).astype(np.float32)


@cache
def views(count: int) -> Floats:
    """Cosines, which differ from light to light as those of a picture's hits do."""
    return np.random.default_rng(SEED).uniform(0.05, 1, count)


@cache
def spheres(kind: str, count: int) -> Spheres:
    """kind: "clipped" or "whole", all of them; "mixed": anywhere but below the horizon, a quarter of them clipped."""
    if kind == "mixed":
        quarter = count // 4
        parts = spheres("clipped", quarter), spheres("whole", count - quarter)
        order = np.random.default_rng(SEED).permutation(count)
        return Spheres(*(np.concatenate(arrays)[order] for arrays in zip(*parts, strict=True)))
    lights = next(light_class for light_class in CLASSES if light_class.name == f"sphere_{kind}").lights(SEED, count)
    return Spheres(*lights.in_type(np.float32).arrays)


@cache
def quads(count: int) -> Floats:
    """Parallelograms of half diagonals about 0.2 … 1 at distance 1, every other one cut by the horizon."""
    rng = np.random.default_rng(SEED)
    vertices = np.empty((count, 4, 3), np.float32)
    vertices[0::2] = _parallelograms(rng, (count + 1) // 2, cut=True)
    vertices[1::2] = _parallelograms(rng, count // 2, cut=False)
    return vertices


@cache
def disks(count: int) -> tuple[Floats, Floats, Floats]:
    """Centres and half axes of the ellipses through the corners of these quads."""
    vertices = quads(count)
    center = vertices.mean(axis=1)
    return center, vertices[:, 0] - center, vertices[:, 1] - center


def _parallelograms(rng: np.random.Generator, count: int, *, cut: bool) -> Array:
    found = np.empty((0, 4, 3))
    while len(found) < count:
        size = rng.uniform(0.2, 1.0, count)
        vertices = parallelograms(rng, rng.uniform(-0.5, 1.5, count) * size, size).arrays[0]
        lowest, highest = vertices[..., 2].min(axis=1), vertices[..., 2].max(axis=1)
        found = np.concatenate([found, vertices[(lowest < 0) & (highest > 0) if cut else lowest >= 0]])
    return found[:count]
