# SPDX-License-Identifier: MIT
"""Random lights and directions for hypothesis, and small helpers that several tests share."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# The same examples on every run, however slow the machine.
reproducible = settings(derandomize=True, deadline=None, max_examples=60)

orders = st.integers(1, 20)
angles = st.floats(-math.pi, math.pi)


@st.composite
def directions(draw: st.DrawFn) -> Floats:
    tilt = draw(st.floats(0, math.pi))
    azimuth = draw(angles)
    return np.array([math.sin(tilt) * math.cos(azimuth), math.sin(tilt) * math.sin(azimuth), math.cos(tilt)])


@st.composite
def spheres(draw: st.DrawFn) -> tuple[Floats, float]:
    """Centre and radius: any direction, half angles down to a micro-radian."""
    distance = 10 ** draw(st.floats(-2, 2))
    half_angle = 10 ** draw(st.floats(-6, 0.17))
    return distance * draw(directions()), distance * math.sin(half_angle)


@st.composite
def polygons(draw: st.DrawFn) -> Floats:
    """Planar, star-shaped, above the horizon or across it."""
    tilt = draw(st.floats(0, 1.5))
    azimuth = draw(angles)
    center = np.array([math.sin(tilt) * math.cos(azimuth), math.sin(tilt) * math.sin(azimuth), math.cos(tilt)])
    normal = center + 0.7 * draw(directions())
    u = np.cross(normal, [0.3, -0.5, 0.8])
    u /= np.linalg.norm(u)
    v = np.cross(normal, u)
    v /= np.linalg.norm(v)
    count = draw(st.integers(3, 6))
    size = 10 ** draw(st.floats(-2, 0.5))
    corners = []
    for i in range(count):
        angle = 2 * math.pi * (i + draw(st.floats(0, 0.7))) / count
        corners.append(center + size * draw(st.floats(0.4, 1)) * (math.cos(angle) * u + math.sin(angle) * v))
    return np.array(corners)


def turn(angle: float) -> Floats:
    """Rotation about z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def turned(coefficients: Floats, angle: float) -> Floats:
    """Coefficients of an expansion that was turned about z: each pair ±m by m times the angle."""
    result = np.array(coefficients)
    for l in range(math.isqrt(coefficients.shape[-1])):  # noqa: E741
        middle = l * l + l
        for m in range(1, l + 1):
            c, s = math.cos(m * angle), math.sin(m * angle)
            cosine, sine = coefficients[..., middle + m], coefficients[..., middle - m]
            result[..., middle + m] = c * cosine - s * sine
            result[..., middle - m] = s * cosine + c * sine
    return result
