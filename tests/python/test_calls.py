# SPDX-License-Identifier: MIT
"""What wrong calls are told, and that Ctrl-C ends long ones."""

from __future__ import annotations

import inspect
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_cases import lit_floor

import shlight
from shlight import Bsdf, _tables, images, metrics, nodes

MATTE = Bsdf.lambert(0.5)
CENTERS = np.tile([0.5, 0.0, 2.0], (2000, 1))


def one_wrong(value: float, row: int = 512) -> Any:
    values = np.full(2000, 0.5)
    values[row] = value
    return values


WRONG_ROWS: dict[str, Callable[[], Any]] = {
    "radii[512] must be positive": lambda: shlight.sphere_coefficients(CENTERS, one_wrong(-1), 3),
    "radii[5, 12]": lambda: shlight.shade_spheres(CENTERS[0], one_wrong(0).reshape(20, 100), MATTE, 0.5),
    "radii[0, 512]": lambda: shlight.shade_spheres(CENTERS[:3, None], one_wrong(9)[None], MATTE, 0.5),
    "radii[1]": lambda: shlight.shade_spheres([0, 0, 2], [1, 3], MATTE, 1, gradient=True),
    "radii must": lambda: shlight.shade_spheres(CENTERS, -1.0, MATTE, 0.5),
    "half_angles[1999]": lambda: shlight.cap_coefficients(CENTERS, one_wrong(9, 1999), 3, method="quadrature"),
    "directions[7]": lambda: shlight.sh_basis(CENTERS * (np.arange(2000) != 7)[:, None], 3),
    "points[1] contains": lambda: lit_floor().irradiance([[0, 0, 0], [np.nan, 0, 0]], [0, 0, 1]),
    "normals[1] has length 0": lambda: lit_floor().light_coefficients([[0, 0, 1]] * 2, [[0, 0, 1], [0, 0, 0]], 3),
    "directions[2] has length 0": lambda: lit_floor().radiance([[0, 0, 1]] * 3, [[0, 0, 1], [0, 0, 1], [0, 0, 0]]),
    "light[4]": lambda: shlight.contract(np.where(np.arange(6)[:, None] == 4, np.nan, np.ones(9)), np.ones(9)),
}


@pytest.mark.parametrize("place", WRONG_ROWS)
def test_errors_name_the_first_wrong_row(place: str) -> None:
    with pytest.raises(ValueError, match="^" + place.replace("[", r"\[")):
        WRONG_ROWS[place]()


WRONG_CALLS: dict[str, Callable[[], Any]] = {
    "unknown argument 'samples'; did you mean 'max_samples'?": lambda: shlight.render(
        lit_floor(), 4, 4, samples=3, max_bounces=0
    ),
    "unknown argument 'nois'; did you mean 'noise_threshold'?": lambda: shlight.render(
        lit_floor(), 4, 4, nois=0.1, max_bounces=0
    ),
    "unknown argument 'shadow'; did you mean 'shadows'?": lambda: shlight.Scene().add_sphere_light(
        [0, 0, 1], 0.1, (1, 1, 1), shadow=False
    ),
    "unknown argument 'iro'; did you mean 'ior'?": lambda: Bsdf.ggx(0.1, 0.2, iro=1.3),
    "missing a required argument: 'width'": lambda: shlight.render(lit_floor(), max_bounces=0),
    "too many positional arguments": lambda: shlight.render(lit_floor(), 4, 4, 5, max_bounces=0),
    "a Bsdf can be added to Bsdfs alone": lambda: sum([MATTE], 1),
}


@pytest.mark.parametrize("text", WRONG_CALLS)
def test_wrong_calls_are_told_what_is_wrong_in_a_line(text: str) -> None:
    with pytest.raises(TypeError) as caught:
        WRONG_CALLS[text]()
    assert str(caught.value) == text


def test_sums_of_materials() -> None:
    glossy = Bsdf.ggx(0.3, 0.04)
    np.testing.assert_array_equal(sum([MATTE, glossy]).coefficients(0.5, 4), (MATTE + glossy).coefficients(0.5, 4))
    assert isinstance(sum([Bsdf.oren_nayar(0.5, 0.3), Bsdf.principled()]), type(Bsdf.principled()))


@pytest.mark.parametrize("odd", [np.ones((2, 2, 3), complex), [[[10**400] * 3]], "picture", None])
def test_metrics_name_what_is_no_picture(odd: Any) -> None:
    with pytest.raises(ValueError, match=r"^image must be an array of real numbers"):
        metrics.rel_mse(odd, np.ones((2, 2, 3)))


def test_lights_that_meet_colours_one_by_one_are_named() -> None:
    light, color = np.ones((3, 9)), np.arange(27.0).reshape(3, 9)
    with pytest.warns(UserWarning, match="pass light"):
        shlight.contract(light, color)
    assert shlight.contract(light[:, None], color).shape == (3, 3)


def test_shade_is_the_deprecated_name_of_contract() -> None:
    with pytest.warns(DeprecationWarning, match="contract"):
        assert shlight.shade(np.ones(4), np.arange(4.0)) == 6.0


def test_files_are_of_the_format_that_their_name_says(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^path must not end in \.jpg: the file is png"):
        images.write_png(tmp_path / "x.jpg", np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(ValueError, match=r"^path must not end in \.PNG: the file is openexr"):
        images.write_exr(tmp_path / "x.PNG", np.zeros((2, 2, 3)))
    images.write_png(tmp_path / "x.v2", np.zeros((2, 2, 3), np.uint8))


@pytest.fixture
def alarm() -> Iterator[None]:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    yield
    signal.signal(signal.SIGALRM, before)


MANY = np.tile([0.5, 0.0, 2.0], (2_000_000, 1))
LONG: dict[str, Callable[[], Any]] = {
    "coefficients": lambda: shlight.sphere_coefficients(MANY, 0.5, 16),
    "shading": lambda: shlight.shade_spheres(MANY, 0.5, Bsdf.ggx(0.3, 0.04), 0.8, order=32),
    "methods": lambda: shlight.sphere_coefficients(MANY, 0.5, 4, method="monte_carlo", samples=20000, seed=1),
}


def _within_alarm(call: Callable[[], Any]) -> None:
    # Again and again: Python ignores what a handler raises within a callback of the garbage collector.
    signal.setitimer(signal.ITIMER_REAL, 0.1, 0.1)
    try:
        call()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)  # an alarm after a short call would end pytest


@pytest.mark.parametrize("call", LONG)
def test_an_interrupt_ends_a_long_call(alarm: None, call: str) -> None:
    start = time.process_time()
    with pytest.raises(KeyboardInterrupt):
        _within_alarm(LONG[call])
    assert time.process_time() - start <= 1.0
    assert np.geterr()["divide"] == "warn"  # as numpy has it


def test_an_interrupt_while_an_argument_is_read_is_an_interrupt() -> None:
    class Interrupted:
        def __array__(self, *_: object, **__: object) -> Any:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        shlight.sphere_coefficients(Interrupted(), 0.5, 2)


def test_signatures_are_real_ones() -> None:
    functions = [getattr(shlight, name) for name in shlight.__all__]
    functions += [getattr(module, name) for module in (images, metrics) for name in module.__all__]
    functions += [
        getattr(kind, name)
        for kind in functions
        if isinstance(kind, type) and kind.__module__ == "shlight._core"
        for name, method in vars(kind).items()
        if not name.startswith("_") and not isinstance(method, property)
    ]
    for function in functions:
        if callable(function) and not isinstance(function, type):
            parameters = inspect.signature(function).parameters.values()
            assert all(own.kind not in (own.VAR_POSITIONAL, own.VAR_KEYWORD) for own in parameters), function
    assert not inspect.signature(shlight.Scene).parameters
    assert inspect.signature(Bsdf.ggx).parameters["ior"].default is None
    tolerance = inspect.signature(shlight.render).parameters["tolerance"].default
    assert tolerance == shlight.DEFAULT_TOLERANCE


@pytest.mark.parametrize(
    ("method", "function"),
    [
        (Bsdf.principled, nodes.principled),
        (Bsdf.from_function, _tables.from_function),
        (Bsdf.from_table, _tables.from_table),
        (Bsdf.read, _tables.read),
    ],
)
def test_methods_have_the_arguments_of_the_functions_behind_them(method: Any, function: Any) -> None:
    own, behind = (inspect.signature(each).parameters for each in (method, function))
    assert [(p.name, p.kind, p.default) for p in own.values()] == [(p.name, p.kind, p.default) for p in behind.values()]
