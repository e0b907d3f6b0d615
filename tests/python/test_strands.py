# SPDX-License-Identifier: MIT
"""Curves and point clouds against spheres, cylinders and splines that are known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, SQUARE

import shlight
from shlight import nodes

Floats = NDArray[np.float64]
ALBEDO, IRRADIANCE = 0.6, 2.0
SUN = np.array([0.48, 0.36, 0.8])  # towards it
TURN = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])
SCALE, PLACE = 2.0, np.array([0.3, -0.2, 0.5])
TO_WORLD = np.eye(4)
TO_WORLD[:3, :3], TO_WORLD[:3, 3] = SCALE * TURN, PLACE
FAR_AWAY = np.eye(4)
FAR_AWAY[:3, 3] = 100.0
# A curve stands where it is, or is moved there as one of one or of two instances.
PLACES: dict[str, Any] = {"none": None, "one": [TO_WORLD], "two": [TO_WORLD, FAR_AWAY]}


def sunny() -> shlight.Scene:
    scene = shlight.Scene()
    scene.add_sun_light(-SUN, 0.0, IRRADIANCE)
    return scene


def lit(normals: Floats) -> Floats:
    """The radiance of a diffuse surface under the sun."""
    reflected: Floats = ALBEDO / math.pi * IRRADIANCE * np.maximum(normals @ SUN, 0.0)
    return reflected


def rays(rng: np.random.Generator, count: int, spread: float) -> tuple[Floats, Floats]:
    """Rays from around a sphere of radius 5 to places around the origin."""
    origins = rng.normal(size=(count, 3))
    origins *= 5.0 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = rng.uniform(-spread, spread, (count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def on_sphere(origins: Floats, directions: Floats, radius: float) -> tuple[Floats, Floats]:
    """Distances of a sphere around the origin, inf where it is missed, and how near to its edge rays come."""
    along = -(origins * directions).sum(-1)
    square = along**2 - (origins**2).sum(-1) + radius**2
    return np.where(square > 0, along - np.sqrt(np.maximum(square, 0)), np.inf), square


@pytest.mark.parametrize("place", PLACES)
def test_points_are_spheres(place: str) -> None:
    scene, radius = sunny(), 0.7
    transforms = PLACES[place]
    size = 1.0 if transforms is None else SCALE
    middle = np.zeros(3) if transforms is None else PLACE
    scene.add_point_cloud(
        [[0, 0, 0], [0, 0, 40]], [radius, 0.2], bsdf=shlight.Bsdf.lambert(ALBEDO), transforms=transforms
    )
    origins, directions = rays(np.random.default_rng(2), 4000, 2.0)
    distance, square = on_sphere(origins - middle, directions, size * radius)
    clear = np.abs(square) > 1e-3
    hits = scene.intersect(origins, directions)
    met = hits.valid
    assert 500 < np.count_nonzero(met) < 3500
    np.testing.assert_array_equal(met[clear], np.isfinite(distance)[clear])
    met &= clear
    normals = (origins + distance[:, None] * directions - middle)[met] / (size * radius)
    np.testing.assert_allclose(hits.distance[met], distance[met], rtol=0, atol=1e-3)
    np.testing.assert_allclose(hits.normal[met], normals, rtol=0, atol=1e-3)
    np.testing.assert_array_equal(hits.triangle[met], 0)
    seen = scene.radiance(origins[met], directions[met])[:, 0]
    np.testing.assert_allclose(seen, lit(normals), rtol=0, atol=1e-3)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("ribbons", [False, True])
def test_a_straight_curve_is_a_cylinder(ribbons: bool, place: str) -> None:
    """A ribbon has a cylinder's shadows and normals, too, if rays come from the side."""
    scene, radius, axis = sunny(), 0.05, np.array([0.0, 0.0, 1.0])
    transforms = PLACES[place]
    size, middle = 1.0, np.zeros(3)
    if transforms is not None:
        size, middle, axis = SCALE, PLACE, TURN @ axis
    points = np.outer(np.linspace(-3, 3, 5), [0, 0, 1])
    scene.add_curves(points, radius, [0], ribbons=ribbons, bsdf=shlight.Bsdf.lambert(ALBEDO), transforms=transforms)
    origins, directions = rays(np.random.default_rng(3), 40000, 0.4)
    origins += middle
    side = np.cross(directions, axis)
    across = np.linalg.norm(side, axis=1)
    offset = ((origins - middle) * side).sum(-1) / across / (size * radius)
    straight = across > 0.6
    hits = scene.intersect(origins, directions)
    clear = straight & (np.abs(np.abs(offset) - 1) > 2e-3)
    met = hits.valid & clear
    assert np.count_nonzero(met) > 2000
    np.testing.assert_array_equal(hits.valid[clear], (np.abs(offset) < 1)[clear])
    # The normal at right angles to the axis, on the side of the ray's origin.
    back = -directions - np.outer(-(directions @ axis), axis)
    back /= np.linalg.norm(back, axis=1, keepdims=True)
    sine = offset[met][:, None]
    normals = sine * (side / across[:, None])[met] + np.sqrt(1 - sine**2) * back[met]
    steep = np.sqrt(1 - sine[:, 0] ** 2)
    np.testing.assert_allclose(steep[:, None] * hits.normal[met], steep[:, None] * normals, rtol=0, atol=2e-3)
    seen = scene.radiance(origins[met], directions[met])[:, 0]
    np.testing.assert_allclose(steep * seen, steep * lit(normals), rtol=0, atol=2e-3)
    heights = (hits.position[met] - middle) @ axis
    from_axis = np.linalg.norm(hits.position[met] - middle - np.outer(heights, axis), axis=1)
    distance = size * radius * (np.abs(sine[:, 0]) if ribbons else 1.0)
    np.testing.assert_allclose(from_axis, distance, rtol=0, atol=1e-4)


@pytest.mark.parametrize("ribbons", [False, True])
def test_curves_are_splines_through_their_points_and_throw_shadows(ribbons: bool) -> None:
    """The shadow of a bent hair on a floor below, and what is read along it."""
    points = np.array([[-1.0, 0, 1], [-0.2, 0.5, 1], [0.5, 0.3, 1], [1.0, -0.6, 1]])
    other = points[:2] + np.array([0, 30, 0])
    radii = np.array([0.02, 0.08, 0.05, 0.01])
    scene = shlight.Scene()
    scene.add_sun_light([0, 0, -1], 0.0, IRRADIANCE)
    scene.add_mesh(2 * SQUARE, FACES, bsdf=shlight.Bsdf.lambert(ALBEDO))
    glow = nodes.emission(nodes.attribute("along") + 10 * nodes.attribute("own"))
    scene.add_curves(
        np.concatenate([other, points]),
        np.concatenate([radii[:2], radii]),
        [0, 2],
        ribbons=ribbons,
        subdivisions=16,
        bsdf=glow,
        attributes={"along": [7.0, 7, 0, 1, 2, 3], "own": [4.0, 5.0]},
    )
    # The uniform spline of Catmull and Rom, whose ends are double.
    ends = np.concatenate([points[:1], points, points[-1:]])
    wide = np.concatenate([radii[:1], radii, radii[-1:]])
    u = np.linspace(0, 1, 401)[:-1]
    basis = 0.5 * np.array([-(u**3) + 2 * u**2 - u, 3 * u**3 - 5 * u**2 + 2, -3 * u**3 + 4 * u**2 + u, u**3 - u**2])
    middles = np.concatenate([basis.T @ ends[i : i + 4] for i in range(3)])
    widths = np.concatenate([basis.T @ wide[i : i + 4] for i in range(3)])
    along = np.concatenate([i + u for i in range(3)])

    x, y = np.random.default_rng(4).uniform(-1.2, 1.2, (2, 3000))
    gap = np.hypot(x[:, None] - middles[:, 0], y[:, None] - middles[:, 1]) - widths
    nearest = gap.argmin(axis=1)
    inside, clear = gap.min(axis=1) < 0, np.abs(gap.min(axis=1)) > 4e-3
    clear &= (nearest > 8) & (nearest < len(middles) - 8)  # the ends are round or flat
    floor = np.stack([x, y, np.zeros_like(x)], axis=1)[clear]
    seen = scene.radiance(floor + np.array([0, 0, 0.5]), [0, 0, -1.0])[:, 0]
    lit_floor = ALBEDO / math.pi * IRRADIANCE
    np.testing.assert_allclose(seen, np.where(inside[clear], 0, lit_floor), rtol=0, atol=1e-5)
    assert np.count_nonzero(inside[clear]) > 100
    deep = clear & inside
    seen = scene.radiance(np.stack([x, y, np.full_like(x, 3.0)], axis=1)[deep], [0, 0, -1.0])[:, 0]
    np.testing.assert_allclose(seen, 50 + along[nearest[deep]], rtol=0, atol=0.06)


def test_light_goes_through_a_leafy_sphere_and_comes_out_behind() -> None:
    """A translucent sphere is lit on the side away from the sun; a transparent one throws no shadow."""
    scene = sunny()
    cloud = scene.add_point_cloud([[0, 0, 0]], 0.5, bsdf=nodes.translucent(ALBEDO))
    origins, directions = rays(np.random.default_rng(5), 500, 0.2)
    hits = scene.intersect(origins, directions)
    seen = scene.radiance(origins[hits.valid], directions[hits.valid])[:, 0]
    np.testing.assert_allclose(seen, lit(-hits.normal[hits.valid]), rtol=0, atol=1e-3)
    cloud.set_bsdf(nodes.transparent(0.5))
    scene.add_mesh(2 * SQUARE - [0, 0, 1], FACES, bsdf=shlight.Bsdf.lambert(ALBEDO))
    shadow = scene.radiance([[-SUN[0] / SUN[2], -SUN[1] / SUN[2], -0.9]], [0, 0, -1.0])[0, 0]
    assert abs(shadow - 0.5 * ALBEDO / math.pi * IRRADIANCE * SUN[2]) <= 1e-4
