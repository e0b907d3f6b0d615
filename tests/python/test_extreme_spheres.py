# SPDX-License-Identifier: MIT
"""Spheres so near, so far, so small or so large that squares leave the range of a type."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import Bsdf

CENTER, RADIUS = np.array([0.3, 0.2, 1.0]), 0.5
COEFFICIENT_METHODS = ["exact", "zhou_wei", "quadrature"]
SHADING_METHODS = ["auto", "cubature", "quadrature"]
EXPONENTS = [-1040, -1020, -600, 600, 1023]
BSDF = Bsdf.ggx(0.3, 1)
functions: Any = pytest.mark.parametrize(
    "function",
    [
        *(
            lambda c, r, m=m: shlight.sphere_coefficients(c, r, 3, dtype=np.float64, method=m)
            for m in COEFFICIENT_METHODS
        ),
        *(lambda c, r, m=m: shlight.shade_spheres(c, r, BSDF, 0.7, method=m) for m in SHADING_METHODS),
    ],
    ids=[*COEFFICIENT_METHODS, *SHADING_METHODS],
)


@functions
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_only_ratios_of_lengths_count(function: Callable[..., Any], exponent: int) -> None:
    """The least doubles have few digits: what is near 2^-1040 is known to 1e-10 of itself."""
    scaled = np.ldexp(CENTER, exponent)
    expected = function(np.ldexp(scaled, -exponent), np.ldexp(np.ldexp(RADIUS, exponent), -exponent))
    np.testing.assert_allclose(function(scaled, np.ldexp(RADIUS, exponent)), expected, atol=1e-5, rtol=0)


@functions
@pytest.mark.parametrize(
    ("distance", "radius"), [(1, 1.4e154), (1, 1e308), (5e-324, 1e308), (1e-300, 1e-200), (1e-310, 2e-310), (0, 1e-320)]
)
def test_a_point_inside_is_refused(function: Callable[..., Any], distance: float, radius: float) -> None:
    with pytest.raises(ValueError, match=r"^radii: .*inside"):
        function([0, 0, distance], radius)


@pytest.mark.parametrize("exponent", [-149, -140, -130, -127, -126, -125, 100, 126])
def test_float32_is_right_or_refused(exponent: int) -> None:
    center, radius = np.ldexp(CENTER, exponent).astype(np.float32), np.float32(math.ldexp(RADIUS, exponent))
    bsdf = Bsdf.lambert(1)
    for function in (
        lambda c, r: shlight.sphere_coefficients(c, r, 3, dtype=c.dtype),
        lambda c, r: shlight.shade_spheres(c, r, bsdf, 0.7),
    ):
        if exponent < -126:
            with pytest.raises(ValueError, match=r"^(centers|radii)"):
                function(center, radius)
        else:
            back = np.ldexp(center.astype(np.float64), -exponent), math.ldexp(float(radius), -exponent)
            np.testing.assert_allclose(function(center, radius), function(*back), atol=1e-6, rtol=0)
