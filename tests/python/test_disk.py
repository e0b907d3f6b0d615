# SPDX-License-Identifier: MIT
"""Disk and ellipse lights: what must hold for any of them, and the manners of the function."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from strategies import Floats, angles, directions, orders, reproducible, turn, turned

import shlight

Disk = tuple[Floats, Floats, Floats]


@st.composite
def disks(draw: st.DrawFn) -> Disk:
    """Centre and half axes, conjugate but in general not at right angles; anywhere, thin and near ones, too."""
    center = 10 ** draw(st.floats(-1, 1)) * draw(directions())
    u = 10 ** draw(st.floats(-2, 1)) * draw(directions())
    v = 10 ** draw(st.floats(-2, 1)) * draw(directions())
    area = np.linalg.norm(np.cross(u, v))
    assume(area > 1e-3 * np.linalg.norm(u) * np.linalg.norm(v))
    assume(abs(center @ np.cross(u, v)) > 1e-4 * area * np.linalg.norm(center))
    return center, u, v


def exact(disk: Disk, order: int, **options: bool) -> Floats:
    return shlight.disk_coefficients(*disk, order, dtype=np.float64, **options)


def transformed(disk: Disk, matrix: Floats) -> Disk:
    center, u, v = disk
    return matrix @ center, matrix @ u, matrix @ v


def size(disk: Disk) -> float:
    return float(exact(disk, 1, clip=False)[0])


def mirror_signs(order: int) -> Floats:
    """What mirroring at the horizon does to coefficients: (-1)^(l-m)."""
    return np.array([(-1.0) ** (l - m) for l in range(order) for m in range(-l, l + 1)])  # noqa: E741


@reproducible
@given(disks(), angles, orders)
def test_turning_the_scene_turns_the_coefficients(disk: Disk, angle: float, order: int) -> None:
    after = exact(transformed(disk, turn(angle)), order)
    np.testing.assert_allclose(after, turned(exact(disk, order), angle), atol=1e-11 * size(disk))


@reproducible
@given(disks(), st.integers(-60, 60), orders)
def test_scale_does_not_matter(disk: Disk, exponent: int, order: int) -> None:
    scaled = transformed(disk, 2.0**exponent * np.eye(3))
    np.testing.assert_allclose(exact(scaled, order), exact(disk, order), atol=1e-13 * size(disk))


@reproducible
@given(disks(), angles, orders)
def test_any_conjugate_half_axes_are_the_same_ellipse(disk: Disk, angle: float, order: int) -> None:
    center, u, v = disk
    expected = exact(disk, order)
    c, s = math.cos(angle), math.sin(angle)
    for same in ((v, u), (-u, v), (c * u + s * v, c * v - s * u)):
        np.testing.assert_allclose(exact((center, *same), order), expected, atol=1e-11 * size(disk))


@reproducible
@given(disks(), orders)
def test_halves_sum_to_the_whole(disk: Disk, order: int) -> None:
    below = mirror_signs(order) * exact(transformed(disk, np.diag([1, 1, -1])), order)
    whole = exact(disk, order, clip=False)
    np.testing.assert_allclose(exact(disk, order) + below, whole, atol=1e-11 * whole[0])


@reproducible
@given(disks(), orders)
@example(
    (
        np.array([0, 0, 5.62341325]),
        np.array([0.84147098, 0, 0.54030231]),
        np.array([0.45464871, 0.70807342, 0.54030231]),
    ),
    3,
)
def test_float32_is_close_to_float64(disk: Disk, order: int) -> None:
    center, u, v = (x.astype(np.float32) for x in disk)
    single = shlight.disk_coefficients(center, u, v, order)
    np.testing.assert_allclose(single, exact((center, u, v), order), atol=1e-5 * size(disk))


@reproducible
@given(disks(), st.booleans())
def test_polygons_of_many_sides_come_near(disk: Disk, clip: bool) -> None:
    center, u, v = disk
    sides = 400
    turn_of = 2 * np.pi * np.arange(sides) / sides
    # Of the same area: what is left to tell them apart is of fourth order at a distance, of second near by.
    radius = math.sqrt(2 * math.pi / sides / math.sin(2 * math.pi / sides))
    vertices = center + radius * (np.outer(np.cos(turn_of), u) + np.outer(np.sin(turn_of), v))
    polygon = shlight.polygon_coefficients(vertices, 8, dtype=np.float64, clip=clip)
    np.testing.assert_allclose(exact(disk, 8, clip=clip), polygon, atol=1e-3 * size(disk))


def test_facing_disk_is_a_cap() -> None:
    radii = np.array([0.01, 0.5, 3.0])
    half_axes = radii[:, None] * np.eye(3)[[0]], radii[:, None] * np.array([[0, 0.6, 0.8]])
    center = np.array([0, 1.6, -1.2])
    for clip in (False, True):
        disk = shlight.disk_coefficients(center, *half_axes, 9, clip=clip, dtype=np.float64)
        cap = shlight.cap_coefficients(center, np.arctan(radii / 2), 9, clip=clip, dtype=np.float64)
        np.testing.assert_allclose(disk, cap, atol=1e-13)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_leading_axes_broadcast_and_threads_do_not_matter(dtype: type) -> None:
    rng = np.random.default_rng(3)
    centers, u, v = rng.normal([0, 0, 2], 1, (40, 1, 3)), rng.normal(size=(1, 30, 3)), rng.normal(size=3)
    result = shlight.disk_coefficients(centers, u, v, 6, dtype=dtype, threads=1)
    assert result.shape == (40, 30, 36)
    assert result.dtype == dtype
    for threads in (2, 5):
        again = shlight.disk_coefficients(centers, u, v, 6, dtype=dtype, threads=threads)
        np.testing.assert_array_equal(again, result)
    one = shlight.disk_coefficients(centers[7, 0], u[0, 11], v, 6, dtype=dtype)
    np.testing.assert_array_equal(one, result[7, 11])
    assert shlight.disk_coefficients(np.empty((0, 3)), [1, 0, 0], [0, 1, 0], 4).shape == (0, 16)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (([0, 0], [1, 0, 0], [0, 1, 0], 3), "centers"),
        (([0, 0, 1], [1, 0], [0, 1, 0], 3), "half_axes_u"),
        (([0, 0, 1], [1, 0, 0], 1.0, 3), "half_axes_v"),
        (([0, 0, np.nan], [1, 0, 0], [0, 1, 0], 3), "centers"),
        (([0, 0, 1], [np.inf, 0, 0], [0, 1, 0], 3), "half_axes_u"),
        (([0, 0, 1], [1, 0, 0], [0, 1e400, 0], 3), "half_axes_v"),
        (([0, 0, 1], [0, 0, 0], [0, 1, 0], 3), "half_axes_u"),
        (([0, 0, 1], [1, 2, 3], [2, 4, 6], 3), "half_axes_v"),
        (([0.5, 0.1, 0], [1, 0, 0], [0, 1, 0], 3), "centers"),
        (([0, 0, 1], [1, 0, 0], [0, 1, 0], 0), "order"),
        (([0, 0, 1], [1, 0, 0], [0, 1, 0], 65), "order"),
        ((np.ones((2, 3)), np.ones((3, 3)), [0, 1, 0], 3), "centers"),
    ],
)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_bad_arguments_are_named(arguments: tuple[Any, Any, Any, int], name: str, dtype: type) -> None:
    with pytest.raises(ValueError, match=name):
        shlight.disk_coefficients(*arguments, dtype=dtype)


def test_edge_on_disks_are_not_seen() -> None:
    assert not np.any(shlight.disk_coefficients([3, 0, 1], [1, 0, 0], [0, 0, 1], 5))
