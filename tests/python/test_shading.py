# SPDX-License-Identifier: MIT
"""shade_spheres and shade_polygons: accuracy against dense cubature in numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from lobe_cubature import over_polygon, over_sphere
from shading_cases import MATERIALS, albedo, random_light, random_quad

import shlight
from shlight import Bsdf


@pytest.mark.parametrize("cosine", [0.1, 0.2, 0.4])
def test_a_smaller_tolerance_is_nearer_to_the_truth(cosine: float) -> None:
    """Tolerances are relative to the albedo: of a lobe that is dark but at grazing angles."""
    rng = np.random.default_rng(10)
    bsdf = Bsdf.ggx(0.4, 0)
    lights = [random_light(rng, k % 3, 0.16, cosine) for k in range(300)]
    centers, radii = np.array([axis for axis, _ in lights]), np.sin([half_angle for _, half_angle in lights])
    quads = np.array([random_quad(rng, *light) for light in lights])
    for shade in (
        lambda **options: shlight.shade_spheres(centers, radii, bsdf, cosine, **options),
        lambda **options: shlight.shade_polygons(quads, bsdf, cosine, **options),
    ):
        truth, mean = shade(method="quadrature", tolerance=1e-9), math.inf
        for tolerance in (1e-2, 1e-3, 1e-4, 1e-5):
            errors = np.abs(shade(tolerance=tolerance) - truth) / albedo(bsdf, cosine)
            assert np.quantile(errors, 0.99) <= 2 * tolerance
            assert errors.max() <= 10 * tolerance
            assert errors.mean() <= min(tolerance, max(mean / 2, 2**-24))  # half of float32's last place
            mean = errors.mean()


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_match_dense_cubature(name: str) -> None:
    """Colour, Fresnel curves, layers and sums, under a light of each kind."""
    rng = np.random.default_rng(3)
    bsdf = MATERIALS[name]
    for cosine in (0.2, 0.6, 1.0):
        scale = albedo(bsdf, cosine)
        for kind in range(3):
            axis, half_angle = random_light(rng, kind, 0.1, cosine)
            quad = random_quad(rng, axis, half_angle)
            sphere = shlight.shade_spheres(3 * axis, 3 * math.sin(half_angle), bsdf, cosine)
            expected = over_sphere(bsdf, cosine, 3 * axis, 3 * math.sin(half_angle))
            assert np.all(np.abs(sphere - expected) <= 2e-3 * scale)
            assert np.all(
                np.abs(shlight.shade_polygons(quad, bsdf, cosine) - over_polygon(bsdf, cosine, quad)) <= 2e-3 * scale
            )


@pytest.mark.parametrize("roughness", [0.05, 0.15, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("between", [0.8, 1.9, 2.7])
def test_curved_surfaces_have_no_seams(roughness: float, between: float) -> None:
    """A surface turns from the viewer to edge-on under a light that stays, at this angle from the viewer.

    The same at a much smaller tolerance is subtracted, because the edge of a highlight is steep itself.
    """
    turn = np.linspace(0, math.pi / 2, 1501)
    y = np.full_like(turn, 0.1)
    center = np.stack([np.sin(turn - between), y, np.cos(turn - between)], axis=-1)
    across = np.stack([np.cos(turn - between), 0 * y, -np.sin(turn - between)], axis=-1)
    quad = np.stack([center + 0.3 * (i * across + [0, j, 0]) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis=-2)
    bsdf, cosine = Bsdf.ggx(roughness, 1), np.maximum(0, np.cos(turn))
    for shade in (
        lambda tolerance: shlight.shade_spheres(center, 0.2, bsdf, cosine, tolerance=tolerance)[:, 0],
        lambda tolerance: shlight.shade_polygons(quad, bsdf, cosine, tolerance=tolerance)[:, 0],
    ):
        error = shade(1e-3) - shade(1e-5)
        assert np.abs(error).max() <= 3e-3
        assert np.abs(np.diff(error)).max() <= 2e-3
