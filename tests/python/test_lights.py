# SPDX-License-Identifier: MIT
"""Coefficients of lights: what must hold for any light of any kind, and independent values for a few."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from strategies import Floats, angles, directions, orders, polygons, reproducible, spheres, turn, turned

import shlight

FUNCTIONS = {
    "sphere": shlight.sphere_coefficients,
    "polygon": shlight.polygon_coefficients,
    "disk": shlight.disk_coefficients,
}


@dataclass(frozen=True)
class Light:
    """points: centre of a sphere; vertices of a polygon; centre and half axes of an ellipse."""

    kind: str
    points: Floats
    radius: float = 0.0

    def coefficients(self, order: int, dtype: Any = np.float64, **options: Any) -> Floats:
        given = {"sphere": (self.points, self.radius), "polygon": (self.points,), "disk": tuple(self.points)}
        return FUNCTIONS[self.kind](*given[self.kind], order, dtype=dtype, **options)

    def turned(self, matrix: Floats) -> Light:
        return replace(self, points=self.points @ matrix.T)

    def scaled(self, factor: float) -> Light:
        return replace(self, points=factor * self.points, radius=factor * self.radius)

    def whole(self) -> float:
        return float(self.coefficients(1, clip=False)[0])


@st.composite
def disks(draw: st.DrawFn) -> Light:
    """Half axes conjugate but in general not at right angles; anywhere, thin and near ones, too."""
    center, u, v = (10 ** draw(st.floats(low, 1)) * draw(directions()) for low in (-1, -2, -2))
    area = np.linalg.norm(np.cross(u, v))
    assume(area > 1e-3 * np.linalg.norm(u) * np.linalg.norm(v))
    assume(abs(center @ np.cross(u, v)) > 1e-4 * area * np.linalg.norm(center))
    return Light("disk", np.array([center, u, v]))


KINDS = {
    "sphere": spheres().map(lambda sphere: Light("sphere", *sphere)),
    "polygon": polygons().map(lambda vertices: Light("polygon", vertices)),
    "disk": disks(),
}
all_kinds = pytest.mark.parametrize("kind", KINDS)


# --- what must hold for any light ---------------------------------------------------------------------------------


@all_kinds
@reproducible
@given(st.data(), angles, st.integers(-20, 20), orders)
def test_turned_and_scaled_scenes(kind: str, data: st.DataObject, angle: float, exponent: int, order: int) -> None:
    light = data.draw(KINDS[kind])
    before = light.coefficients(order)
    after = light.turned(turn(angle)).coefficients(order)
    np.testing.assert_allclose(after, turned(before, angle), atol=1e-11 * light.whole())
    np.testing.assert_allclose(light.scaled(2.0**exponent).coefficients(order), before, atol=1e-13 * light.whole())


@all_kinds
@reproducible
@given(st.data(), orders)
def test_upper_and_lower_halves_sum_to_the_whole(kind: str, data: st.DataObject, order: int) -> None:
    light = data.draw(KINDS[kind])
    mirror_signs = np.array([(-1.0) ** (l - m) for l in range(order) for m in range(-l, l + 1)])  # noqa: E741
    below = mirror_signs * light.turned(np.diag([1.0, 1, -1])).coefficients(order)
    whole = light.coefficients(order, clip=False)
    np.testing.assert_allclose(light.coefficients(order) + below, whole, atol=1e-11 * whole[0])


@all_kinds
@reproducible
@given(st.data(), orders)
def test_float32_is_close_to_float64(kind: str, data: st.DataObject, order: int) -> None:
    light = data.draw(KINDS[kind])
    points = light.points[:3] if kind == "polygon" else light.points  # three vertices stay planar when rounded
    single = replace(light, points=points.astype(np.float32), radius=float(np.float32(light.radius)))
    tolerance = {"sphere": 2e-4, "polygon": 1e-4, "disk": 1e-5}[kind] * max(single.whole(), 1e-6)
    np.testing.assert_allclose(single.coefficients(order, np.float32), single.coefficients(order), atol=tolerance)


@reproducible
@given(polygons(), st.integers(0, 5), st.floats(0.1, 0.9), orders)
def test_winding_first_vertex_and_parts_of_polygons(vertices: Floats, first: int, share: float, order: int) -> None:
    light = Light("polygon", vertices)
    expected = light.coefficients(order)
    for same in (vertices[::-1], np.roll(vertices, first, axis=0)):
        np.testing.assert_allclose(
            replace(light, points=same).coefficients(order), expected, atol=1e-10 * light.whole()
        )
    a, b, c = vertices[:3]
    cut = (1 - share) * b + share * c  # a triangle, cut from one corner to the opposite side
    whole, *parts = (Light("polygon", np.array(corners)) for corners in ([a, b, c], [a, b, cut], [a, cut, c]))
    total = sum(part.coefficients(order) for part in parts)
    np.testing.assert_allclose(total, whole.coefficients(order), atol=1e-10 * whole.whole())


# --- independent values -------------------------------------------------------------------------------------------


def cap_by_mpmath(tilt: float, half_angle: float, l: int, m: int) -> float:  # noqa: E741
    """∫ P̄_l^m cos mφ over a cap above the horizon by circles of latitude, whose longitudes are known in closed form."""
    with mpmath.workdps(30):
        tilt, half_angle = mpmath.mpf(tilt), mpmath.mpf(half_angle)
        norm = mpmath.sqrt((2 * l + 1) / (4 * mpmath.pi) * mpmath.factorial(l - m) / mpmath.factorial(l + m))

        def legendre(z: mpmath.mpf) -> mpmath.mpf:  # Rodrigues, without Condon–Shortley phase
            derivative = mpmath.diff(lambda t: (t * t - 1) ** l, z, l + m) if l + m else mpmath.mpf(1)
            return norm * (1 - z * z) ** (mpmath.mpf(m) / 2) * derivative / (2**l * mpmath.factorial(l))

        def circle(colatitude: mpmath.mpf) -> mpmath.mpf:
            s, c = mpmath.sin(colatitude), mpmath.cos(colatitude)
            cosine = (mpmath.cos(half_angle) - c * mpmath.cos(tilt)) / (s * mpmath.sin(tilt))
            arc = mpmath.acos(max(min(cosine, mpmath.mpf(1)), mpmath.mpf(-1)))
            return legendre(c) * s * (2 * mpmath.sin(m * arc) / m if m else 2 * arc)

        low, high = abs(tilt - half_angle), min(tilt + half_angle, mpmath.pi / 2)
        start = [mpmath.mpf(0)] if half_angle > tilt else []
        return float((math.sqrt(2) if m else 1) * mpmath.quad(circle, [*start, low, high]))


@pytest.mark.parametrize(("tilt", "half_angle"), [(1.3, 0.5), (1.7, 0.3), (0.4, 0.2), (1.2, 1.4), (1.57, 0.01)])
def test_caps_agree_with_mpmath(tilt: float, half_angle: float) -> None:
    axis = [math.sin(tilt), 0, math.cos(tilt)]
    computed = shlight.cap_coefficients(axis, half_angle, 5, dtype=np.float64)
    for l, m in [(0, 0), (1, 0), (1, 1), (2, 1), (3, 0), (3, 2), (4, 3), (4, 4)]:  # noqa: E741
        expected = cap_by_mpmath(tilt, half_angle, l, m)
        assert computed[l * l + l + m] == pytest.approx(expected, abs=1e-12 * computed[0])


def test_octant() -> None:
    octant = shlight.polygon_coefficients(np.eye(3), 2, dtype=np.float64)
    first_band = math.sqrt(3 / (4 * math.pi)) * math.pi / 4
    np.testing.assert_allclose(octant, [math.sqrt(math.pi) / 4, first_band, first_band, first_band], atol=1e-14)


@reproducible
@given(disks(), st.booleans())
def test_polygons_of_many_sides_come_near_disks(disk: Light, clip: bool) -> None:
    center, u, v = disk.points
    sides = 100
    around = 2 * np.pi * np.arange(sides) / sides
    # The polygon has the disk's area; the difference is of fourth order at a distance, of second order close by.
    radius = math.sqrt(2 * math.pi / sides / math.sin(2 * math.pi / sides))
    vertices = center + radius * (np.outer(np.cos(around), u) + np.outer(np.sin(around), v))
    polygon = shlight.polygon_coefficients(vertices, 8, dtype=np.float64, clip=clip)
    np.testing.assert_allclose(disk.coefficients(8, clip=clip), polygon, atol=5e-3 * disk.whole())


def test_hidden_lights_give_zeros() -> None:
    assert not shlight.sphere_coefficients([0, 0, -2], 1, 8).any()
    assert not shlight.cap_coefficients([0.1, 0, -1], 0.5, 8).any()
    assert not shlight.polygon_coefficients([[1, 0, -1], [0, 1, -1], [-1, -1, -1]], 8).any()
    for dtype in (np.float32, np.float64):
        for center, u, v in (
            ([3, 0, 1], [1, 0, 0], [0, 0, 1]),  # edge-on
            ([0, 0, -1], [1, 0, 0.5], [0, 1, 0]),
            ([3, 0, 0], [1, 0, 0], [0, 1, 0]),  # in the horizon's plane
        ):
            assert not shlight.disk_coefficients(center, u, v, 5, dtype=dtype).any()


def test_triangles_with_a_vertex_far_away() -> None:
    triangle = np.array([[-1.4e12, 2.4e13, -0.09], [1.0, 1.6335, 0.2551], [-0.0926, -0.8833, -0.904]], np.float32)
    expected = shlight.polygon_coefficients(triangle.astype(np.float64), 4, dtype=np.float64)
    np.testing.assert_allclose(shlight.polygon_coefficients(triangle, 4), expected, rtol=0, atol=1e-7)


def test_solid_angles_are_not_negative() -> None:
    """Rounding to floats takes the vertices off the plane of the polygon, which all but holds the shading point."""
    rng = np.random.default_rng(4)
    u, v = rng.normal(size=(2, 2000, 1, 3))
    angles = np.linspace(0, 2 * np.pi, 8, endpoint=False)[:, None]
    tilt = 10 ** rng.uniform(-9, -5, (2000, 1, 1)) * rng.normal(size=(2000, 1, 3))
    polygons = (3 * u + u * np.cos(angles) + v * np.sin(angles) + tilt).astype(np.float32)
    solid = shlight.polygon_coefficients(polygons, 1)
    assert (solid >= 0).all()
    assert (solid > 0).any()
