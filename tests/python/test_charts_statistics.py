# SPDX-License-Identifier: MIT
"""What the numbers of `./dev charts` rest on: their lights, truths and errors, and what is chosen by them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import shlight
from shlight_tools.charts import fused, lobes, measure, order_error, picture_measure, pictures, stability, which_method
from shlight_tools.charts.lights import CLASSES, LightClass
from shlight_tools.charts.lobe_lights import Clock, about_lobe

# --- coefficients -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("light_class", CLASSES, ids=lambda c: c.name)
def test_lights_of_a_class(light_class: LightClass) -> None:
    lights = light_class.lights(3, 40)
    for array, again in zip(lights.arrays, light_class.lights(3, 40).arrays, strict=True):
        np.testing.assert_array_equal(array, again)
        np.testing.assert_array_equal(array, array.astype(np.float32))  # both precisions hold them
    kept = measure.coefficients(lights, "exact", 1, np.float64)[:, 0]
    whole = measure.coefficients(lights, "exact", 1, np.float64, clip=False)[:, 0]
    assert (kept > 0).all()
    cut = kept < whole * (1 - 1e-9)
    assert cut.mean() >= 0.6 if "clipped" in light_class.name else not cut.any()
    assert (whole.max() < 0.01) == ("small" in light_class.name)
    some = lights.take(slice(0, 4))
    true = measure.truth(some, 2)  # takes only what is planar
    np.testing.assert_allclose(true, measure.coefficients(some, "exact", 2, np.float64), atol=1e-12)


def test_errors_by_hand() -> None:
    true = np.array([[2.0, 0.0, 1.0, 0.0, 9.0], [1e-3, 0.0, 0.0, 0.0, 9.0], [1.0, 0.0, 0.0, 0.0, 9.0]])
    values = np.array([[2.0, 0.1, 1.0, 0.0], [1e-3, 0.0, 2e-3, 0.0], [1.0, np.nan, 0.0, 5.0]], dtype=np.float32)
    np.testing.assert_allclose(measure.relative_errors(values, true), [0.05, 2, np.inf], rtol=1e-6)
    np.testing.assert_allclose(measure.relative_errors(values, true, 0.1), [0.05, 0.02, np.inf], rtol=1e-6)


@pytest.mark.parametrize("order", [1, 7])
@pytest.mark.parametrize("light_class", [CLASSES[1], CLASSES[3]], ids=lambda c: c.name)
def test_errors_of_fused_calls(order: int, light_class: LightClass) -> None:
    (series,) = fused.fused_series("float32")
    lights = light_class.lights(5, 12)
    true = measure.truth(lights, order)
    values = series.coefficients(lights, order, np.float32)
    assert series.errors(values, true).max() <= 3e-6
    np.testing.assert_allclose(series.errors(values + true[:, :1], true), 1, atol=1e-5)
    assert np.isinf(series.errors(values * np.nan, true)).all()


def test_the_exponent_of_growth() -> None:
    orders = [2, 4, 8, 16, 32, 64]
    seconds = [5.0, 5.0, *(1e-6 * n**1.7 for n in orders[2:5]), np.nan]
    assert measure.exponent(orders, seconds) == pytest.approx(1.7, abs=1e-9)
    assert np.isnan(measure.exponent([2, 4, 8], [1.0, 2.0, 3.0]))


def test_shares_of_a_map_by_hand() -> None:
    unknown, covered = stability.UNKNOWN, stability.COVERED
    errors = np.array([[1e-6, unknown, 0.5], [covered, np.inf, 1e-4]])
    series = measure.all_series("sphere")[0]
    of = stability.Map("sphere", stability.REGIONS[0], 8, "float32", series, errors)
    assert of.worst() == 0.5
    assert of.share_over_limit() == 0.5  # what is not finite is above any limit
    assert of.share_not_finite() == 0.25


# --- lobes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cos_o", [1.0, 0.2])
@pytest.mark.parametrize("alpha", [None, 0.25, 0.01])
def test_the_warped_hemisphere_is_the_upper_one(alpha: float | None, cos_o: float) -> None:
    warp = lobes.Warp(alpha, cos_o)
    grid = lobes.Grid.over(warp, 96)
    directions, weights = warp.direction(grid.warped), grid.weights * warp.density(grid.warped)
    assert (directions[..., 2] > 0).all()
    assert weights.sum() == pytest.approx(2 * math.pi, rel=2e-3)
    assert (weights * directions[..., 2]).sum() == pytest.approx(math.pi, rel=2e-3)


def test_residuals_of_a_cosine_by_hand() -> None:
    """Order 1 of cosθ/π over the half sphere: ‖f‖² = 2/(3π); its mean there is 1/(2π), its projection 1/(4π)."""
    found = lobes.residuals(lobes.lambert(), 0.7, [1, 2], 48)
    np.testing.assert_allclose(found.projection[0], math.sqrt(7) / 4, rtol=1e-9)
    np.testing.assert_allclose(found.hemisphere, [0.5, 0], atol=1e-7)
    assert found.warped is None


def test_residuals_of_ggx() -> None:
    lobe = lobes.ggx(0.5)
    found = lobes.residuals(lobe, 0.7, [4, 8], 48)
    assert lobe.bsdf is not None
    np.testing.assert_allclose(found.hemisphere, [float(lobe.bsdf.residual(0.7, n)) for n in (4, 8)], rtol=0.03)
    narrow = lobes.residuals(lobes.ggx(0.3), 0.7, [8], 48)
    assert narrow.warped is not None
    assert narrow.warped[0] <= 0.03 <= 0.5 <= narrow.hemisphere[0]


def test_oren_nayar() -> None:
    directions = np.array([lobes.view_direction(c) for c in (0.2, 0.6, 1.0)])
    np.testing.assert_allclose(lobes.oren_nayar(0.0).value(directions, 0.4), directions[:, 2] / math.pi, rtol=1e-12)
    rough = lobes.oren_nayar(0.5)
    for cos_i, cos_o in ((0.3, 0.8), (0.9, 0.1)):  # towards the viewer and away: f is the same both ways
        for sign in (1, -1):
            there = rough.value(lobes.view_direction(cos_i) * [sign, 1, 1], cos_o) / cos_i
            back = rough.value(lobes.view_direction(cos_o) * [sign, 1, 1], cos_i) / cos_o
            assert there == pytest.approx(back, rel=1e-12)
    assert rough.value(lobes.view_direction(0.5), 0.5) > 1.2 * rough.value(lobes.view_direction(0.5) * [-1, 1, 1], 0.5)


def test_lights_about_a_lobe() -> None:
    lights = about_lobe(np.random.default_rng(2), 0.1, 0.6, np.full(300, 0.2))
    np.testing.assert_allclose(np.linalg.norm(lights.centers, axis=-1), 1, rtol=1e-12)
    np.testing.assert_allclose(lights.radii, math.sin(0.2), rtol=1e-12)
    assert (abs(lights.centers[::3, 2]) < lights.radii[::3]).all()  # cut by the horizon
    off = np.arccos(np.clip(lights.centers @ (lobes.view_direction(0.6) * [-1, 1, 1]), -1, 1))
    assert np.median(off[1::3]) <= 0.3 <= 0.6 <= np.median(off[2::3])


# --- what is chosen -----------------------------------------------------------------------------------------------


def test_the_order_that_stays_within_a_tolerance() -> None:
    errors = np.array([0.5, 0.01, 0.02, 0.01, 0.001])
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 0.01) == 4
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 1.0) == 1
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 1e-4) is None


def place(roughness: float = 0.5, half_angle: float = 0.3) -> Any:
    lights = about_lobe(np.random.default_rng(1), roughness**2, 0.6, np.full(9, half_angle))
    return which_method._Place(0.6, roughness, lights)


def ways(family: str) -> list[which_method.Way]:
    known = {family.name: family for family in which_method.families()}
    return [which_method.Way(known[family], size) for size in known[family].sizes]


@pytest.mark.parametrize(("roughness", "half_angle"), [(1.0, 0.01), (0.4, 0.2), (0.1, 1.0)])
def test_the_truth_is_better_than_any_tolerance(roughness: float, half_angle: float) -> None:
    cell = place(roughness, half_angle)
    outline = cell.lights.shade(cell.bsdf, "outline", tolerance=1e-7 * cell.brightest)
    np.testing.assert_allclose(cell.truth, outline, rtol=0, atol=1e-5 * cell.brightest)


def test_the_cheapest_way_that_meets_the_tolerance() -> None:
    cell, clock = place(), Clock(rounds=1)
    cell.tolerant = []
    plain, warped = ways("plain"), ways("warped")
    costs = {way: 1 + 0.01 * way.size for way in warped} | {way: 2 + 0.01 * way.size for way in plain}
    truth = cell.lights.shade(shlight.Bsdf.ggx(0.5, 1.0), "outline", tolerance=1e-9)

    def rms(way: which_method.Way) -> float:
        error = cell.lights.shade(shlight.Bsdf.ggx(0.5, 1.0), way.family.method, order=int(way.size)) - truth
        return float(np.sqrt(np.mean(error**2)) / truth.max())

    for tolerance, choice in zip(which_method.TOLERANCES, cell.cheapest(costs, clock), strict=True):
        assert choice.way is not None
        assert choice.way.family.name == "warped"
        assert rms(choice.way) <= tolerance
        assert all(rms(way) > tolerance for way in warped if way.size < choice.way.size)
        assert choice.rms == pytest.approx(rms(choice.way), rel=1e-3, abs=1e-7)
        assert choice.microseconds == costs[choice.way]
    dearer = {way: cost + (9 if way.family.name == "warped" else 0) for way, cost in costs.items()}
    assert [choice.way.family.name for choice in cell.cheapest(dearer, clock)] == ["plain"] * 3
    narrow = place(roughness=0.1)
    narrow.tolerant = []
    assert all(choice.way is None for choice in narrow.cheapest(dict.fromkeys(plain[:3], 1.0), clock))


def test_a_disturbed_measurement_does_not_choose() -> None:
    one, two = ways("plain")[:2]
    costs = [{one: a, two: b} for a, b in [(1.0, 2.0), (9.0, 2.1), (1.2, 2.2), (1.3, 2.3)]]
    found = which_method.smoothed(costs)
    np.testing.assert_allclose([here[one] for here in found], [1.2, 1.2, 1.3, 1.3])
    np.testing.assert_allclose([here[two] for here in found], [2.1, 2.1, 2.2, 2.2])


# --- pictures -----------------------------------------------------------------------------------------------------


def noisy(rng: np.random.Generator, truth: Any, sigma: float) -> Any:
    return (truth + sigma * rng.normal(size=truth.shape)).astype(np.float32)


def test_the_references_noise_does_not_count_as_error() -> None:
    rng = np.random.default_rng(4)
    truth = np.ones((200, 300, 4))
    reference = picture_measure.Reference((noisy(rng, truth, 0.03), noisy(rng, truth, 0.03)), 2)
    error = reference.error(noisy(rng, truth, 0.01))
    assert abs(error.value - 1e-4 / 1.01) <= 4 * error.uncertainty <= 1e-4
    perfect = reference.error(truth)
    assert abs(perfect.value) <= 4 * perfect.uncertainty
    assert str(picture_measure.Error(1e-6, 2e-6)) == "≤ 4e-06"
    assert str(picture_measure.Error(3e-5, 2e-6)) == "3.0e-05"


def test_equal_time_and_equal_quality(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures of noise, on a clock that they turn themselves: 2 s, and 0.1 s a sample."""
    now = [0.0]
    monkeypatch.setattr(picture_measure.time, "perf_counter", lambda: now[0])
    truth = np.ones((200, 300, 4))
    seeds: list[int] = []

    def harmonics(scene: Any, effort: Any, rays: Any, order: Any, **options: Any) -> Any:
        now[0] += 2.0
        return noisy(np.random.default_rng(1), truth, 0.02)

    def monte_carlo(scene: Any, effort: Any, samples: int, *, seed: int, **options: Any) -> Any:
        now[0] += 0.1 * samples
        seeds.append(seed)
        return noisy(np.random.default_rng([seed, samples]), truth, 0.2 / np.sqrt(samples))

    monkeypatch.setattr(picture_measure, "_harmonics", harmonics)
    monkeypatch.setattr(picture_measure, "_monte_carlo", monte_carlo)
    effort = replace(pictures.QUICK, half_samples=256, samples=(1, 16), most_samples=120)
    setting = replace(pictures.SETTINGS[0], build=lambda: None)
    found = picture_measure.compare(setting, effort, 7, lambda share, text: None)
    assert found.equal_time.effort == "20 samples a pixel"
    assert found.equal_time.seconds == pytest.approx(2.0)
    assert found.shown.error.value == pytest.approx(4e-4 / 1.01, rel=0.1)
    # (0.2 / 0.02)² samples have the same error, 0.1 s each.
    assert found.reached
    assert found.samples_for_quality == pytest.approx(100, rel=0.1)
    assert found.seconds_for_quality == pytest.approx(10, rel=0.1)
    # The reference shares no random number with what is compared to it.
    assert seeds[:2] == [8, 9]
    assert set(seeds[2:]) == {7}
    fewer = picture_measure.compare(setting, replace(effort, most_samples=50), 7, lambda share, text: None)
    assert not fewer.reached
    assert fewer.seconds_for_quality == pytest.approx(10, rel=0.1)
