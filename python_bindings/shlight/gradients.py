# SPDX-License-Identifier: MIT
"""What `gradient=True` adds to a result: its exact derivatives [1/length], as tuples with names.

Axes follow jax.jacobian: those of the result, then those of what it is derived by. docs/theory.md, 9, derives them.
"""

from __future__ import annotations

from typing import NamedTuple

from shlight._arrays import Floats


class CoefficientGradient(NamedTuple):
    """Derivatives of the coefficients (..., order²) of sphere lights."""

    center: Floats
    """(..., order², 3)"""
    radius: Floats
    """(..., order²)"""


class SphereGradient(NamedTuple):
    """Derivatives of the radiance (..., 3) that is reflected of sphere lights."""

    center: Floats
    """(..., 3, 3): RGB by x, y, z."""
    radius: Floats
    """(..., 3)"""
    roughness: Floats
    """(..., 3): by the roughness of all GGX lobes of the material together, at given weights of the lobes.
    (..., 0) with gradient="places"."""


class PolygonGradient(NamedTuple):
    """Derivatives of the radiance (..., 3) that is reflected of polygon lights."""

    vertices: Floats
    """(..., 3, k, 3): RGB by x, y, z of k vertices."""
    roughness: Floats
    """(..., 3): as of SphereGradient."""
