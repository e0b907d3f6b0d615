# SPDX-License-Identifier: MIT
"""What the figures of `shlight charts` measure with: their lights, truths, errors and times."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from charts_cases import dummy

from shlight.charts import fused, measure
from shlight.charts.lights import CLASSES, LightClass, Lights, spheres, squares

# --- lights ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("light_class", CLASSES, ids=lambda c: c.name)
def test_lights_of_a_class(light_class: LightClass) -> None:
    lights = light_class.lights(3, 40)
    assert len(lights) == 40
    for array, again in zip(lights.arrays, light_class.lights(3, 40).arrays, strict=True):
        np.testing.assert_array_equal(array, again)
        np.testing.assert_array_equal(array, array.astype(np.float32))  # both precisions hold them
    kept = lights.coefficients("exact", 1, np.float64)[:, 0]
    whole = lights.coefficients("exact", 1, np.float64, clip=False)[:, 0]
    assert (kept > 0).all()
    cut = kept < whole * (1 - 1e-9)
    assert cut.mean() >= 0.6 if "clipped" in light_class.name else not cut.any()
    assert (whole.max() < 0.01) == ("small" in light_class.name)
    measure.truth(lights.take(slice(0, 4)), 2)  # takes only what is planar
    if light_class.kind == "polygon":
        np.testing.assert_array_equal(*in_one_plane(lights, (0, 1, 3, 2)))


def in_one_plane(lights: Lights, order: tuple[int, int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Two sides that are equal if the corners lie exactly in one plane."""
    first, second, third, fourth = (lights.arrays[0][:, i] for i in order)
    return second - first, fourth - third


def test_elevation_and_half_angle_of_a_sphere() -> None:
    lights = spheres(np.array([0.3, -1.0]), np.array([0.2, 1e-4]), 0.6)
    centers, radii = lights.arrays
    np.testing.assert_allclose(np.arcsin(centers[:, 2]), [0.3, -1.0], atol=1e-6)
    np.testing.assert_allclose(np.arctan2(centers[:, 1], centers[:, 0]), 0.6, atol=1e-6)
    np.testing.assert_allclose(np.arcsin(radii), [0.2, 1e-4], rtol=1e-6)


@pytest.mark.parametrize("half", [1e-4, 0.1, 1.4])
@pytest.mark.parametrize("beyond", [-1e-7, 1e-7, 0.1])
def test_edges_of_a_square_near_the_horizon(half: float, beyond: float) -> None:
    upper, lower = squares(np.array([beyond - half, beyond + half]), half, 0.6).arrays[0]
    for corners, near in ((upper, slice(2, 4)), (lower, slice(0, 2))):
        np.testing.assert_allclose(corners[near, 2], np.sin(beyond) / np.cos(half), rtol=1e-6)
    for corners in (upper, lower):
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=-1)
        np.testing.assert_allclose(sides, 2 * np.tan(half), rtol=0.01)


def test_squares_are_plane() -> None:
    rng = np.random.default_rng(4)
    half = 1e-4 * 1.4e4 ** rng.random(300)
    lights = squares(rng.uniform(-1.5, 1.5, 300), half, rng.uniform(0, 6, 300))
    np.testing.assert_array_equal(*in_one_plane(lights, (0, 1, 3, 2)))


# --- measurements ------------------------------------------------------------------------------------------------


def test_a_new_method_appears_by_itself(register: Callable[..., None]) -> None:
    register(dummy(), dummy(name="other", random=True), dummy(name="third", adaptive=True))
    found = {series.label: series for series in measure.all_series("sphere")}
    assert next(iter(found)) == "exact"
    assert "reference" not in found
    new = [label for label, series in found.items() if series.method in ("dummy", "other", "third")]
    assert new == ["dummy", "other, 64 samples", "other, 1024 samples", "third", "third to 0.001"]
    looks = {(series.color, series.marker) for series in found.values()}
    assert len(looks) == len({series.method for series in found.values()})
    assert [s.label for s in measure.main_series("sphere") if s.label in new] == [
        "dummy",
        "other, 1024 samples",
        "third",
    ]
    assert "dummy" not in {series.label for series in measure.all_series("polygon")}


def test_errors_by_hand() -> None:
    true = np.array([[2.0, 0.0, 1.0, 0.0, 9.0], [1e-3, 0.0, 0.0, 0.0, 9.0], [1.0, 0.0, 0.0, 0.0, 9.0]])
    values = np.array([[2.0, 0.1, 1.0, 0.0], [1e-3, 0.0, 2e-3, 0.0], [1.0, np.nan, 0.0, 5.0]], dtype=np.float32)
    np.testing.assert_allclose(measure.relative_errors(values, true), [0.05, 2, np.inf], rtol=1e-6)
    np.testing.assert_allclose(measure.relative_errors(values, true, 0.1), [0.05, 0.02, np.inf], rtol=1e-6)


def test_the_truth_is_that_of_the_lights() -> None:
    lights = CLASSES[1].lights(5, 12)
    true = measure.truth(lights, 6)
    assert measure.relative_errors(lights.coefficients("exact", 6, np.float64), true).max() <= 1e-13
    lower = measure.truth(lights, 3)
    np.testing.assert_allclose(true[:, :9], lower, rtol=0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 2, 7])
@pytest.mark.parametrize("light_class", [CLASSES[1], CLASSES[3]], ids=lambda c: c.name)
def test_errors_of_fused_calls(order: int, light_class: LightClass) -> None:
    (series,) = fused.fused_series("float32")
    lights = light_class.lights(5, 12)
    true = measure.truth(lights, order)
    values = series.coefficients(lights, order, np.float32)
    assert values.shape == (12, 1)
    assert series.errors(values, true).max() <= 3e-6
    np.testing.assert_allclose(series.errors(values + true[:, :1], true), 1, atol=1e-5)
    assert np.isinf(series.errors(values * np.nan, true)).all()
    assert fused.fused_series("float64") == []


def test_the_exponent_of_growth() -> None:
    orders = [2, 4, 8, 16, 32, 64]
    seconds = [5.0, 5.0, *(1e-6 * n**1.7 for n in orders[2:5]), np.nan]
    assert measure.exponent(orders, seconds) == pytest.approx(1.7, abs=1e-9)
    assert np.isnan(measure.exponent([2, 4, 8], [1.0, 2.0, 3.0]))


def test_times_stop_at_the_largest_order(register: Callable[..., None]) -> None:
    register(dummy())
    lights = CLASSES[0].lights(1, 8)
    both = [series for series in measure.all_series("sphere") if series.label in ("exact", "dummy")]
    library, other = measure.best_seconds(both, lights, 9, "float32", rounds=1, budget=1e-4)
    assert library > 0
    assert np.isnan(other)
