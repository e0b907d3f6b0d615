# SPDX-License-Identifier: MIT
"""shade_spheres and shade_polygons: accuracy against dense cubature in numpy, what must hold for any light, manners."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lobe_cubature import over_polygon, over_sphere, view_direction
from strategies import Floats, polygons, reproducible, spheres

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


# --- accuracy -----------------------------------------------------------------------------------------------------


class Outcome:
    """Errors ÷ the brightest value of each material and view, and how many lights took at most 16 of anything."""

    def __init__(self) -> None:
        self.errors: list[float] = []
        self.few: list[bool] = []

    def add(self, computed: Floats, truth: Floats, effort: Floats, cosine: float) -> None:
        self.errors.extend((np.abs(computed - truth).max(axis=-1) / truth.max()).tolist())
        if cosine >= 0.3:
            self.few.extend((effort <= 16).tolist())

    def check(self, tolerance: float) -> None:
        assert np.quantile(self.errors, 0.99) <= 2 * tolerance
        assert np.max(self.errors) <= 10 * tolerance
        assert np.mean(self.few) >= 0.9


def random_views(rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    return [(rng.uniform(0.2, 1), rng.uniform(0.1, 0.3) if i % 4 == 0 else rng.uniform(0.1, 1)) for i in range(count)]


@pytest.fixture(scope="module")
def sphere_truths() -> list[tuple[float, float, Floats, Floats, Floats]]:
    """Roughness, cosθ_o, centres, radii, radiances."""
    rng = np.random.default_rng(1)
    cases = []
    for roughness, cosine in random_views(rng, 16):
        lights = [random_light(rng, k % 3, roughness**2, cosine) for k in range(18)]
        distances = 10 ** rng.uniform(-1, 1, len(lights))
        centers = distances[:, None] * np.array([axis for axis, _ in lights])
        radii = distances * np.sin([half_angle for _, half_angle in lights])
        truth = [over_sphere(Bsdf.ggx(roughness, 1), cosine, c, r) for c, r in zip(centers, radii, strict=True)]
        cases.append((roughness, cosine, centers, radii, np.array(truth)))
    return cases


@pytest.fixture(scope="module")
def polygon_truths() -> list[tuple[float, float, Floats, Floats]]:
    """Roughness, cosθ_o, vertices, radiances."""
    rng = np.random.default_rng(2)
    cases = []
    for roughness, cosine in random_views(rng, 12):
        quads = [random_quad(rng, *random_light(rng, k % 3, roughness**2, cosine)) for k in range(12)]
        truth = [over_polygon(Bsdf.ggx(roughness, 1), cosine, quad) for quad in quads]
        cases.append((roughness, cosine, np.array(quads), np.array(truth)))
    return cases


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_spheres_match_dense_cubature(
    sphere_truths: list[tuple[float, float, Floats, Floats, Floats]], tolerance: float
) -> None:
    outcome = Outcome()
    for roughness, cosine, centers, radii, truth in sphere_truths:
        computed, effort = shlight.shade_spheres(
            centers, radii, Bsdf.ggx(roughness, 1), cosine, tolerance=tolerance, return_effort=True
        )
        outcome.add(computed, truth, effort, cosine)
    outcome.check(tolerance)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_polygons_match_dense_cubature(
    polygon_truths: list[tuple[float, float, Floats, Floats]], tolerance: float
) -> None:
    outcome = Outcome()
    for roughness, cosine, quads, truth in polygon_truths:
        computed, effort = shlight.shade_polygons(
            quads, Bsdf.ggx(roughness, 1), cosine, tolerance=tolerance, return_effort=True
        )
        outcome.add(computed, truth, effort, cosine)
    outcome.check(tolerance)


def test_tighter_tolerances_cost_more() -> None:
    rng = np.random.default_rng(4)
    tolerances = (1e-1, 1e-2, 1e-3, 1e-4)
    for roughness, cosine in ((0.1, 0.6), (0.3, 0.25)):
        lights = [random_light(rng, k % 3, roughness**2, cosine) for k in range(600)]
        centers, radii = np.array([axis for axis, _ in lights]), np.sin([half_angle for _, half_angle in lights])
        quads = np.array([random_quad(rng, *light) for light in lights])
        bsdf = Bsdf.ggx(roughness, 1)
        for efforts in (
            [
                shlight.shade_spheres(centers, radii, bsdf, cosine, tolerance=t, return_effort=True)[1]
                for t in tolerances
            ],
            [shlight.shade_polygons(quads, bsdf, cosine, tolerance=t, return_effort=True)[1] for t in tolerances],
        ):
            means = [float(effort.mean()) for effort in efforts]
            assert means == sorted(means)
            assert means[-1] > 2 * means[0]


@pytest.mark.parametrize("cosine", [0.1, 0.2, 0.4])
def test_tolerances_are_relative_to_the_albedo(cosine: float) -> None:
    """A lobe that is dark but at grazing angles, beside the same at a much smaller tolerance."""
    rng = np.random.default_rng(10)
    bsdf = Bsdf.ggx(0.4, 0)
    lights = [random_light(rng, k % 3, 0.16, cosine) for k in range(300)]
    centers, radii = np.array([axis for axis, _ in lights]), np.sin([half_angle for _, half_angle in lights])
    quads = np.array([random_quad(rng, *light) for light in lights])
    for shade in (
        lambda tolerance: shlight.shade_spheres(centers, radii, bsdf, cosine, tolerance=tolerance),
        lambda tolerance: shlight.shade_polygons(quads, bsdf, cosine, tolerance=tolerance),
    ):
        for tolerance in (1e-2, 1e-3):
            errors = np.abs(shade(tolerance) - shade(1e-6)) / albedo(bsdf, cosine)
            assert np.quantile(errors, 0.99) <= 2 * tolerance
            assert errors.max() <= 10 * tolerance


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


@reproducible
@given(spheres(), st.sampled_from([0.6, 0.8, 1.0]), st.floats(0.3, 1))
def test_rough_lobes_agree_with_plain_harmonics(sphere: tuple[Floats, float], roughness: float, cosine: float) -> None:
    """Eq. 5 in the shading frame, whose residual at order 64 is below 1e-3 for lobes this rough."""
    bsdf = Bsdf.ggx(roughness, 0.8)
    light = shlight.sphere_coefficients(*sphere, 64, dtype=np.float64)
    expected = shlight.shade(light, bsdf.coefficients(cosine, 64).astype(np.float64))
    computed = shlight.shade_spheres(*sphere, bsdf, cosine)
    np.testing.assert_allclose(computed, np.full(3, expected), atol=3e-3)


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
        # Tails of the bell: (α / ½ radius cosθ_o)².
        np.testing.assert_allclose(computed, np.full(3, mirror_fresnel(0.4, 0.6)), rtol=1.5e-3)


# --- what must hold for any light ---------------------------------------------------------------------------------


@reproducible
@given(spheres(), polygons(), roughnesses, cosines)
def test_mirroring_the_scene_changes_nothing(
    sphere: tuple[Floats, float], vertices: Floats, roughness: float, cosine: float
) -> None:
    bsdf = Bsdf.ggx(roughness, 0.7)
    mirror = np.array([1, -1, 1])
    np.testing.assert_allclose(
        shlight.shade_spheres(sphere[0] * mirror, sphere[1], bsdf, cosine),
        shlight.shade_spheres(*sphere, bsdf, cosine),
        atol=1e-5,
    )
    np.testing.assert_allclose(
        shlight.shade_polygons(vertices * mirror, bsdf, cosine),
        shlight.shade_polygons(vertices, bsdf, cosine),
        atol=1e-5,
    )


@reproducible
@given(spheres(), polygons(), roughnesses, cosines, st.integers(-100, 100))
def test_scale_does_not_matter(
    sphere: tuple[Floats, float], vertices: Floats, roughness: float, cosine: float, exponent: int
) -> None:
    bsdf, scale = Bsdf.ggx(roughness, 0.7), 2.0**exponent
    np.testing.assert_array_equal(
        shlight.shade_spheres(scale * sphere[0], scale * sphere[1], bsdf, cosine),
        shlight.shade_spheres(*sphere, bsdf, cosine),
    )
    np.testing.assert_array_equal(
        shlight.shade_polygons(scale * vertices, bsdf, cosine), shlight.shade_polygons(vertices, bsdf, cosine)
    )


@reproducible
@given(polygons(), st.integers(0, 5), roughnesses, cosines)
def test_winding_and_first_vertex_do_not_matter(vertices: Floats, first: int, roughness: float, cosine: float) -> None:
    bsdf = Bsdf.ggx(roughness, 1)
    expected = shlight.shade_polygons(vertices, bsdf, cosine)
    scale = albedo(bsdf, cosine)
    for same in (vertices[::-1], np.roll(vertices, first, axis=0)):
        # Cubature divides a polygon into a fan from its first vertex.
        assert np.all(np.abs(shlight.shade_polygons(same, bsdf, cosine) - expected) <= 2e-3 * scale)


@reproducible
@given(polygons(), st.floats(0.1, 0.9), roughnesses, cosines)
def test_parts_sum_to_the_whole(vertices: Floats, share: float, roughness: float, cosine: float) -> None:
    """A triangle, cut from one corner to the opposite side."""
    a, b, c = vertices[:3]
    cut = (1 - share) * b + share * c
    bsdf = Bsdf.ggx(roughness, 1)
    parts = shlight.shade_polygons([[a, b, cut], [a, cut, c]], bsdf, cosine).sum(axis=0)
    whole = shlight.shade_polygons([a, b, c], bsdf, cosine)
    assert np.all(np.abs(parts - whole) <= 4e-3 * albedo(bsdf, cosine))  # three errors


@reproducible
@given(spheres(), roughnesses, roughnesses, cosines)
def test_sums_of_materials_are_sums_of_radiances(
    sphere: tuple[Floats, float], roughness: float, other: float, cosine: float
) -> None:
    a, b = Bsdf.ggx(roughness, [0.9, 0.1, 0.5]), 0.5 * Bsdf.ggx(other, 0.04, ior=1.5)
    both = shlight.shade_spheres(*sphere, a + b, cosine)
    apart = shlight.shade_spheres(*sphere, a, cosine) + shlight.shade_spheres(*sphere, b, cosine)
    assert np.all(np.abs(both - apart) <= 4e-3 * albedo(a + b, cosine))


@reproducible
@given(spheres(), st.floats(1, 2), roughnesses, cosines)
def test_larger_spheres_are_no_darker(
    sphere: tuple[Floats, float], growth: float, roughness: float, cosine: float
) -> None:
    center, radius = sphere
    larger = min(growth * radius, float(np.linalg.norm(center)))
    bsdf = Bsdf.ggx(roughness, 1)
    less, more = shlight.shade_spheres(center, [radius, larger], bsdf, cosine)
    assert np.all(less <= more + 3e-3 * albedo(bsdf, cosine))


@reproducible
@given(spheres(), polygons(), roughnesses, cosines)
def test_nothing_reflects_more_than_it_receives(
    sphere: tuple[Floats, float], vertices: Floats, roughness: float, cosine: float
) -> None:
    bsdf = Bsdf.ggx(roughness, 1)
    for radiance in (shlight.shade_spheres(*sphere, bsdf, cosine), shlight.shade_polygons(vertices, bsdf, cosine)):
        assert np.all(radiance >= 0)
        assert np.all(radiance <= 1.002)


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


# --- manners ------------------------------------------------------------------------------------------------------

BSDF = Bsdf.ggx(0.3, [0.9, 0.5, 0.1])
TRIANGLE = [[1, 0, 1], [0, 1, 1], [-1, -1, 1]]


@pytest.mark.parametrize(
    ("lights", "sizes", "views", "expected"),
    [
        ((), (), (), ()),
        ((4,), (), (), (4,)),
        ((), (4,), (), (4,)),
        ((), (), (4,), (4,)),
        ((5, 1), (4,), (), (5, 4)),
        ((2, 1, 3), (2, 1), (1, 1, 1), (2, 2, 3)),
        ((0,), (), (), (0,)),
        ((3, 0), (1,), (3, 1), (3, 0)),
    ],
)
def test_leading_axes_broadcast(
    lights: tuple[int, ...], sizes: tuple[int, ...], views: tuple[int, ...], expected: tuple[int, ...]
) -> None:
    center = np.array([-0.5, 0.2, 0.4])
    for result in (
        shlight.shade_spheres(
            np.broadcast_to(center, (*lights, 3)), np.full(sizes, 0.3), BSDF, np.full(views, 0.5), return_effort=True
        ),
        shlight.shade_polygons(
            np.broadcast_to(TRIANGLE, (*np.broadcast_shapes(lights, sizes), 3, 3)),
            BSDF,
            np.full(views, 0.5),
            return_effort=True,
        ),
    ):
        radiance, effort = result
        assert radiance.shape == (*expected, 3)
        assert radiance.dtype == np.float32
        assert np.shape(effort) == expected
        assert effort.dtype == np.int32
        assert radiance.size == 0 or (np.ptp(radiance.reshape(-1, 3), axis=0).max() == 0 and np.all(effort > 0))


def test_each_light_has_its_own_view() -> None:
    """Batches give what single calls give, in every order of views."""
    rng = np.random.default_rng(7)
    centers, radii = rng.normal([0, 0, 1.5], size=(30, 3)), rng.uniform(0.01, 0.2, 30)
    quads = centers[:, None] + 0.3 * rng.normal(size=(30, 3, 3))
    views = rng.choice([0.1, 0.5, 0.9, 1.0], 30)
    balls = shlight.shade_spheres(centers, radii, BSDF, views)
    triangles = shlight.shade_polygons(quads, BSDF, views)
    for i in range(30):
        np.testing.assert_array_equal(balls[i], shlight.shade_spheres(centers[i], radii[i], BSDF, views[i]))
        np.testing.assert_array_equal(triangles[i], shlight.shade_polygons(quads[i], BSDF, views[i]))


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64, np.int8])
def test_any_real_type_will_do(dtype: type) -> None:
    center, triangle = np.array([-1, 1, 2], dtype), np.array(TRIANGLE, dtype)
    view = np.array(1, dtype)
    expected = shlight.shade_spheres([-1.0, 1.0, 2.0], 1.0, BSDF, 1.0)
    np.testing.assert_array_equal(shlight.shade_spheres(center, np.array(1, dtype), BSDF, view), expected)
    expected = shlight.shade_polygons(np.array(TRIANGLE, float), BSDF, 1.0)
    np.testing.assert_array_equal(shlight.shade_polygons(triangle, BSDF, view), expected)


def test_strided_arrays_are_read_right() -> None:
    rng = np.random.default_rng(8)
    wide = rng.normal(size=(3, 40)) + 3
    centers = wide.T[::2]
    expected = shlight.shade_spheres(centers.copy(), 0.5, BSDF, 0.5)
    np.testing.assert_array_equal(shlight.shade_spheres(centers, 0.5, BSDF, 0.5), expected)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_no_bit(threads: int) -> None:
    rng = np.random.default_rng(9)
    centers = rng.normal(size=(1003, 3))
    radii = np.linalg.norm(centers, axis=1) * rng.uniform(0.01, 0.99, 1003)
    vertices = centers[:, None, :] + 0.5 * rng.normal(size=(1003, 3, 3))
    views = rng.uniform(0, 1, 1003)
    for call in (
        lambda n: shlight.shade_spheres(centers, radii, BSDF, views, threads=n, return_effort=True),
        lambda n: shlight.shade_polygons(vertices, BSDF, views, threads=n, return_effort=True),
    ):
        for single, many in zip(call(threads), call(0), strict=True):
            assert single.tobytes() == many.tobytes()


def test_hidden_lights_give_zeros() -> None:
    for result in (
        shlight.shade_spheres([0.3, 0, -2], 1, BSDF, 0.5, return_effort=True),
        shlight.shade_polygons(-np.array(TRIANGLE), BSDF, 0.5, return_effort=True),
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [3, 0, 3]], BSDF, 0.5, return_effort=True),  # no area
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [2, 0, 1]], BSDF, 0.5, return_effort=True),  # edge-on
        shlight.shade_spheres([0, 0, 2], 1, Bsdf.lambert(0), 0.5, return_effort=True),
    ):
        radiance, effort = result
        assert not radiance.any()
        assert effort == 0


@pytest.mark.parametrize("order", [1, 2, 5, 8, 64])
def test_a_given_order_is_taken_as_far_as_there_are_bands(order: int) -> None:
    lights = [[0, 0, 1], [-1, 0, 0.1], [-2, 0, 2]]
    radii = [1e-3, 0.5, 1]
    lambert = Bsdf.lambert(0.5)
    for bsdf, taken in ((BSDF, order), (lambert, min(order, 2)), (MATERIALS["plastic"], order)):
        _, effort = shlight.shade_spheres(lights, radii, bsdf, 0.5, order=order, return_effort=True)
        np.testing.assert_array_equal(effort, taken)
        _, effort = shlight.shade_polygons(TRIANGLE, bsdf, 0.5, order=order, return_effort=True)
        assert effort == taken


def test_higher_orders_are_closer() -> None:
    center, radius, bsdf = [-0.8, 0.1, 0.7], 0.3, Bsdf.ggx(0.3, 1)
    expected = over_sphere(bsdf, 0.6, np.array(center), radius)[0]
    errors = [abs(shlight.shade_spheres(center, radius, bsdf, 0.6, order=n)[0] - expected) for n in (2, 6, 16)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] <= 1e-4


Call = Callable[..., Floats]


def with_sphere(**options: object) -> Floats:
    arguments = {"centers": [0, 0, 2], "radii": 1, "cos_theta_o": 0.5} | options
    return shlight.shade_spheres(bsdf=BSDF, **arguments)  # type: ignore[call-overload]


def with_polygon(**options: object) -> Floats:
    arguments = {"vertices": TRIANGLE, "cos_theta_o": 0.5} | options
    return shlight.shade_polygons(bsdf=BSDF, **arguments)  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(("order", bad) for bad in (0, -1, 65, 2.5, "8", "x", None, [8])),
        *(("tolerance", bad) for bad in (0, -1e-3, math.nan, math.inf, "fine", None, [1e-3, 1e-2])),
        *(("cos_theta_o", bad) for bad in (-0.01, 1.001, math.nan, math.inf, "up", None, [0.5, 2], 1j)),
        *(("threads", bad) for bad in (-1, 1.5, None)),
    ],
)
def test_bad_settings_are_named(argument: str, value: object) -> None:
    for call in (with_sphere, with_polygon):
        with pytest.raises(ValueError, match=argument):
            call(**{argument: value})


@pytest.mark.parametrize("bad", [[math.nan, 0, 1], [0, -math.inf, 1], [1, 2], 1.0, [[1, 2, 3, 4]], "up", None])
def test_bad_centers_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="centers"):
        with_sphere(centers=bad)


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, "big", None, [0.5, -0.5], [math.nan, 1], 2.001])
def test_bad_radii_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="radii"):
        with_sphere(radii=bad)


@pytest.mark.parametrize(
    "bad",
    [
        TRIANGLE[:2],
        [TRIANGLE[:2]] * 3,
        [],
        [1, 2, 3],
        [[1, 2]] * 3,
        [[math.nan, 0, 1], *TRIANGLE[1:]],
        [[math.inf, 0, 1], *TRIANGLE[1:]],
        [*TRIANGLE, [0, 0, 3]],  # not planar
        "square",
        None,
    ],
)
def test_bad_vertices_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="vertices"):
        with_polygon(vertices=bad)


def test_axes_that_do_not_broadcast_are_named() -> None:
    with pytest.raises(ValueError, match="radii"):
        with_sphere(centers=[[0, 0, 2]] * 2, radii=[1, 1, 1])
    with pytest.raises(ValueError, match="cos_theta_o"):
        with_polygon(vertices=[TRIANGLE] * 2, cos_theta_o=[0.5] * 3)


@pytest.mark.parametrize("bad", [None, 0.5, "ggx"])
def test_a_material_must_be_one(bad: object) -> None:
    with pytest.raises(TypeError):
        shlight.shade_spheres([0, 0, 2], 1, bad, 0.5)  # type: ignore[call-overload]
