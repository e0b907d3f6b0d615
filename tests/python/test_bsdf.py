# SPDX-License-Identifier: MIT
from __future__ import annotations

import math

import numpy as np
import pytest
from strategies import Floats

import shlight
from shlight import Bsdf


def upper(tilt_cosine: float, azimuth: float) -> Floats:
    r = math.sqrt(1 - tilt_cosine**2)
    return np.array([r * math.cos(azimuth), r * math.sin(azimuth), tilt_cosine])


def hemisphere_grid(count: int) -> tuple[Floats, Floats]:
    """Directions and solid angles over the upper hemisphere; z = t², as lobes have roots of z at the horizon."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    t = (nodes + 1) / 2
    z = t**2
    phi = 2 * math.pi * np.arange(2 * count) / (2 * count)
    r = np.sqrt(1 - z**2)[:, None]
    points = np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z[:, None]), axis=-1)
    return points, np.broadcast_to((weights * t)[:, None] * math.pi / count, points.shape[:-1])


@pytest.mark.parametrize(("f0", "ior"), [(1.0, None), (0.0, None), (0.0, 1.5)])
@pytest.mark.parametrize("alpha", [0.2, 0.5, 1.0])
def test_residual_is_the_error_of_the_expansion(alpha: float, f0: float, ior: float | None) -> None:
    """Also between the views that tables have."""
    bsdf = Bsdf.ggx(math.sqrt(alpha), f0, ior=ior)
    points, weights = hemisphere_grid(100)
    for cosine in (1.0, np.random.default_rng(60).uniform(0.15, 1)):
        exact = bsdf.evaluate(points, upper(cosine, 0))
        for order in (1, 4, 5, 11, 16, 32, 40):
            expansion = shlight.evaluate(bsdf.coefficients(cosine, order).astype(np.float64), points)
            error = math.sqrt((weights * (expansion - exact) ** 2).sum() / (weights * exact**2).sum())
            assert error == pytest.approx(float(bsdf.residual(cosine, order)), rel=0.05, abs=2e-5)


@pytest.mark.parametrize(
    ("alpha", "cosine", "at_4", "at_16"),
    [
        *((0.6, 0.95, 0.009, 5e-5), (0.6, 0.5, 0.10, 4e-4), (0.3, 0.95, 0.18, 2e-4), (0.3, 0.5, 0.46, 0.025)),
        *((0.3, 0.2, 0.63, 0.17), (0.1, 0.95, 0.74, 0.12)),
    ],
)
def test_residuals_fall_as_the_method_was_published_with(
    alpha: float, cosine: float, at_4: float, at_16: float
) -> None:
    found = [float(Bsdf.ggx(math.sqrt(alpha), 1).residual(cosine, order)) for order in (4, 16)]
    assert found[0] <= 1.15 * at_4
    assert found[1] <= 1.15 * at_16


@pytest.mark.parametrize("order", [2, 3, 7, 64])
def test_lambert_is_exact_from_order_two(order: int) -> None:
    expected = np.zeros(order**2)
    expected[2] = math.sqrt(4 / (3 * math.pi))  # z/π
    np.testing.assert_allclose(Bsdf.lambert(1).coefficients(0.3, order), expected, atol=1e-7)
    assert Bsdf.lambert(1).residual(0.3, order) <= 1e-7


def test_sums_and_multiples_are_linear() -> None:
    a, b = Bsdf.lambert([0.1, 0.5, 0.9]), Bsdf.ggx(0.6, 0.8)
    mixed = 2 * a + b * [1, 0, 0.5]
    wi, wo = upper(0.6, 1.0), upper(0.8, 0.0)
    tint = np.array([1, 0, 0.5])
    np.testing.assert_allclose(mixed.evaluate(wi, wo), 2 * a.evaluate(wi, wo) + tint * b.evaluate(wi, wo), rtol=1e-5)
    expected = 2 * a.coefficients(0.8, 6) + tint[:, None] * b.coefficients(0.8, 6)
    np.testing.assert_allclose(mixed.coefficients(0.8, 6), expected, atol=1e-5)


@pytest.mark.parametrize("ior", [1 + 1e-12, 1.0001, 4, 10, 99, 101, 1e30, 1e300])
def test_reflectance_is_a_share_for_every_ior(ior: float) -> None:
    """Above 3.73 the dielectric curve dips under its value head-on."""
    black, grey, mirror = Bsdf.ggx(0.5, 0, ior=ior), Bsdf.ggx(0.5, 0.04, ior=ior), Bsdf.ggx(0.5, 1)
    points, _ = hemisphere_grid(30)
    for cosine in (0.001, 0.01, 0.1, 0.5, 1.0):
        least = 0.04 * mirror.evaluate(points, upper(cosine, 0))
        values = grey.evaluate(points, upper(cosine, 0))
        assert (black.evaluate(points, upper(cosine, 0)) >= 0).all()
        assert (values >= least * (1 - 1e-6)).all()
        assert (values <= least / 0.04 * (1 + 1e-6)).all()
        light = np.array([-math.sqrt(1 - cosine**2), 0.1, cosine + 0.1])
        for order in ("auto", 8):
            radiance = shlight.shade_spheres(light, 0.2, grey, cosine, order=order)[0]
            full = shlight.shade_spheres(light, 0.2, mirror, cosine, order=order)[0]
            assert 0.04 * full - 1e-3 <= radiance <= full + 1e-3
        assert np.isfinite(grey.coefficients(cosine, 6)).all()
        assert np.isfinite(grey.residual(cosine, 6))


def test_shapes() -> None:
    grey, colored = Bsdf.lambert(0.5), Bsdf.lambert([0.1, 0.2, 0.3])
    for shape in [(), (4,), (2, 3)]:
        cosine = np.full(shape, 0.5)
        assert grey.coefficients(cosine, 3).shape == (*shape, 9)
        assert colored.coefficients(cosine, 3).shape == (*shape, 3, 9)
        assert grey.coefficients(cosine, 3).dtype == np.float32
        assert np.shape(grey.residual(cosine, 3)) == shape
        w = np.broadcast_to([0.6, 0, 0.8], (*shape, 3))
        assert np.shape(grey.evaluate(w, [0, 0, 1])) == shape
        assert colored.evaluate([0, 0, 1], w).shape == (*shape, 3)
    assert grey.evaluate(np.ones((5, 1, 3)), np.ones((4, 3))).shape == (5, 4)


def test_contract_broadcasts_over_colors() -> None:
    light = shlight.sphere_coefficients(np.ones((7, 3), np.float32), 0.5, 4)
    bsdf = Bsdf.lambert([0.1, 0.2, 0.3]).coefficients(np.full(7, 0.5), 4)
    radiance = shlight.contract(light[..., None, :], bsdf)
    assert radiance.shape == (7, 3)
    assert radiance.dtype == np.float32
    np.testing.assert_allclose(radiance, np.einsum("ak,ack->ac", light, bsdf), rtol=1e-5)


def test_products_of_colors_stay_in_range() -> None:
    with pytest.raises(ValueError, match="factor"):
        1e6 * (1e6 * Bsdf.lambert(1))
    sharp = 1e10 * Bsdf.ggx(0.0031, 1)
    assert np.isfinite(sharp.evaluate([-0.6, 0, 0.8], [0.6, 0, 0.8]))
    assert np.isfinite(sharp.coefficients([0, 0.5, 1], 64)).all()
    for order in ("auto", 8):
        assert np.isfinite(shlight.shade_spheres([[-0.6, 0, 0.8], [0, 0, -2]], 0.1, sharp, [0.8, 0], order=order)).all()
