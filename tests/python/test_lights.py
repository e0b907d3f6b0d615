# SPDX-License-Identifier: MIT
"""Light coefficients: what must hold for any light, independent values for a few, and the manners of the functions."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import Floats, angles, directions, orders, polygons, reproducible, spheres, turn, turned

import shlight


def exact_sphere(center: Floats, radius: float, order: int, **options: bool) -> Floats:
    return shlight.sphere_coefficients(center, radius, order, dtype=np.float64, **options)


def exact_polygon(vertices: Floats, order: int, **options: bool) -> Floats:
    return shlight.polygon_coefficients(vertices, order, dtype=np.float64, **options)


def mirror_signs(order: int) -> Floats:
    """What mirroring at the horizon does to coefficients: (-1)^(l-m)."""
    return np.array([(-1.0) ** (l - m) for l in range(order) for m in range(-l, l + 1)])  # noqa: E741


# --- spheres and caps ---------------------------------------------------------------------------------------------


@reproducible
@given(spheres(), angles, orders)
def test_turning_the_scene_turns_the_coefficients_of_spheres(
    sphere: tuple[Floats, float], angle: float, order: int
) -> None:
    center, radius = sphere
    before = exact_sphere(center, radius, order)
    whole = exact_sphere(center, radius, 1, clip=False)[0]
    after = exact_sphere(turn(angle) @ center, radius, order)
    np.testing.assert_allclose(after, turned(before, angle), atol=1e-11 * whole)


@reproducible
@given(spheres(), st.integers(-20, 20), orders)
def test_scale_does_not_matter_for_spheres(sphere: tuple[Floats, float], exponent: int, order: int) -> None:
    center, radius = sphere
    scale = 2.0**exponent
    whole = exact_sphere(center, radius, 1, clip=False)[0]
    np.testing.assert_allclose(
        exact_sphere(scale * center, scale * radius, order), exact_sphere(center, radius, order), atol=1e-14 * whole
    )


@reproducible
@given(spheres(), orders)
def test_upper_and_lower_halves_sum_to_the_whole(sphere: tuple[Floats, float], order: int) -> None:
    center, radius = sphere
    below = mirror_signs(order) * exact_sphere(center * [1, 1, -1], radius, order)
    whole = exact_sphere(center, radius, order, clip=False)
    np.testing.assert_allclose(exact_sphere(center, radius, order) + below, whole, atol=1e-11 * whole[0])


@reproducible
@given(spheres(), orders)
def test_spheres_are_caps_of_their_half_angle(sphere: tuple[Floats, float], order: int) -> None:
    center, radius = sphere
    half_angle = math.asin(radius / np.linalg.norm(center))
    cap = shlight.cap_coefficients(center, half_angle, order, dtype=np.float64)
    # A half angle in doubles does not say where a grazing cap ends as exactly as centre and radius do.
    whole = exact_sphere(center, radius, 1, clip=False)[0]
    np.testing.assert_allclose(exact_sphere(center, radius, order), cap, atol=1e-7 * whole)


@reproducible
@given(directions(), st.floats(0.01, 3.13), orders)
def test_cap_and_the_rest_sum_to_the_hemisphere(axis: Floats, half_angle: float, order: int) -> None:
    cap = shlight.cap_coefficients(axis, half_angle, order, dtype=np.float64)
    rest = shlight.cap_coefficients(-axis, math.pi - half_angle, order, dtype=np.float64)
    hemisphere = shlight.cap_coefficients([0, 0, 1], math.pi / 2, order, dtype=np.float64)
    np.testing.assert_allclose(cap + rest, hemisphere, atol=1e-7)


@reproducible
@given(spheres(), orders)
def test_float32_spheres_are_close_to_float64(sphere: tuple[Floats, float], order: int) -> None:
    center, radius = sphere[0].astype(np.float32), np.float32(sphere[1])
    whole = exact_sphere(center, radius, 1, clip=False)[0]
    single = shlight.sphere_coefficients(center, radius, order)
    np.testing.assert_allclose(single, exact_sphere(center, radius, order), atol=2e-4 * whole)


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


# --- polygons -----------------------------------------------------------------------------------------------------


@reproducible
@given(polygons(), angles, orders)
def test_turning_the_scene_turns_the_coefficients_of_polygons(vertices: Floats, angle: float, order: int) -> None:
    before = exact_polygon(vertices, order)
    after = exact_polygon(vertices @ turn(angle).T, order)
    np.testing.assert_allclose(after, turned(before, angle), atol=1e-10 * max(before[0], 1e-6))


@reproducible
@given(polygons(), st.integers(0, 5), orders)
def test_winding_and_first_vertex_do_not_matter(vertices: Floats, first: int, order: int) -> None:
    expected = exact_polygon(vertices, order)
    for same in (vertices[::-1], np.roll(vertices, first, axis=0)):
        np.testing.assert_allclose(exact_polygon(same, order), expected, atol=1e-10 * max(expected[0], 1e-6))


@reproducible
@given(polygons(), st.integers(-20, 20), orders)
def test_scale_does_not_matter_for_polygons(vertices: Floats, exponent: int, order: int) -> None:
    expected = exact_polygon(vertices, order)
    np.testing.assert_allclose(exact_polygon(2.0**exponent * vertices, order), expected, rtol=1e-14, atol=1e-300)


@reproducible
@given(polygons(), st.floats(0.1, 0.9), orders)
def test_parts_sum_to_the_whole(vertices: Floats, share: float, order: int) -> None:
    """A triangle, cut from one corner to the opposite side."""
    a, b, c = vertices[:3]
    cut = (1 - share) * b + share * c
    whole = exact_polygon(np.array([a, b, c]), order)
    parts = exact_polygon(np.array([a, b, cut]), order) + exact_polygon(np.array([a, cut, c]), order)
    np.testing.assert_allclose(parts, whole, atol=1e-10 * max(whole[0], 1e-6))


@reproducible
@given(polygons(), orders)
def test_polygon_halves_sum_to_the_whole(vertices: Floats, order: int) -> None:
    below = mirror_signs(order) * exact_polygon(vertices * [1, 1, -1], order)
    whole = exact_polygon(vertices, order, clip=False)
    np.testing.assert_allclose(exact_polygon(vertices, order) + below, whole, atol=1e-10 * max(whole[0], 1e-6))


@reproducible
@given(polygons(), orders)
def test_float32_polygons_are_close_to_float64(vertices: Floats, order: int) -> None:
    triangle = vertices[:3].astype(np.float32)  # three vertices stay planar when rounded
    exact = exact_polygon(triangle, order)
    single = shlight.polygon_coefficients(triangle, order)
    np.testing.assert_allclose(single, exact, atol=1e-4 * max(exact[0], 1e-6))


def test_octant() -> None:
    octant = exact_polygon(np.eye(3), 2)
    first_band = math.sqrt(3 / (4 * math.pi)) * math.pi / 4
    np.testing.assert_allclose(octant, [math.sqrt(math.pi) / 4, first_band, first_band, first_band], atol=1e-14)


# --- manners ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("axes", "angles_shape", "expected"),
    [
        ((), (), ()),
        ((4,), (), (4,)),
        ((), (4,), (4,)),
        ((5, 1), (4,), (5, 4)),
        ((0,), (), (0,)),
        ((2, 1, 3), (2, 1), (2, 2, 3)),
    ],
)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_leading_axes_broadcast(
    axes: tuple[int, ...], angles_shape: tuple[int, ...], expected: tuple[int, ...], dtype: type
) -> None:
    centers = np.broadcast_to([0.5, 0.2, 0.4], (*axes, 3))
    sizes = np.full(angles_shape, 0.3)
    for function in (shlight.sphere_coefficients, shlight.cap_coefficients):
        result = function(centers, sizes, 3, dtype=dtype)
        assert result.shape == (*expected, 9)
        assert result.dtype == dtype
        assert result.size == 0 or np.ptp(result.reshape(-1, 9), axis=0).max() == 0


def test_polygons_take_leading_axes() -> None:
    vertices = np.array([[1, 0, 1], [0, 1, 1], [-1, 0, 1], [0, -1, 1]])
    single = shlight.polygon_coefficients(vertices, 4)
    assert single.shape == (16,)
    many = shlight.polygon_coefficients(np.broadcast_to(vertices, (2, 3, 4, 3)), 4)
    assert many.shape == (2, 3, 16)
    np.testing.assert_array_equal(many, np.broadcast_to(single, (2, 3, 16)))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_no_bit(threads: int) -> None:
    rng = np.random.default_rng(3)
    centers = rng.normal(size=(2003, 3))
    radii = np.linalg.norm(centers, axis=1) * rng.uniform(0.01, 0.99, 2003)
    vertices = centers[:, None, :] + 0.5 * rng.normal(size=(2003, 3, 3))
    for dtype in (np.float32, np.float64):
        calls: list[Callable[[int], Floats]] = [
            lambda n, t=dtype: shlight.sphere_coefficients(centers, radii, 7, dtype=t, threads=n),
            lambda n, t=dtype: shlight.cap_coefficients(centers, radii / 4 % 3 + 0.1, 7, dtype=t, threads=n),
            lambda n, t=dtype: shlight.polygon_coefficients(vertices, 5, dtype=t, threads=n),
        ]
        for call in calls:
            assert call(threads).tobytes() == call(0).tobytes()


def test_hidden_lights_give_zeros() -> None:
    assert not shlight.sphere_coefficients([0, 0, -2], 1, 8).any()
    assert not shlight.cap_coefficients([0.1, 0, -1], 0.5, 8).any()
    assert not shlight.polygon_coefficients([[1, 0, -1], [0, 1, -1], [-1, -1, -1]], 8).any()


# --- bad input ----------------------------------------------------------------------------------------------------

TRIANGLE = [[1, 0, 1], [0, 1, 1], [-1, -1, 1]]


@pytest.mark.parametrize("order", [0, -1, 65, 2.5, "8", None])
def test_bad_order_is_named(order: object) -> None:
    for call in (
        lambda: shlight.sphere_coefficients([0, 0, 2], 1, order),
        lambda: shlight.cap_coefficients([0, 0, 2], 1, order),
        lambda: shlight.polygon_coefficients(TRIANGLE, order),
    ):
        with pytest.raises(ValueError, match="order"):
            call()


@pytest.mark.parametrize("vector", [[math.nan, 0, 1], [0, -math.inf, 1], [1, 2], 1.0, [[1, 2, 3, 4]], "up", None])
def test_bad_vectors_are_named(vector: object) -> None:
    with pytest.raises(ValueError, match="centers"):
        shlight.sphere_coefficients(vector, 0.1, 4)
    with pytest.raises(ValueError, match="axes"):
        shlight.cap_coefficients(vector, 0.1, 4)


@pytest.mark.parametrize("size", [0, -1, math.nan, math.inf, "big", [0.5, -0.5]])
def test_bad_sizes_are_named(size: object) -> None:
    with pytest.raises(ValueError, match="radii"):
        shlight.sphere_coefficients([0, 0, 2], size, 4)
    with pytest.raises(ValueError, match="half_angles"):
        shlight.cap_coefficients([0, 0, 2], size, 4)


def test_shading_point_inside_the_light_is_refused() -> None:
    with pytest.raises(ValueError, match=r"radii.*inside"):
        shlight.sphere_coefficients([0, 0, 1], 1.001, 4)
    with pytest.raises(ValueError, match=r"radii.*inside"):
        shlight.sphere_coefficients([0, 0, 0], 1, 4)
    with pytest.raises(ValueError, match="half_angles"):
        shlight.cap_coefficients([0, 0, 1], 3.15, 4)
    with pytest.raises(ValueError, match="axes"):
        shlight.cap_coefficients([0, 0, 0], 1, 4)


@pytest.mark.parametrize(
    "vertices",
    [
        TRIANGLE[:2],
        [[1, 0, 1, 0]] * 3,
        [1, 2, 3],
        [[1, 0, math.nan], [0, 1, 1], [1, 1, 1]],
        [[1, 0, math.inf], [0, 1, 1], [1, 1, 1]],
        [[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1.5]],
        "square",
    ],
)
def test_bad_vertices_are_named(vertices: object) -> None:
    with pytest.raises(ValueError, match="vertices"):
        shlight.polygon_coefficients(vertices, 4)


def test_other_bad_arguments_are_named() -> None:
    with pytest.raises(ValueError, match=r"centers.*radii"):
        shlight.sphere_coefficients(np.ones((3, 3)), np.full(2, 0.1), 4)
    with pytest.raises(ValueError, match=r"axes.*half_angles"):
        shlight.cap_coefficients(np.ones((3, 3)), np.full(2, 0.1), 4)
    for call in (
        lambda **options: shlight.sphere_coefficients([0, 0, 2], 1, 4, **options),
        lambda **options: shlight.cap_coefficients([0, 0, 2], 1, 4, **options),
        lambda **options: shlight.polygon_coefficients(TRIANGLE, 4, **options),
    ):
        with pytest.raises(ValueError, match="method"):
            call(method="guess")
        with pytest.raises(ValueError, match="dtype"):
            call(dtype=np.int32)
        with pytest.raises(ValueError, match="threads"):
            call(threads=-2)
