# SPDX-License-Identifier: MIT
"""Sheen of fabrics: Blender's Sheen BSDF.

Its lobes are tables, made for the roughness that is asked for. One that varies is interpolated between lobes of a few.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from shlight import _core, _tables
from shlight.nodes import energy
from shlight.nodes.inputs import normal, towards_viewer
from shlight.nodes.shader import Lobe, Shader
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    dot,
    maximum,
    minimum,
    normalize,
    number,
    vector,
)

Doubles = NDArray[np.float64]

# Roughnesses between which a varying one is interpolated, of microfibres and of velvet.
MICROFIBRE_NODES = (0.04, 0.08, 0.13, 0.2, 0.28, 0.38, 0.5, 0.65, 0.8, 1.0)
VELVET_NODES = (0.01, 0.1, 0.2, 0.3, 0.4, 0.55, 0.75, 1.0)
# Entries of a table of microfibres: heights of the light, views in each step of Cycles' table, and azimuths.
HEIGHTS, SUBVIEWS, AZIMUTHS = 96, 3, 33
# Widths of the ring above the horizon that a table resolves.
NARROWEST, WIDEST = 0.02, 1.0
LEAST_TRANSFORM = 1e-5
LEAST_COSINE = 1e-3  # of the view


def microfibre(tint: Varying, roughness: Number, *, at: Vector | None = None) -> Shader:
    """Sheen of short fibres: Blender's Sheen BSDF with distribution Microfiber, a linearly transformed cosine.

    Zeltner, Burley & Chiang 2022, "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines". roughness:
    clamped to 0 … 1. Raises ValueError naming an argument that is not finite.
    """
    r = clamp(number(roughness, "roughness"))
    n = _normal(at)
    own = color(_not_negative(tint) * microfibre_albedo(r, n))
    # Fibres on a smooth outline whose normal leans away from the viewer look as those that stand at right angles to it.
    below = maximum(LEAST_COSINE - dot(towards_viewer(), n), 0.0)
    return _interpolated(own, r, MICROFIBRE_NODES, _microfibre_lobe, normalize(n + towards_viewer() * below))


def microfibre_albedo(roughness: Value, at: Vector) -> Value:
    """The share of light from all around that fibres reflect towards the viewer."""
    return energy.sheen(roughness, clamp(dot(towards_viewer(), at)))


def velvet(tint: Varying, sigma: Number, *, at: Vector | None = None) -> Shader:
    """Velvet: Blender's Sheen BSDF with distribution Ashikhmin, and Velvet BSDF before Blender 4.

    Ashikhmin, Premože & Shirley 2000, "A Microfacet-based BRDF Generator". sigma: 0 … 1, clamped. Raises ValueError
    naming an argument that is not finite.
    """
    width = clamp(number(sigma, "sigma"))
    return _interpolated(_not_negative(tint), width, VELVET_NODES, _velvet_lobe, None if at is None else _normal(at))


def _not_negative(tint: Varying) -> Color:
    return Color(*(maximum(component, 0.0) for component in color(tint, "tint")))


def _normal(at: Vector | None) -> Vector:
    return normal() if at is None else vector(at, "at")


def _interpolated(
    weight: Color, parameter: Value, nodes: tuple[float, ...], lobe: Callable[[float], _core.Bsdf], at: Vector | None
) -> Shader:
    """The lobe of a constant parameter, or those of the nodes, by their distance."""
    if parameter.constant is not None:
        return Shader((Lobe(lobe(parameter.constant), weight, normal=at),))
    lobes = []
    for i, node in enumerate(nodes):
        share: Value = number(1.0)
        if i > 0:
            share = minimum(share, (parameter - nodes[i - 1]) / (node - nodes[i - 1]))
        if i + 1 < len(nodes):
            share = minimum(share, (nodes[i + 1] - parameter) / (nodes[i + 1] - node))
        lobes.append(Lobe(lobe(node), color(weight * clamp(share)), normal=at))
    return Shader(tuple(lobes))


@lru_cache(maxsize=64)
def _microfibre_lobe(roughness: float) -> _core.Bsdf:
    """One lobe of albedo 1: the cosine over π after ω → (a x + b z, a y, z), without the cosine of the light."""
    steps = SUBVIEWS * (len(energy.SHEEN_STEPS) - 1) + 1
    views = np.linspace(0.0, 1.0, steps)
    a, b = (energy.sheen_transform(name, roughness, views) for name in ("a", "b"))
    ring = float(np.clip(np.mean(a, where=a > LEAST_TRANSFORM), NARROWEST, WIDEST))
    height = ring * np.sinh(np.linspace(math.asinh(math.pi / 2 / ring), 0.0, HEIGHTS))
    height[0] = math.pi / 2
    z, s = np.sin(height)[:, None, None], np.cos(height)[:, None, None]
    phi = np.linspace(0.0, math.pi, AZIMUTHS)
    a, b = (t[::-1][None, :, None] for t in (a, b))
    square = (a * s) ** 2 + 2.0 * a * b * s * z * np.cos(phi) + (b * b + 1.0) * z**2
    seen = a > LEAST_TRANSFORM
    f = np.where(seen, (a / np.where(seen, square, 1.0)) ** 2 / math.pi, 0.0)
    return _tables.from_table(f[:, None], math.pi / 2 - height, [0.0], np.arccos(views[::-1]), phi)


@lru_cache(maxsize=64)
def _velvet_lobe(sigma: float) -> _core.Bsdf:
    width = max(sigma, 0.01)

    def f(view: Doubles, light: Doubles) -> Doubles:
        total = view + light
        square = np.einsum("ij,ij->i", total, total)
        up2 = np.minimum(total[:, 2] ** 2 / square, 1.0 - 1e-5)
        across2 = 1.0 - up2
        d = np.exp(-up2 / across2 / width**2) / (math.pi * width**2 * across2**2)
        cosine = np.maximum(np.sqrt(square) / 2.0, 1e-5)  # ω_i·h
        ratio = np.maximum(np.sqrt(up2) / cosine, 1e-5)
        shadow = np.minimum(1.0, 2.0 * ratio * np.minimum(view[:, 2], light[:, 2]))
        return np.asarray(d * shadow / (4.0 * view[:, 2] * light[:, 2]))

    return _tables.from_function(f)
