# SPDX-License-Identifier: MIT
"""What a material reflects of a light, by dense cubature of Bsdf.evaluate: shares nothing else with the library.

Good to about 1e-5 of the brightest light for roughness ≥ 0.2 and cosθ_o ≥ 0.1. Product Gauss rules, split where the
lobe has its peak, because they crowd at the ends of an interval.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from strategies import Floats

from shlight import Bsdf

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
FINE_NODES, FINE_WEIGHTS = np.polynomial.legendre.leggauss(128)


def view_direction(cosine: float) -> Floats:
    return np.array([math.sqrt((1 - cosine) * (1 + cosine)), 0, cosine])


def reflected(bsdf: Bsdf, cosine: float, directions: Floats, weights: Floats) -> Floats:
    """Σ weights · f·cos, as RGB."""
    values = bsdf.evaluate(directions, view_direction(cosine))
    if values.ndim < directions.ndim:  # a grey material
        values = values[..., None]
    return np.broadcast_to(np.tensordot(weights, values, weights.ndim), 3)


def over_sphere(bsdf: Bsdf, cosine: float, center: Floats, radius: float) -> Floats:
    """Over the part of a sphere above the horizon, in circles of latitude."""
    axis = center / np.linalg.norm(center)
    sine = radius / float(np.linalg.norm(center))
    half_angle = math.asin(min(1.0, sine))
    tilt = math.atan2(math.hypot(axis[0], axis[1]), axis[2])
    azimuth = math.atan2(axis[1], axis[0])
    first, last = max(0.0, tilt - half_angle), min(math.pi / 2, tilt + half_angle)
    if first >= last:
        return np.zeros(3)
    # Circles are whole up to half_angle - tilt; the arcs of others begin like square roots.
    breaks = sorted({first, last, *(b for b in (half_angle - tilt, math.acos(cosine)) if first < b < last)})
    total = np.zeros(3)
    for a, b in pairwise(breaks):
        t = math.pi / 2 * (NODES + 1)
        colatitude = a + (b - a) * (1 - np.cos(t)) / 2
        steps = (b - a) / 2 * np.sin(t) * math.pi / 2 * WEIGHTS * np.sin(colatitude)
        for angle, step in zip(colatitude, steps, strict=True):
            total += step * circle(bsdf, cosine, angle, azimuth, arc(angle, tilt, half_angle))
    return total


def arc(colatitude: float, tilt: float, half_angle: float) -> float:
    """Half the azimuth that a circle of latitude has in common with the cap."""
    gap = math.cos(half_angle) - math.cos(colatitude) * math.cos(tilt)
    width = math.sin(colatitude) * math.sin(tilt)
    return math.pi if gap <= -width else 0.0 if gap >= width else math.acos(gap / width)


def circle(bsdf: Bsdf, cosine: float, colatitude: float, azimuth: float, half: float) -> Floats:
    """∫ f·cos dφ within ±half of an azimuth."""
    start, end = azimuth - half, azimuth + half
    breaks = sorted({start, end, *(b for k in range(-3, 4) if start < (b := k * math.pi / 2) < end)})
    middles = np.add(breaks[1:], breaks[:-1])[:, None] / 2
    halves = np.diff(breaks)[:, None] / 2
    phi = (middles + halves * NODES).ravel()
    z, r = math.cos(colatitude), math.sin(colatitude)
    points = np.stack([r * np.cos(phi), r * np.sin(phi), np.full_like(phi, z)], axis=-1)
    return reflected(bsdf, cosine, points, (halves * WEIGHTS).ravel())


def over_polygon(bsdf: Bsdf, cosine: float, vertices: Floats) -> Floats:
    """Over the part of a convex polygon above the horizon, in triangles with a corner at the brightest point."""
    kept: list[Floats] = []
    for a, b in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if a[2] >= 0:
            kept.append(a)
        if (a[2] >= 0) != (b[2] >= 0):
            kept.append(a + a[2] / (a[2] - b[2]) * (b - a))
    if len(kept) < 3:
        return np.zeros(3)
    inside = np.mean(kept, axis=0)
    peak = nearest_to_mirror(np.array(kept), inside, cosine)
    total = np.zeros(3)
    for a, b in zip(kept, [*kept[1:], kept[0]], strict=True):
        total += over_triangle(bsdf, cosine, np.array([peak, a, b]))
    return total


def nearest_to_mirror(kept: Floats, inside: Floats, cosine: float) -> Floats:
    """The point that the mirror direction shows, or of many within the polygon the one closest to it."""
    mirrored = view_direction(cosine) * [-1, 1, 1]
    edges = np.concatenate(
        [a + np.linspace(0, 1, 65)[:, None] * (b - a) for a, b in zip(kept, np.roll(kept, -1, 0), strict=True)]
    )
    points = (inside + np.linspace(0, 1, 65)[:, None, None] * (edges - inside)).reshape(-1, 3)
    return np.asarray(points[(points @ mirrored / np.linalg.norm(points, axis=1)).argmax()])


def over_triangle(bsdf: Bsdf, cosine: float, corners: Floats) -> Floats:
    """Duffy's map: points crowd at the first corner, twice over."""
    a, b, c = corners
    s = (FINE_NODES[:, None] + 1) / 2
    u, t = s**2, (FINE_NODES[None, :] + 1) / 2
    points = a + u[..., None] * ((1 - t)[..., None] * (b - a) + t[..., None] * (c - a))
    distance = np.linalg.norm(points, axis=-1)
    jacobian = abs(np.linalg.det(corners)) * u * 2 * s
    weights = FINE_WEIGHTS[:, None] * FINE_WEIGHTS[None, :] / 4 * jacobian / distance**3
    return reflected(bsdf, cosine, points / distance[..., None], weights)
