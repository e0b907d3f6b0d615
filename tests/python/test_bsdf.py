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
    """Directions and solid angles over the upper hemisphere."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    z = (nodes + 1) / 2
    phi = 2 * math.pi * np.arange(2 * count) / (2 * count)
    r = np.sqrt(1 - z**2)[:, None]
    points = np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z[:, None]), axis=-1)
    return points, np.broadcast_to(weights[:, None] / 2 * math.pi / count, points.shape[:-1])


@pytest.mark.parametrize("cosine", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("order", [4, 8, 16])
def test_residual_is_the_error_of_the_expansion(cosine: float, order: int) -> None:
    bsdf = Bsdf.ggx(0.7, 1.0)
    points, weights = hemisphere_grid(90)
    exact = bsdf.evaluate(points, upper(cosine, 0))
    expansion = shlight.evaluate(bsdf.coefficients(cosine, order).astype(np.float64), points)
    error = math.sqrt((weights * (expansion - exact) ** 2).sum() / (weights * exact**2).sum())
    assert error == pytest.approx(float(bsdf.residual(cosine, order)), rel=0.05, abs=1e-4)


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
