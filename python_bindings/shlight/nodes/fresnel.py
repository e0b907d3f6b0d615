# SPDX-License-Identifier: MIT
"""What the surface of a dielectric reflects."""

from __future__ import annotations

from shlight.nodes.values import Number, Value, number, select, sqrt


def head_on(ior: Number) -> Value:
    """The reflectance of a dielectric for light along the normal."""
    i = number(ior)
    root = (i - 1.0) / (i + 1.0)
    return root * root


def fresnel_of(cosine: Value, ior: Value) -> Value:
    """The reflectance of a dielectric, 1 under total reflection."""
    c = abs(cosine)
    square = ior * ior - 1.0 + c * c
    g = sqrt(square)
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return select(square > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)
