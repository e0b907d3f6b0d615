# SPDX-License-Identifier: MIT
from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from scipy.special import sph_harm_y
from strategies import directions, reproducible

import shlight


@reproducible
@given(directions())
def test_agrees_with_scipy(direction: np.ndarray) -> None:
    """scipy's are complex and carry the Condon–Shortley phase (-1)^m."""
    order = 12
    basis = shlight.sh_basis(direction, order, dtype=np.float64)
    tilt = math.atan2(math.hypot(direction[0], direction[1]), direction[2])
    azimuth = math.atan2(direction[1], direction[0])
    for l in range(order):  # noqa: E741
        for m in range(l + 1):
            value = (-1) ** m * (math.sqrt(2) if m else 1) * sph_harm_y(l, m, tilt, azimuth)
            assert basis[l * l + l + m] == pytest.approx(value.real, abs=1e-12)
            if m > 0:
                assert basis[l * l + l - m] == pytest.approx(value.imag, abs=1e-12)


@pytest.mark.parametrize("shape", [(), (1,), (5,), (2, 3), (4, 1, 2), (0,), (3, 0)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_shapes_and_types(shape: tuple[int, ...], dtype: type) -> None:
    d = np.full((*shape, 3), 0.5)
    basis = shlight.sh_basis(d, 4, dtype=dtype)
    assert basis.shape == (*shape, 16)
    assert basis.dtype == dtype


def test_takes_integers_lists_and_strides() -> None:
    expected = shlight.sh_basis(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), 5, np.float32)
    np.testing.assert_array_equal(shlight.sh_basis([[1, 2, 3], [4, 5, 6]], 5, np.float32), expected)
    strided = np.zeros((2, 6), np.float32)
    strided[:, ::2] = [[1, 2, 3], [4, 5, 6]]
    np.testing.assert_array_equal(shlight.sh_basis(strided[:, ::2], 5), expected)
    for dtype in (np.float64, np.float32, ">f4"):
        given = np.asfortranarray(np.array([[1, 2, 3], [4, 5, 6]], dtype))
        np.testing.assert_array_equal(shlight.sh_basis(given, 5, np.float32), expected)
        np.testing.assert_array_equal(shlight.sh_basis(np.ascontiguousarray(given), 5, np.float32), expected)


def test_evaluate_sums_the_expansion() -> None:
    rng = np.random.default_rng(1)
    coefficients = rng.normal(size=(7, 1, 36))
    d = rng.normal(size=(5, 3))
    values = shlight.evaluate(coefficients, d)
    assert values.shape == (7, 5)
    assert values.dtype == np.float64
    basis = shlight.sh_basis(d, 6, dtype=np.float64)
    np.testing.assert_allclose(values, np.einsum("ak,bk->ab", coefficients[:, 0], basis), atol=1e-12)
    assert shlight.evaluate(coefficients.astype(np.float32), d.astype(np.float32)).dtype == np.float32
    assert np.shape(shlight.evaluate(coefficients[0, 0], d[0])) == ()


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_change_no_bit(threads: int) -> None:
    d = np.random.default_rng(2).normal(size=(3001, 3)).astype(np.float32)
    basis = shlight.sh_basis(d, 9)
    assert shlight.sh_basis(d, 9, threads=threads).tobytes() == basis.tobytes()
    values = shlight.evaluate(basis, d)
    assert shlight.evaluate(basis, d, threads=threads).tobytes() == values.tobytes()
