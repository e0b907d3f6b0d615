# SPDX-License-Identifier: MIT
"""Manners of the functions that shade: shapes, types, threads, effort, given orders, and errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lobe_cubature import over_sphere
from shading_cases import MATERIALS
from strategies import Floats

import shlight
from shlight import Bsdf

BSDF = Bsdf.ggx(0.3, [0.9, 0.5, 0.1])
TRIANGLE = [[1, 0, 1], [0, 1, 1], [-1, -1, 1]]
LIGHTS: dict[Any, dict[str, Any]] = {
    shlight.shade_spheres: {"centers": [-0.5, 0.2, 0.4], "radii": 0.3},
    shlight.shade_polygons: {"vertices": TRIANGLE},
    shlight.shade_disks: {"centers": [0, 0, 1], "half_axes_u": [1, 0, 0], "half_axes_v": [0, 1, 0]},
}
all_functions = pytest.mark.parametrize("function", LIGHTS, ids=lambda function: function.__name__)


@all_functions
@pytest.mark.parametrize(
    ("lights", "views", "expected"),
    [
        ((), (), ()),
        ((4,), (), (4,)),
        ((), (4,), (4,)),
        ((5, 1), (4,), (5, 4)),
        ((0,), (), (0,)),
        ((3, 0), (3, 1), (3, 0)),
    ],
)
def test_leading_axes_broadcast(
    function: Any, lights: tuple[int, ...], views: tuple[int, ...], expected: tuple[int, ...]
) -> None:
    first, *others = (np.asarray(value, float) for value in LIGHTS[function].values())
    given = [np.broadcast_to(first, (*lights, *first.shape)), *others]
    radiance, effort = function(*given, BSDF, np.full(views, 0.5), return_effort=True)
    assert radiance.shape == (*expected, 3)
    assert radiance.dtype == np.float32
    assert np.shape(effort) == expected
    assert effort.dtype == np.int32
    single, effort_of_one = function(first, *others, BSDF, 0.5, return_effort=True)
    np.testing.assert_array_equal(radiance, np.broadcast_to(single, radiance.shape))
    np.testing.assert_array_equal(effort, np.broadcast_to(effort_of_one, effort.shape))
    assert effort_of_one > 0


def batch(function: Any, count: int) -> tuple[Floats, ...]:
    rng = np.random.default_rng(7)
    centers = rng.normal([0, 0, 1.5], size=(count, 3))
    return {
        shlight.shade_spheres: (centers, np.linalg.norm(centers, axis=1) * rng.uniform(0.01, 0.99, count)),
        shlight.shade_polygons: (centers[:, None] + 0.3 * rng.normal(size=(count, 3, 3)),),
        shlight.shade_disks: (centers, 0.3 * rng.normal(size=(count, 3)), 0.3 * rng.normal(size=(count, 3))),
    }[function]


@all_functions
def test_each_light_has_its_own_view(function: Any) -> None:
    """Batches give what single calls give, in every order of views."""
    lights = batch(function, 30)
    views = np.random.default_rng(8).choice([0.1, 0.5, 0.9, 1.0], 30)
    together = function(*lights, BSDF, views)
    for i in range(30):
        np.testing.assert_array_equal(together[i], function(*(array[i] for array in lights), BSDF, views[i]))


@all_functions
def test_threads_change_no_bit(function: Any) -> None:
    lights = batch(function, 603)
    views = np.random.default_rng(9).uniform(0, 1, 603)
    once = [array.tobytes() for array in function(*lights, BSDF, views, threads=1, return_effort=True)]
    for threads in (0, 2, 5):
        again = function(*lights, BSDF, views, threads=threads, return_effort=True)
        assert [array.tobytes() for array in again] == once


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64, np.int8])
def test_any_real_type_and_layout_will_do(dtype: type) -> None:
    view = np.array(1, dtype)
    expected = shlight.shade_spheres([-1.0, 1.0, 2.0], 1.0, BSDF, 1.0)
    strided = np.array([[-1, 0, 1, 0, 2, 0]], dtype)[:, ::2]
    np.testing.assert_array_equal(shlight.shade_spheres(strided[0], np.array(1, dtype), BSDF, view), expected)
    expected = shlight.shade_polygons(np.array(TRIANGLE, float), BSDF, 1.0)
    np.testing.assert_array_equal(shlight.shade_polygons(np.array(TRIANGLE, dtype), BSDF, view), expected)


@pytest.mark.parametrize("roughness", [0.3, 0.05])
def test_hidden_lights_give_zeros(roughness: float) -> None:
    bsdf = Bsdf.ggx(roughness, 0.9)
    for radiance, effort in (
        shlight.shade_spheres([0.3, 0, -2], 1, bsdf, 0.5, return_effort=True),
        shlight.shade_polygons(-np.array(TRIANGLE), bsdf, 0.5, return_effort=True),
        shlight.shade_polygons([[1, 0, 1]] * 3, bsdf, 0.5, return_effort=True),  # a point
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [3, 0, 3]], bsdf, 0.5, return_effort=True),  # no area
        shlight.shade_polygons([[1, 0, 1], [2, 0, 2], [2, 0, 1]], bsdf, 0.5, return_effort=True),  # edge-on
        shlight.shade_disks((0, 0, -2), (1, 0, 0), (0, 1, 0), bsdf, 0.7, return_effort=True),
        shlight.shade_disks((3, 0, 1), (1, 0, 0), (0, 0, 0.5), bsdf, 0.7, return_effort=True),  # edge-on
        shlight.shade_spheres([0, 0, 2], 1, Bsdf.lambert(0), 0.5, return_effort=True),
    ):
        assert not radiance.any()
        assert effort == 0


@pytest.mark.parametrize("order", [1, 2, 8, 64])
def test_a_given_order_is_taken_as_far_as_there_are_bands(order: int) -> None:
    lights = [[0, 0, 1], [-1, 0, 0.1], [-2, 0, 2]]
    radii = [1e-3, 0.5, 1]
    for bsdf, taken in ((BSDF, order), (Bsdf.lambert(0.5), min(order, 2)), (MATERIALS["plastic"], order)):
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


@all_functions
def test_axes_that_do_not_broadcast_are_named(function: Any) -> None:
    first, *others = (np.asarray(value, float) for value in LIGHTS[function].values())
    with pytest.raises(ValueError, match="cos_theta_o"):
        function(np.broadcast_to(first, (2, *first.shape)), *others, BSDF, [0.5] * 3)
