# SPDX-License-Identifier: MIT
"""Integrates the tables of `shlight.nodes.energy`, over an even grid of visible normals (Heitz 2018).

`python -m shlight_tools.energy` writes the file that the package keeps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.energy import KEPT

Array = NDArray[np.float64]

LEAST = 1e-4  # of roughness, cosine and parameter of the index
LARGEST_PARAMETER = 0.99
RINGS, SPOKES = 48, 96


def _visible_normals(view: Array, alpha: float) -> Array:
    """Normals (n, 3) that the viewer sees, evenly."""
    radius = np.sqrt((np.arange(RINGS) + 0.5) / RINGS)[:, None]
    angle = 2.0 * np.pi * (np.arange(SPOKES) + 0.5) / SPOKES
    x, y = (radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel()
    stretched = np.array([alpha * view[0], 0.0, view[2]])
    stretched /= np.linalg.norm(stretched)
    mix = 0.5 * (1.0 + stretched[2])
    across = (1.0 - mix) * np.sqrt(np.maximum(1.0 - x * x, 0.0)) + mix * y
    up = np.sqrt(np.maximum(1.0 - x * x - across * across, 0.0))
    normal = np.stack(
        [
            alpha * (stretched[0] * up - stretched[2] * across),
            alpha * x,
            np.maximum(stretched[0] * across + stretched[2] * up, 0.0),
        ],
        axis=1,
    )
    unit: Array = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return unit


def _seen_share(alpha: float, cosine: float, other: Array) -> Array:
    """G2 / G1 of the viewer's side, by the cosine of the other direction; 0 where that is 0."""

    def smith(c: Any) -> Array:
        return np.asarray(0.5 * (np.sqrt(1.0 + alpha * alpha * np.maximum(1.0 / np.square(c) - 1.0, 0.0)) - 1.0))

    own, seen = 1.0 + smith(cosine), other > 0.0
    return np.where(seen, own / (own + smith(np.where(seen, other, 1.0))), 0.0)


def _reflected(roughness: float, cosine: float) -> tuple[Array, Array, Array, Array]:
    """For each visible normal: its cosine to the view, its z, whether the light goes up, and G2 / G1."""
    alpha = roughness * roughness
    view = np.array([np.sqrt(1.0 - cosine * cosine), 0.0, cosine])
    normals = _visible_normals(view, alpha)
    along = normals @ view
    height = 2.0 * along * normals[:, 2] - cosine
    up = height > 0.0

    return along, normals[:, 2], up, _seen_share(alpha, cosine, np.where(up, height, 0.0))


def _steps(count: int) -> Array:
    return np.clip(np.arange(count) / (count - 1), LEAST, 1.0)


def _dielectric(cosine: Array, ior: Array) -> Array:
    g = np.sqrt(ior * ior - 1.0 + cosine * cosine)
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.asarray(0.5 * a * a * (1.0 + b * b))


def _kept(roughness: float, cosine: float, ior: float) -> float:
    """The share of light that an interface reflects or lets through at once. ior: of the other side."""
    along, height, _, reflected = _reflected(roughness, cosine)
    square = 1.0 - (1.0 - along * along) / (ior * ior)  # of the cosine at which light goes on
    passes = square > 0.0
    fresnel = np.where(passes, _dielectric(along, np.asarray(np.where(passes, ior, 2.0))), 1.0)
    depth = cosine / ior - (along / ior - np.sqrt(np.maximum(square, 0.0))) * height
    passed = _seen_share(roughness * roughness, cosine, np.where(passes, np.maximum(depth, 0.0), 0.0))
    return float((fresnel * reflected + (1.0 - fresnel) * passed).mean())


def _roots() -> Array:
    """Roots of the reflectance head-on, by the parameter of the index."""
    return np.asarray(np.clip(np.arange(16) / 15, LEAST, LARGEST_PARAMETER) ** 2, np.float64)


def _indices(inside: bool = False) -> Array:
    root = _roots()
    outer = (1.0 + root) / (1.0 - root)
    return np.asarray(1.0 / outer if inside else outer)


def _over_views(at: Callable[[float], float], count: int) -> float:
    """The mean over views, weighted by their cosine."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    cosines, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    return sum(2.0 * w * c * at(c) for c, w in zip(cosines, weights, strict=True))


def interface_table(inside: bool) -> Array:
    """This share over the parameter of the index (outermost), cosine and roughness."""
    return np.array([[[_kept(r, c, n) for r in _steps(16)] for c in _steps(16)] for n in _indices(inside)])


def mean_interface_table(inside: bool) -> Array:
    """The same over all views, weighted by their cosine."""

    def mean(roughness: float, ior: float) -> float:
        return _over_views(lambda cosine: _kept(roughness, cosine, ior), 12)

    return np.array([[mean(r, n) for r in _steps(16)] for n in _indices(inside)])


def albedo_table() -> Array:
    """Albedo of a lobe without Fresnel's factor, over cosine (rows) and roughness."""
    return np.array([[_reflected(r, c)[3].mean() for r in _steps(32)] for c in _steps(32)])


def mean_albedo_table() -> Array:
    """The same over all views, weighted by their cosine."""

    def mean(roughness: float) -> float:
        return _over_views(lambda cosine: float(_reflected(roughness, cosine)[3].mean()), 24)

    return np.array([mean(r) for r in _steps(32)])


def rise_table() -> Array:
    """How far Fresnel's curve has risen from its value head-on to 1, on average over the microfacets that are seen.

    Over the parameter of the index (outermost), cosine and roughness.
    """
    root, ior = _roots(), _indices()
    values = np.empty((16, 16, 16))
    for row, cosine in enumerate(_steps(16)):
        for column, roughness in enumerate(_steps(16)):
            along, _, up, _ = _reflected(roughness, cosine)
            head_on = (root**2)[:, None]
            rise = (_dielectric(along[None], ior[:, None]) - head_on) / (1.0 - head_on)
            values[:, row, column] = (np.clip(rise, 0.0, 1.0) * up).mean(axis=1)
    return values


TABLES: dict[str, Callable[[], Array]] = {
    "albedo": albedo_table,
    "mean_albedo": mean_albedo_table,
    "rise": rise_table,
    "interface": lambda: interface_table(False),
    "interface_inside": lambda: interface_table(True),
    "mean_interface": lambda: mean_interface_table(False),
    "mean_interface_inside": lambda: mean_interface_table(True),
}

if __name__ == "__main__":
    np.savez(KEPT, **{name: compute().astype(np.float32) for name, compute in TABLES.items()})
