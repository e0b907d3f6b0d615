# SPDX-License-Identifier: MIT
"""Materials and random lights for the tests of shading."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st
from lobe_cubature import view_direction
from strategies import Floats

import shlight
from shlight import Bsdf

cosines = st.floats(0.05, 1)
roughnesses = st.floats(0.05, 1)

MATERIALS = {
    "metal": Bsdf.ggx(0.3, [0.9, 0.5, 0.1]),
    "rough metal": Bsdf.ggx(0.7, 1.0),
    "dielectric": Bsdf.ggx(0.25, 0.04, ior=1.5),
    "edge only": Bsdf.ggx(0.4, 0.0),
    "plastic": Bsdf.layer(Bsdf.ggx(0.2, 0.04, ior=1.45), Bsdf.lambert([0.1, 0.5, 0.8])),
    "mixture": 0.4 * Bsdf.lambert(0.9) + Bsdf.ggx(0.35, [1, 0.2, 0.0]) * [0.5, 0.5, 1],
}


def albedo(bsdf: Bsdf, cosine: float) -> Floats:
    """Radiance under a sky of one, which a sphere in contact above is, by harmonics: exact."""
    return shlight.shade_spheres([0, 0, 1], 1, bsdf, cosine, tolerance=1e-4).astype(np.float64)


def random_light(rng: np.random.Generator, kind: int, alpha: float, cosine: float) -> tuple[Floats, float]:
    """Direction and half angle: across the horizon, about the mirror direction, or anywhere above."""
    half_angle = rng.uniform(0.01, 1.4) if rng.random() < 0.5 else math.exp(rng.uniform(math.log(0.01), math.log(1.4)))
    axis = rng.normal(size=3)
    if kind == 0:
        axis[2] = math.tan(rng.uniform(-half_angle, half_angle)) * math.hypot(*axis[:2])
    elif kind == 1:
        spread = 0.5 * (half_angle + 2 * alpha) * axis
        axis = view_direction(cosine) * [-1, 1, 1] + spread
    if kind > 0:
        axis[2] = abs(axis[2])
    return axis / np.linalg.norm(axis), half_angle


def random_quad(rng: np.random.Generator, axis: Floats, half_angle: float) -> Floats:
    normal = axis + 0.4 * rng.normal(size=3) / math.sqrt(3)
    u = np.cross(normal, rng.normal(size=3))
    u /= np.linalg.norm(u)
    v = np.cross(normal / np.linalg.norm(normal), u)
    angles = np.pi / 2 * (np.arange(4) + rng.uniform(0, 0.6, 4))[:, None]
    return np.asarray(axis + math.tan(min(half_angle, 1.2)) * (np.cos(angles) * u + np.sin(angles) * v))
