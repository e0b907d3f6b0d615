# SPDX-License-Identifier: MIT
"""shade_spheres and shade_polygons: closed forms, and what must hold for any light."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lobe_cubature import view_direction
from shading_cases import cosines, random_light, random_quad
from strategies import Floats, polygons, reproducible, spheres

import shlight
from shlight import Bsdf

# --- closed forms -------------------------------------------------------------------------------------------------


def irradiance_over_pi(vertices: Floats) -> float:
    """Lambert's formula for a polygon above the horizon: Σ (edge angle) (edge pole)_z / 2π."""
    directions = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    poles = np.cross(directions, np.roll(directions, -1, axis=0))
    sines = np.linalg.norm(poles, axis=1)
    angles = np.arctan2(sines, (directions * np.roll(directions, -1, axis=0)).sum(axis=1))
    return abs(float((angles * poles[:, 2] / sines).sum())) / (2 * math.pi)


@reproducible
@given(spheres(), polygons(), cosines)
def test_lambert_surfaces_are_exact(sphere: tuple[Floats, float], vertices: Floats, cosine: float) -> None:
    center, radius = np.abs(sphere[0]), sphere[1]
    center[2] += radius
    distance = np.linalg.norm(center)
    computed = shlight.shade_spheres(center, radius, Bsdf.lambert([1, 0.5, 0]), cosine)
    expected = (radius / distance) ** 2 * center[2] / distance
    np.testing.assert_allclose(computed, [expected, 0.5 * expected, 0], rtol=2e-5)
    raised = vertices + np.array([0, 0, max(0.0, 0.01 - vertices[:, 2].min())])
    # float32 results; the formula itself loses digits where the polygon is small.
    assert shlight.shade_polygons(raised, Bsdf.lambert(1), cosine)[0] == pytest.approx(
        irradiance_over_pi(raised), rel=2e-5, abs=1e-7
    )


def mirror_fresnel(f0: float, cosine: float) -> float:
    return f0 + (1 - f0) * (1 - cosine) ** 5


@reproducible
@given(spheres(), st.floats(0, 1))
def test_mirrors_show_spheres(sphere: tuple[Floats, float], cosine: float) -> None:
    center, radius = sphere
    along = view_direction(cosine) * [-1, 1, 1] @ center
    if center[2] <= -radius or abs(along - math.sqrt(center @ center - radius**2)) <= 1e-9 * np.linalg.norm(center):
        return  # hidden, or too close to the edge to say
    seen = along > math.sqrt(center @ center - radius**2)
    computed, effort = shlight.shade_spheres(center, radius, Bsdf.ggx(0, 0.3), cosine, return_effort=True)
    np.testing.assert_allclose(computed, np.full(3, mirror_fresnel(0.3, cosine) if seen else 0), rtol=1e-6)
    assert effort == 0


def in_plane_polygon(vertices: Floats, direction: Floats) -> bool:
    """Whether the ray meets the polygon: crossings of edges in the plane."""
    normal = np.cross(vertices[1] - vertices[0], vertices[2] - vertices[0])
    distance = normal @ vertices[0] / (normal @ direction)
    if not distance > 0:
        return False
    axes = np.delete(np.arange(3), np.abs(normal).argmax())
    (x, y), corners = (distance * direction)[axes], vertices[:, axes]
    inside = False
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def test_mirrors_show_polygons() -> None:
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(400):
        cosine = rng.uniform(0, 1)
        mirrored = view_direction(cosine) * [-1, 1, 1]
        quad = rng.uniform(0.1, 4) * random_quad(rng, *random_light(rng, 1, rng.uniform(0, 0.5), cosine))
        if rng.random() < 0.5:  # not convex
            quad[2] = 0.25 * quad[2] + 0.75 * (quad[0] + quad[1] + quad[3]) / 3
        expected = mirror_fresnel(0.3, cosine) if in_plane_polygon(quad, mirrored) else 0
        np.testing.assert_allclose(
            shlight.shade_polygons(quad, Bsdf.ggx(0, 0.3), cosine), np.full(3, expected), rtol=1e-6
        )
        seen += expected > 0
    assert 50 < seen < 350


def test_narrow_lobes_tend_to_mirrors() -> None:
    mirrored = view_direction(0.6) * [-1, 1, 1]
    for roughness in (0.003, 0.0031, 0.01, 0.03):
        computed = shlight.shade_spheres(mirrored, 0.3, Bsdf.ggx(roughness, 0.4), 0.6)
        # Tails of the lobe: (α / ½ radius cosθ_o)².
        np.testing.assert_allclose(computed, np.full(3, mirror_fresnel(0.4, 0.6)), rtol=1.5e-3)


# --- what must hold for any light ---------------------------------------------------------------------------------


def test_extremes_are_finite() -> None:
    """Tiny, huge and touching lights, views along the normal and along the surface, roughness down to mirrors."""
    rng = np.random.default_rng(6)
    count = 400
    axes = rng.normal(size=(count, 3))
    axes[::5, 2] *= 1e-9
    axes[1::5, :2] *= 1e-9
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    distances = 10 ** rng.uniform(-6, 6, count)
    radii = distances * rng.choice([1e-9, 1e-4, 0.3, 1 - 1e-9, 1], count)
    quads = distances[:, None, None] * (
        axes[:, None] + 10 ** rng.uniform(-8, 5, (count, 1, 1)) * rng.normal(size=(count, 3, 3))
    )
    views = rng.choice([0, 1e-9, 1e-4, 0.02, 0.5, 1 - 1e-9, 1], count)
    for roughness in (0, 1e-3, 0.003, 0.0031, 0.01, 0.1, 0.5, 1):
        for f0, ior in ((1.0, None), (0.04, 1.5)):
            bsdf = Bsdf.ggx(roughness, f0, ior=ior)
            for tolerance in (1e-1, 1e-3, 1e-5):
                for radiance in (
                    shlight.shade_spheres(distances[:, None] * axes, radii, bsdf, views, tolerance=tolerance),
                    shlight.shade_polygons(quads, bsdf, views, tolerance=tolerance),
                ):
                    assert np.all(radiance >= 0)
                    assert np.all(radiance <= 1.02), roughness
