# SPDX-License-Identifier: MIT
"""Manners of the functions for coefficients: shapes, types, threads, and errors that name the argument."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shlight

TRIANGLE = [[1, 0, 1], [0, 1, 1], [-1, -1, 1]]
GOOD: dict[Any, dict[str, Any]] = {
    shlight.sphere_coefficients: {"centers": [0, 0, 2], "radii": 1},
    shlight.cap_coefficients: {"axes": [0, 0, 2], "half_angles": 1},
    shlight.polygon_coefficients: {"vertices": TRIANGLE},
    shlight.disk_coefficients: {"centers": [0, 0, 1], "half_axes_u": [1, 0, 0], "half_axes_v": [0, 1, 0]},
}
all_functions = pytest.mark.parametrize("function", GOOD, ids=lambda function: function.__name__)


@all_functions
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("first", [(), (4,), (5, 1), (0,), (2, 1, 3)])
def test_leading_axes_broadcast(function: Any, first: tuple[int, ...], dtype: type) -> None:
    """The first argument has the axes `first`, the others (4,)."""
    arrays = [np.asarray(value, float) for value in GOOD[function].values()]
    others = () if len(arrays) == 1 or first == (2, 1, 3) or first == (0,) else (4,)
    given = [
        np.broadcast_to(array, (*axes, *array.shape))
        for array, axes in zip(arrays, [first, others, others], strict=False)
    ]
    result = function(*given, 3, dtype=dtype)
    assert result.shape == (*np.broadcast_shapes(first, others), 9)
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, np.broadcast_to(function(*arrays, 3, dtype=dtype), result.shape))


@all_functions
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_threads_change_no_bit(function: Any, dtype: type) -> None:
    rng = np.random.default_rng(3)
    centers = rng.normal(size=(2003, 3))
    sizes = np.linalg.norm(centers, axis=1) * rng.uniform(0.01, 0.99, 2003)
    given: dict[Any, tuple[Any, ...]] = {
        shlight.sphere_coefficients: (centers, sizes),
        shlight.cap_coefficients: (centers, sizes / 4 % 3 + 0.1),
        shlight.polygon_coefficients: (centers[:, None] + 0.5 * rng.normal(size=(2003, 3, 3)),),
        shlight.disk_coefficients: (centers, rng.normal(size=(2003, 3)), rng.normal(size=3)),
    }
    once = function(*given[function], 6, dtype=dtype, threads=1).tobytes()
    for threads in (0, 2, 5):
        assert function(*given[function], 6, dtype=dtype, threads=threads).tobytes() == once


@pytest.mark.parametrize("function", [function for function in GOOD if len(GOOD[function]) > 1])
def test_axes_that_do_not_broadcast_are_named(function: Any) -> None:
    arrays = enumerate(GOOD[function].items())
    axes = {name: np.broadcast_to(value, (k + 2, *np.shape(value))) for k, (name, value) in arrays}
    with pytest.raises(ValueError, match=".*".join(list(axes)[:2])):
        function(**axes, order=4)
