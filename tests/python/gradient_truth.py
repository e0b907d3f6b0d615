# SPDX-License-Identifier: MIT
"""Derivatives of integrals over lights by other means than the library's: of f·cos by steps into the complex plane
through cubature over the light's interior, and of coefficients by differences of mpmath's integrals.

Im f(x + ih)/h is f′(x) to h² without cancellation, where f is analytic: h may be 1e-30.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np

Values = Any  # arrays of float or complex

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)
_NODES, _WEIGHTS = (_NODES + 1) / 2, _WEIGHTS / 2
_STEP = 1e-30


def derivative(function: Callable[[Values], Values], at: np.ndarray) -> np.ndarray:
    """The gradient of a number, in the shape of `at`."""
    found = np.empty(at.shape)
    for index in np.ndindex(at.shape):
        moved = at.astype(complex)
        moved[index] += 1j * _STEP
        found[index] = function(moved).imag / _STEP
    return found


def lambert(wi: Values, wo: Values) -> Values:
    return wi[2] / np.pi


def ggx(alpha: Values, f0: float) -> Callable[[Values, Values], Values]:
    """f·cos of GGX with Smith's height-correlated masking (Heitz 2014) and Schlick's Fresnel factor."""

    def value(wi: Values, wo: Values) -> Values:
        h = [a + b for a, b in zip(wi, wo, strict=True)]
        length = np.sqrt(sum(x * x for x in h))
        cosine = h[2] / length
        between = sum(a * b for a, b in zip(wi, h, strict=True)) / length
        d = alpha**2 / (np.pi * (1 + (alpha**2 - 1) * cosine**2) ** 2)

        def smith(c: Values) -> Values:
            return np.sqrt(alpha**2 + (1 - alpha**2) * c**2)

        visibility = 0.5 / (wo[2] * smith(wi[2]) + wi[2] * smith(wo[2]))
        return (f0 + (1 - f0) * (1 - between) ** 5) * d * visibility * wi[2]

    return value


def sphere_radiance(center: Values, radius: Values, f: Callable[..., Values], wo: Values) -> Values:
    """∫ f·cos over the part of a sphere light above the horizon, whose centre is not straight above.

    Lines of latitude; where the ends of the heights are tangent to the circle, substitution removes the root.
    """
    distance = np.sqrt(center @ center)
    cos_s = np.sqrt(1 - (radius / distance) ** 2)
    sin_s, z, across = radius / distance, center[2] / distance, np.sqrt(center[0] ** 2 + center[1] ** 2)
    x, y = center[0] / across, center[1] / across
    across = across / distance
    top, bottom = z * cos_s + across * sin_s, z * cos_s - across * sin_s
    assert z.real < cos_s.real, "the pole lies within the light"
    bottom = bottom if bottom.real > 0 else 0 * bottom
    angles = np.pi / 2 * _NODES if bottom.real > 0 else np.pi / 4 + np.pi / 4 * _NODES
    share = np.pi / 2 if bottom.real > 0 else np.pi / 4
    # heights from the middle of both tangent latitudes, or, cut, from the horizon to the upper one
    sine, cosine = np.sin(angles), np.cos(angles)
    if bottom.real > 0:
        middle, half = (top + bottom) / 2, (top - bottom) / 2
        height, step = middle - half * np.cos(2 * angles), half * 2 * np.sin(2 * angles) * share
    else:
        height, step = top * (1 - 2 * cosine**2), top * 4 * sine * cosine * share
    ring = np.sqrt(1 - height**2)
    reach = np.arccos((cos_s - z * height) / (across * ring))
    azimuth = reach[:, None] * (2 * _NODES - 1)
    c, s = np.cos(azimuth), np.sin(azimuth)
    wi = [ring[:, None] * (x * c - y * s), ring[:, None] * (y * c + x * s), height[:, None] + 0 * azimuth]
    values = f(wi, wo) * 2 * reach[:, None]
    return ((values @ _WEIGHTS) * step) @ _WEIGHTS


def polygon_radiance(vertices: Values, f: Callable[..., Values], wo: Values) -> Values:
    """∫ f·cos over the part of a polygon above the horizon: a fan of triangles from its first vertex."""
    kept = []
    for a, b in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if a[2].real >= 0:
            kept.append(a)
        if (a[2].real >= 0) != (b[2].real >= 0):
            kept.append(a + a[2] / (a[2] - b[2]) * (b - a))
    total = 0.0
    for b, c in itertools.pairwise(kept[1:]):
        total = total + _triangle(kept[0], b, c, f, wo)
    return total if total.real > 0 else -total


def _triangle(a: Values, b: Values, c: Values, f: Callable[..., Values], wo: Values) -> Values:
    u, v = _NODES[:, None], _NODES[None, :]
    point = [a[k] + u * (b[k] - a[k] + v * (c[k] - b[k])) for k in range(3)]
    length = np.sqrt(sum(x * x for x in point))
    volume = a @ np.cross(b, c)
    values = f([x / length for x in point], wo) * u * volume / length**3
    return (values @ _WEIGHTS) @ _WEIGHTS


def coefficient(center: list[Any], radius: Any, band: int, degree: int) -> Any:
    """∫ Y_lm over the part of a sphere light above the horizon, in mpmath: lines of latitude, one after the other."""
    m = abs(degree)
    distance = mpmath.sqrt(sum(x * x for x in center))
    sigma, theta = mpmath.asin(radius / distance), mpmath.acos(center[2] / distance)
    azimuth = mpmath.atan2(center[1], center[0])
    scale = mpmath.sqrt((2 * band + 1) / (4 * mpmath.pi) * mpmath.factorial(band - m) / mpmath.factorial(band + m))

    def legendre(z: Any) -> Any:
        """The m-th derivative of Rodrigues' formula, (z² - 1)^l multiplied out."""
        terms = (
            mpmath.binomial(band, k) * (-1) ** (band - k) * mpmath.ff(2 * k, band + m) * z ** (2 * k - band - m)
            for k in range((band + m + 1) // 2, band + 1)
        )
        return scale * (1 - z * z) ** (mpmath.mpf(m) / 2) * sum(terms) / (2**band * mpmath.factorial(band))

    def line(z: Any) -> Any:
        reach = (mpmath.cos(sigma) - z * mpmath.cos(theta)) / (mpmath.sin(theta) * mpmath.sqrt(1 - z * z))
        half = mpmath.acos(max(-1, min(1, reach)))
        return legendre(z) * (2 * mpmath.sin(m * half) / m if m else 2 * half)

    ends = sorted({max(mpmath.mpf(0), mpmath.cos(theta + sigma)), mpmath.cos(abs(theta - sigma))})
    total = mpmath.quad(line, ends) if len(ends) == 2 else mpmath.mpf(0)
    if theta < sigma and m == 0:
        total += 2 * mpmath.pi * mpmath.quad(legendre, [mpmath.cos(sigma - theta), 1])
    turn = mpmath.cos(m * azimuth) if degree >= 0 else mpmath.sin(m * azimuth)
    return total * turn * (mpmath.sqrt(2) if m else 1)
