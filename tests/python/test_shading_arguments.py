# SPDX-License-Identifier: MIT
"""shade_spheres and shade_polygons: shapes, types, threads, effort, given orders, and errors that name the argument."""

from __future__ import annotations

import math

import numpy as np
import pytest
from lobe_cubature import over_sphere
from shading_cases import MATERIALS
from strategies import Floats

import shlight
from shlight import Bsdf

BSDF = Bsdf.ggx(0.3, [0.9, 0.5, 0.1])
TRIANGLE = [[1, 0, 1], [0, 1, 1], [-1, -1, 1]]


@pytest.mark.parametrize(
    ("lights", "sizes", "views", "expected"),
    [
        ((), (), (), ()),
        ((4,), (), (), (4,)),
        ((), (4,), (), (4,)),
        ((), (), (4,), (4,)),
        ((5, 1), (4,), (), (5, 4)),
        ((2, 1, 3), (2, 1), (1, 1, 1), (2, 2, 3)),
        ((0,), (), (), (0,)),
        ((3, 0), (1,), (3, 1), (3, 0)),
    ],
)
def test_leading_axes_broadcast(
    lights: tuple[int, ...], sizes: tuple[int, ...], views: tuple[int, ...], expected: tuple[int, ...]
) -> None:
    center = np.array([-0.5, 0.2, 0.4])
    for result in (
        shlight.shade_spheres(
            np.broadcast_to(center, (*lights, 3)), np.full(sizes, 0.3), BSDF, np.full(views, 0.5), return_effort=True
        ),
        shlight.shade_polygons(
            np.broadcast_to(TRIANGLE, (*np.broadcast_shapes(lights, sizes), 3, 3)),
            BSDF,
            np.full(views, 0.5),
            return_effort=True,
        ),
    ):
        radiance, effort = result
        assert radiance.shape == (*expected, 3)
        assert radiance.dtype == np.float32
        assert np.shape(effort) == expected
        assert effort.dtype == np.int32
        assert radiance.size == 0 or (np.ptp(radiance.reshape(-1, 3), axis=0).max() == 0 and np.all(effort > 0))


def test_each_light_has_its_own_view() -> None:
    """Batches give what single calls give, in every order of views."""
    rng = np.random.default_rng(7)
    centers, radii = rng.normal([0, 0, 1.5], size=(30, 3)), rng.uniform(0.01, 0.2, 30)
    quads = centers[:, None] + 0.3 * rng.normal(size=(30, 3, 3))
    views = rng.choice([0.1, 0.5, 0.9, 1.0], 30)
    balls = shlight.shade_spheres(centers, radii, BSDF, views)
    triangles = shlight.shade_polygons(quads, BSDF, views)
    for i in range(30):
        np.testing.assert_array_equal(balls[i], shlight.shade_spheres(centers[i], radii[i], BSDF, views[i]))
        np.testing.assert_array_equal(triangles[i], shlight.shade_polygons(quads[i], BSDF, views[i]))


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64, np.int8])
def test_any_real_type_will_do(dtype: type) -> None:
    center, triangle = np.array([-1, 1, 2], dtype), np.array(TRIANGLE, dtype)
    view = np.array(1, dtype)
    expected = shlight.shade_spheres([-1.0, 1.0, 2.0], 1.0, BSDF, 1.0)
    np.testing.assert_array_equal(shlight.shade_spheres(center, np.array(1, dtype), BSDF, view), expected)
    expected = shlight.shade_polygons(np.array(TRIANGLE, float), BSDF, 1.0)
    np.testing.assert_array_equal(shlight.shade_polygons(triangle, BSDF, view), expected)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_no_bit(threads: int) -> None:
    rng = np.random.default_rng(9)
    centers = rng.normal(size=(1003, 3))
    radii = np.linalg.norm(centers, axis=1) * rng.uniform(0.01, 0.99, 1003)
    vertices = centers[:, None, :] + 0.5 * rng.normal(size=(1003, 3, 3))
    views = rng.uniform(0, 1, 1003)
    for call in (
        lambda n: shlight.shade_spheres(centers, radii, BSDF, views, threads=n, return_effort=True),
        lambda n: shlight.shade_polygons(vertices, BSDF, views, threads=n, return_effort=True),
    ):
        for single, many in zip(call(threads), call(0), strict=True):
            assert single.tobytes() == many.tobytes()


def test_hidden_lights_give_zeros() -> None:
    for result in (
        shlight.shade_spheres([0.3, 0, -2], 1, BSDF, 0.5, return_effort=True),
        shlight.shade_polygons(-np.array(TRIANGLE), BSDF, 0.5, return_effort=True),
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [3, 0, 3]], BSDF, 0.5, return_effort=True),  # no area
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [2, 0, 1]], BSDF, 0.5, return_effort=True),  # edge-on
        shlight.shade_spheres([0, 0, 2], 1, Bsdf.lambert(0), 0.5, return_effort=True),
    ):
        radiance, effort = result
        assert not radiance.any()
        assert effort == 0


@pytest.mark.parametrize("order", [1, 2, 5, 8, 64])
def test_a_given_order_is_taken_as_far_as_there_are_bands(order: int) -> None:
    lights = [[0, 0, 1], [-1, 0, 0.1], [-2, 0, 2]]
    radii = [1e-3, 0.5, 1]
    lambert = Bsdf.lambert(0.5)
    for bsdf, taken in ((BSDF, order), (lambert, min(order, 2)), (MATERIALS["plastic"], order)):
        _, effort = shlight.shade_spheres(lights, radii, bsdf, 0.5, order=order, return_effort=True)
        np.testing.assert_array_equal(effort, taken)
        _, effort = shlight.shade_polygons(TRIANGLE, bsdf, 0.5, order=order, return_effort=True)
        assert effort == taken


def test_higher_orders_are_closer() -> None:
    center, radius, bsdf = [-0.8, 0.1, 0.7], 0.3, Bsdf.ggx(0.3, 1)
    expected = over_sphere(bsdf, 0.6, np.array(center), radius)[0]
    errors = [abs(shlight.shade_spheres(center, radius, bsdf, 0.6, order=n)[0] - expected) for n in (2, 6, 16)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] <= 1e-4


def with_sphere(**options: object) -> Floats:
    arguments = {"centers": [0, 0, 2], "radii": 1, "cos_theta_o": 0.5} | options
    return shlight.shade_spheres(bsdf=BSDF, **arguments)  # type: ignore[call-overload]


def with_polygon(**options: object) -> Floats:
    arguments = {"vertices": TRIANGLE, "cos_theta_o": 0.5} | options
    return shlight.shade_polygons(bsdf=BSDF, **arguments)  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(("order", bad) for bad in (0, -1, 65, 2.5, "8", "x", None, [8])),
        *(("tolerance", bad) for bad in (0, -1e-3, math.nan, math.inf, "fine", None, [1e-3, 1e-2])),
        *(("cos_theta_o", bad) for bad in (-0.01, 1.001, math.nan, math.inf, "up", None, [0.5, 2], 1j)),
        *(("threads", bad) for bad in (-1, 1.5, None)),
    ],
)
def test_bad_settings_are_named(argument: str, value: object) -> None:
    for call in (with_sphere, with_polygon):
        with pytest.raises(ValueError, match=argument):
            call(**{argument: value})


@pytest.mark.parametrize("bad", [[math.nan, 0, 1], [0, -math.inf, 1], [1, 2], 1.0, [[1, 2, 3, 4]], "up", None])
def test_bad_centers_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="centers"):
        with_sphere(centers=bad)


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, "big", None, [0.5, -0.5], [math.nan, 1], 2.001])
def test_bad_radii_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="radii"):
        with_sphere(radii=bad)


@pytest.mark.parametrize(
    "bad",
    [
        TRIANGLE[:2],
        [TRIANGLE[:2]] * 3,
        [],
        [1, 2, 3],
        [[1, 2]] * 3,
        [[math.nan, 0, 1], *TRIANGLE[1:]],
        [[math.inf, 0, 1], *TRIANGLE[1:]],
        [*TRIANGLE, [0, 0, 3]],  # not planar
        "square",
        None,
    ],
)
def test_bad_vertices_are_named(bad: object) -> None:
    with pytest.raises(ValueError, match="vertices"):
        with_polygon(vertices=bad)


def test_axes_that_do_not_broadcast_are_named() -> None:
    with pytest.raises(ValueError, match="radii"):
        with_sphere(centers=[[0, 0, 2]] * 2, radii=[1, 1, 1])
    with pytest.raises(ValueError, match="cos_theta_o"):
        with_polygon(vertices=[TRIANGLE] * 2, cos_theta_o=[0.5] * 3)


@pytest.mark.parametrize("bad", [None, 0.5, "ggx"])
def test_a_material_must_be_one(bad: object) -> None:
    with pytest.raises(TypeError):
        shlight.shade_spheres([0, 0, 2], 1, bad, 0.5)  # type: ignore[call-overload]
