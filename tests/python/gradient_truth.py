# SPDX-License-Identifier: MIT
"""Derivatives of integrals of f·cos over lights by other means than the library's: by steps into the complex plane
through cubature over the light's interior.

Im f(x + ih)/h is f′(x) to h² without cancellation, where f is analytic: h may be 1e-30.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

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
