# SPDX-License-Identifier: MIT
"""Derivatives of lights' coefficients and of what materials reflect, against other ways to find them."""

from __future__ import annotations

from typing import Any

import gradient_truth as truth
import numpy as np
import pytest

import shlight
from shlight import Bsdf

COSINE = 0.8
VIEW = np.array([0.6, 0.0, 0.8])
F0 = 0.25
# Far in a lobe's tails the integral by roughness errs by a share of what the whole lobe reflects.
OF_WHOLE_LOBE = 1e-11
# Roughnesses are floats: these are exact.
MATERIALS: list[Any] = [
    pytest.param(Bsdf.lambert(1), None, id="lambert"),
    pytest.param(Bsdf.ggx(0.75, F0), 0.75, id="rough"),
    pytest.param(Bsdf.ggx(0.375, F0), 0.375, id="glossy"),
]


def lobe(roughness: Any) -> Any:
    return truth.lambert if roughness is None else truth.ggx(roughness**2, F0)


def random_spheres(seed: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A third each whole, cut by the horizon with the centre above, and with the centre below; none across the pole."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(0.05, 0.5, count)
    azimuth, across = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.6, 1.5, count)
    heights = np.choose(np.arange(count) % 3, [1.2, 0.6, -0.6]) * radii
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), heights], axis=-1), radii


def random_polygons(seed: int, count: int) -> np.ndarray:
    """Quadrangles above, and cut by, the horizon, in both windings."""
    rng = np.random.default_rng(seed)
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    made = []
    for i in range(count):
        turned = square @ np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.1, 0.6)
        center = rng.normal(size=3)
        center *= 1.5 / np.linalg.norm(center)
        center[2] = 0.05 if i % 2 else abs(center[2]) + 0.9
        made.append((turned + center)[:: 1 if i % 3 else -1])
    return np.array(made)


def largest_error(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("clip", [True, False])
@pytest.mark.parametrize("order", [1, 6, 63])
def test_coefficients_agree_with_differences(order: int, clip: bool) -> None:
    centers, radii = random_spheres(2, 40)
    centers = np.concatenate([centers, [[0, 0, 1.0], [0, 1e-3, 0.2]]])
    radii = np.append(radii, [0.3, 0.199])
    value, gradient = shlight.sphere_coefficients(centers, radii, order, clip=clip, gradient=True)
    np.testing.assert_allclose(value, shlight.sphere_coefficients(centers, radii, order, clip=clip), atol=1e-13)
    numbers = np.column_stack([centers, radii])
    found = np.concatenate([gradient.center, gradient.radius[..., None]], axis=-1)
    for k in range(4):
        # Eighth-order differences leave about 1e-12 of what the outline adds.
        expected = np.zeros_like(value)
        step = 1e-3 / order
        for n, weight in enumerate([4 / 5, -1 / 5, 4 / 105, -1 / 280], start=1):
            for sign in (1, -1):
                moved = numbers.copy()
                moved[:40, k] += sign * n * step * radii[:40]
                moved[40:, k] += sign * n * step * 1e-3
                part = shlight.sphere_coefficients(moved[:, :3], moved[:, 3], order, clip=clip)
                expected += sign * weight * part / (np.append(radii[:40], [1e-3, 1e-3])[:, None] * step)
        scale = np.abs(found).max(axis=(1, 2))
        error = np.abs(found[..., k] - expected).max(axis=1) / scale
        assert np.all(error[:40] <= 1e-11 * order)  # roundings of 1e-15 of values, divided by the step
        assert np.all(error[40:] <= 1e-5)  # of smaller steps


@pytest.mark.parametrize(("bsdf", "roughness"), MATERIALS)
def test_spheres_agree_with_steps_into_the_complex_plane(bsdf: Bsdf, roughness: float | None) -> None:
    centers, radii = random_spheres(3, 12)
    gradient = shlight.shade_spheres(centers, radii, bsdf, COSINE, gradient=True)[1]
    for i, (center, radius) in enumerate(zip(centers, radii, strict=True)):
        expected = truth.derivative(
            lambda x: truth.sphere_radiance(x[:3], x[3], lobe(roughness), VIEW), np.array([*center, radius])
        )
        found = np.array([*gradient.center[i, 0], gradient.radius[i, 0]])
        assert largest_error(found, expected) <= 1e-7, (center, radius)
        if roughness is not None:
            of_roughness = truth.derivative(
                lambda x: truth.sphere_radiance(center + 0j, radius, lobe(x[0]), VIEW),  # noqa: B023
                np.array([roughness]),
            )[0]
            assert abs(gradient.roughness[i, 0] - of_roughness) <= 1e-6 * abs(of_roughness) + OF_WHOLE_LOBE, (
                center,
                radius,
            )


@pytest.mark.parametrize(("bsdf", "roughness"), MATERIALS)
def test_polygons_agree_with_steps_into_the_complex_plane(bsdf: Bsdf, roughness: float | None) -> None:
    in_plane_of_view = [[-1, 0, 1], [1, 0, 1], [1, 1, 1], [-1, 1, 1]]
    polygons = np.concatenate([random_polygons(4, 6), [in_plane_of_view]])
    gradient = shlight.shade_polygons(polygons, bsdf, COSINE, gradient=True)[1]
    for i, vertices in enumerate(polygons):
        expected = truth.derivative(lambda v: truth.polygon_radiance(v, lobe(roughness), VIEW), vertices)
        assert largest_error(gradient.vertices[i, 0], expected) <= 1e-7, vertices
        if roughness is not None:
            of_roughness = truth.derivative(
                lambda x: truth.polygon_radiance(vertices, lobe(x[0]), VIEW),  # noqa: B023
                np.array([roughness]),
            )[0]
            assert abs(gradient.roughness[i, 0] - of_roughness) <= 1e-6 * abs(of_roughness) + OF_WHOLE_LOBE, vertices


def test_gradients_scale_with_the_unit_of_length() -> None:
    centers, radii = random_spheres(5, 12)
    polygons = random_polygons(5, 4)
    bsdf = Bsdf.ggx(0.5, 0.5)
    for unit in (2.0**-600, 2.0**40, 2.0**900):
        for near, far in (
            (
                shlight.sphere_coefficients(centers, radii, 5, gradient=True)[1],
                shlight.sphere_coefficients(centers * unit, radii * unit, 5, gradient=True)[1],
            ),
            (
                shlight.shade_spheres(centers, radii, bsdf, COSINE, gradient=True)[1][:2],
                shlight.shade_spheres(centers * unit, radii * unit, bsdf, COSINE, gradient=True)[1][:2],
            ),
            (
                shlight.shade_polygons(polygons, bsdf, COSINE, gradient=True)[1][:1],
                shlight.shade_polygons(polygons * unit, bsdf, COSINE, gradient=True)[1][:1],
            ),
        ):
            for a, b in zip(near, far, strict=True):
                np.testing.assert_allclose(b * unit, a, rtol=1e-9, atol=1e-12 * np.abs(a).max())


def test_types_shapes_and_threads() -> None:
    centers, radii = random_spheres(6, 600)
    bsdf = Bsdf.ggx(0.5, (0.1, 0.5, 0.9))
    spheres = centers.reshape(2, 300, 3), radii.reshape(2, 300)
    for dtype in (np.float32, np.float64):
        c, r = (x.astype(dtype) for x in spheres)
        value, (center, radius) = shlight.sphere_coefficients(c, r, 3, gradient=True)
        assert (value.shape, center.shape, radius.shape) == ((2, 300, 9), (2, 300, 9, 3), (2, 300, 9))
        out = np.empty_like(value)
        assert shlight.sphere_coefficients(c, r, 3, gradient=True, out=out, threads=1)[0] is out
        np.testing.assert_array_equal(out, value)
        shaded, effort, by = shlight.shade_spheres(c, r, bsdf, COSINE, gradient=True, return_effort=True)
        assert (shaded.dtype, effort.shape) == (np.float32, (2, 300))
        assert [x.shape for x in by] == [(2, 300, 3, 3), (2, 300, 3), (2, 300, 3)]
        alone = shlight.shade_spheres(c, r, bsdf, COSINE, gradient=True, threads=1)[1]
        for a, b in zip(by, alone, strict=True):
            assert a.dtype == dtype
            np.testing.assert_array_equal(a, b)
        if dtype is np.float32:
            single = by
    places = shlight.shade_spheres(*spheres, bsdf, COSINE, gradient="places")[1]
    assert places.roughness.shape == (2, 300, 0)
    for a, b in zip(by[:2], places[:2], strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(single, by, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-3, atol=1e-4 * np.abs(b).max())
    polygons = random_polygons(6, 6).reshape(2, 3, 4, 3)
    for gradient, channels in ((True, 3), ("places", 0)):
        by_polygon = shlight.shade_polygons(polygons, bsdf, [[0.3], [0.9]], gradient=gradient)[1]
        assert [x.shape for x in by_polygon] == [(2, 3, 3, 4, 3), (2, 3, channels)]


def test_an_azimuth_turns_gradients_with_the_view() -> None:
    center, phi = np.array([0.4, 0.3, 0.9]), 0.7
    c, s = np.cos(phi), np.sin(phi)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    bsdf = Bsdf.ggx(0.5, 0.5)
    expected = shlight.shade_spheres(center, 0.2, bsdf, COSINE, gradient=True)[1].center @ turn.T
    found = shlight.shade_spheres(turn @ center, 0.2, bsdf, COSINE, phi_o=phi, gradient=True)[1].center
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("roughness", [0.25, 0.5, 1.0])
def test_an_outline_in_one_plane_with_the_view(roughness: float) -> None:
    """A sphere in contact has a great circle for its outline, here through a view from above."""
    angles, weights = np.polynomial.legendre.leggauss(400)
    bsdf = Bsdf.ggx(roughness, F0)
    psi = (angles + 1) * np.pi / 4
    towards = np.stack([0 * psi, np.sin(psi), np.cos(psi)], axis=-1)
    values = bsdf.evaluate(towards, [0, 0, 1.0])
    expected = 2 * np.pi / 4 * (weights * np.cos(psi)) @ values.reshape(len(psi), -1)[:, 0]
    found = shlight.shade_spheres([1.0, 0, 0], 1.0, bsdf, 1.0, gradient="places")[1].center[0]
    np.testing.assert_allclose(found, [0, 0, expected], rtol=1e-6, atol=1e-9)


def test_hidden_degenerate_and_touching_lights_are_finite() -> None:
    bsdf = Bsdf.ggx(0.5, 0.5) + Bsdf.lambert(0.5)
    spheres = np.array([[0, 0, -2.0], [0, 0, 1.0], [1.0, 0, 0], [0.6, 0.0, -0.3], [0.6, 0, 0.3]])
    radii = np.array([1.0, 1.0, 1.0, 0.3, 0.3])  # hidden, in contact twice, tangent below and above
    for view in (0.0, 1e-9, 0.8, 1.0):
        for part in shlight.shade_spheres(spheres, radii, bsdf, view, gradient=True)[1]:
            assert np.isfinite(part).all()
            assert not part[[0, 3]].any()
    for part in shlight.sphere_coefficients(spheres, radii, 7, gradient=True)[1]:
        assert np.isfinite(part).all()
        assert not part[[0, 3]].any()
    edge_on = np.array([[1.0, 0, 0], [2, 0, 0], [2, 0, 1]])
    below = np.array([[-1.0, -1, -1], [1, -1, -1], [0, 1, -1]])
    for part in shlight.shade_polygons([edge_on, below], bsdf, 0.8, gradient=True)[1]:
        assert not part.any()
    for part in shlight.shade_spheres([[-0.6, 0, 0.8]], 0.2, Bsdf.ggx(0, 1), 0.8, gradient=True)[1]:
        assert not part.any()  # a mirror shows the light or not
