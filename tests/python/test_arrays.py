# SPDX-License-Identifier: MIT
"""Types of results, arrays that are filled, and arrays of other libraries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import shlight

CENTERS = np.random.default_rng(1).normal([0, 0, 3], 0.3, (5, 4, 3))
DISK = (CENTERS, np.array([0.3, 0, 0]), np.array([0, 0.3, 0.1]))
POLYGONS = CENTERS[..., None, :] + 0.2 * np.array([[1, 0, 0], [0, 1, 0], [-1, -1, 0]])
# Functions of the arrays behind them and the order 3, or of the arrays alone.
CALLS: dict[str, tuple[Callable[..., Any], tuple[Any, ...]]] = {
    "sphere_coefficients": (lambda c, r, **named: shlight.sphere_coefficients(c, r, 3, **named), (CENTERS, 0.5)),
    "cap_coefficients": (lambda a, h, **named: shlight.cap_coefficients(a, h, 3, **named), (CENTERS, 0.5)),
    "polygon_coefficients": (lambda v, **named: shlight.polygon_coefficients(v, 3, **named), (POLYGONS,)),
    "disk_coefficients": (lambda *disk, **named: shlight.disk_coefficients(*disk, 3, **named), DISK),
    "sh_basis": (lambda d, **named: shlight.sh_basis(d, 3, **named), (CENTERS,)),
}
OTHERS: dict[str, tuple[Callable[..., Any], tuple[Any, ...]]] = {
    "evaluate": (shlight.evaluate, (np.ones(9), CENTERS)),
    "contract": (shlight.contract, (np.ones(9), np.ones(9))),
    "luminous": (shlight.luminous, (CENTERS,)),
    "look_at": (lambda eye: shlight.look_at(eye, np.zeros(3, eye.dtype), (0, 1, 0)), (CENTERS,)),
}


@pytest.mark.parametrize("name", CALLS | OTHERS)
def test_float32_gives_float32_and_anything_else_float64(name: str) -> None:
    function, arguments = (CALLS | OTHERS)[name]
    single = [np.asarray(own, np.float32) for own in arguments]
    assert function(*single).dtype == np.float32
    assert function(*(own.astype(float) for own in single)).dtype == np.float64
    if len(single) > 1:
        assert function(single[0], *(own.astype(float) for own in single[1:])).dtype == np.float64
        lists = function(single[0], *(own.tolist() for own in single[1:]))
        assert lists.dtype == (np.float64 if single[1].ndim else np.float32)  # a number of Python decides nothing


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_out_is_filled(name: str, dtype: Any) -> None:
    function, arguments = CALLS[name]
    given = [np.asarray(own, dtype) for own in arguments]
    whole = np.full((2, 5, 4, 9), np.nan, dtype)
    assert function(*given, out=whole[1]).base is whole
    np.testing.assert_array_equal(whole[1], function(*given))
    assert np.isnan(whole[0]).all()
    read_only = np.zeros((5, 4, 9), dtype)
    read_only.flags.writeable = False
    for wrong in (whole[1, ..., ::-1], whole[:, 0], whole[1].astype(np.float16), read_only, whole[1].tolist()):
        with pytest.raises(ValueError, match=r"^out must be"):
            function(*given, out=wrong)


def test_out_does_not_overlap_what_is_read() -> None:
    memory = np.tile([0.0, 0, 2], 12)
    with pytest.raises(ValueError, match=r"^out must not overlap"):
        shlight.sphere_coefficients(memory[:27].reshape(9, 3), 0.5, 1, out=memory[9:18].reshape(9, 1))


class Foreign:
    """An array of a library that numpy knows by DLPack alone."""

    def __init__(self, array: Any) -> None:
        self._array = array

    def __dlpack__(self, **named: Any) -> Any:
        return self._array.__dlpack__(**named)

    def __dlpack_device__(self) -> Any:
        return self._array.__dlpack_device__()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_arrays_come_in_by_dlpack(dtype: Any) -> None:
    centers = CENTERS.astype(dtype)
    found = shlight.sphere_coefficients(Foreign(centers), dtype(0.5), 3)
    assert found.dtype == dtype
    np.testing.assert_array_equal(found, shlight.sphere_coefficients(centers, dtype(0.5), 3))
    scene = shlight.Scene()
    scene.add_mesh(Foreign(np.eye(3, dtype=dtype)), Foreign(np.array([[0, 1, 2]])))
