# SPDX-License-Identifier: MIT
"""The figures of `shlight charts` about shading, and what they measure with."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from charts_cases import drawn

import shlight
from shlight import methods
from shlight.charts import lobe_lights, lobes, order_error, which_method
from shlight.charts.lobe_lights import Clock, about_lobe, best_seconds

ORDERS = [1, 2, 4, 8, 16, 64]
CLOCK = Clock(rounds=1)


# --- lobes --------------------------------------------------------------------------------------------------------


def grid_of(lobe: lobes.Lobe, cos_o: float, points: int) -> tuple[lobes.Grid, Any, Any]:
    """The grid, its directions, and the weights of dω."""
    warp = lobes.Warp(lobe.alpha, cos_o)
    grid = lobes.Grid.over(warp, points)
    return grid, warp.direction(grid.warped), grid.weights * warp.density(grid.warped)


@pytest.mark.parametrize("cos_o", [1.0, 0.7, 0.2])
@pytest.mark.parametrize("alpha", [None, 1.0, 0.25, 0.01])
def test_the_warped_hemisphere_is_the_upper_one(alpha: float | None, cos_o: float) -> None:
    _, directions, weights = grid_of(lobes.Lobe("", lambda d, c: d, alpha=alpha), cos_o, 96)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1, rtol=1e-12)
    assert (directions[..., 2] > 0).all()
    assert weights.sum() == pytest.approx(2 * math.pi, rel=2e-3)
    assert (weights * directions[..., 2]).sum() == pytest.approx(math.pi, rel=2e-3)


@pytest.mark.parametrize(("roughness", "cos_o"), [(1.0, 0.7), (0.7, 0.2), (0.5, 0.7), (0.4, 1.0)])
def test_the_hemisphere_fit_is_the_librarys(roughness: float, cos_o: float) -> None:
    lobe = lobes.ggx(roughness)
    _, directions, weights = grid_of(lobe, cos_o, 80)
    _, found = lobes.plain_residuals(directions, lobe.value(directions, cos_o), weights, ORDERS)
    assert lobe.bsdf is not None
    expected = [float(lobe.bsdf.residual(cos_o, order)) for order in ORDERS]
    np.testing.assert_allclose(found, expected, rtol=0.03)


def test_residuals_of_a_cosine_by_hand() -> None:
    """Order 1 of cosθ/π over the half sphere: ‖f‖² = 2/(3π); its mean there is 1/(2π), its projection 1/(4π)."""
    found = lobes.residuals(lobes.lambert(), 0.7, [1, 2], 48)
    np.testing.assert_allclose(found.projection[0], math.sqrt(7) / 4, rtol=1e-9)
    np.testing.assert_allclose(found.hemisphere, [0.5, 0], atol=1e-7)
    assert found.warped is None


def test_the_warp_makes_a_lobe_easy() -> None:
    found = lobes.residuals(lobes.ggx(0.3), 0.7, [8], 64)
    assert found.warped is not None
    assert found.warped[0] <= 0.03 <= 0.5 <= found.hemisphere[0]
    # In its own warp a narrow lobe is always the same.
    narrow = [lobes.residuals(lobes.ggx(roughness), 0.9, [8], 64).warped for roughness in (0.05, 0.1)]
    np.testing.assert_allclose(narrow[0], narrow[1], rtol=0.1)


def test_oren_nayar() -> None:
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(200, 3))
    directions[:, 2] = abs(directions[:, 2])
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    smooth, rough = lobes.oren_nayar(0.0), lobes.oren_nayar(0.5)
    np.testing.assert_allclose(smooth.value(directions, 0.4), directions[:, 2] / math.pi, rtol=1e-12)
    for cos_i, cos_o in ((0.3, 0.8), (0.9, 0.1)):  # towards the viewer and away: f is the same both ways
        for sign in (1, -1):
            there = rough.value(lobes.view_direction(cos_i) * [sign, 1, 1], cos_o) / cos_i
            back = rough.value(lobes.view_direction(cos_o) * [sign, 1, 1], cos_i) / cos_o
            assert there == pytest.approx(back, rel=1e-12)
    # Away from the light it is as dark from everywhere; seen from where the light comes from it is brightest.
    away = [rough.value(lobes.view_direction(c) * [-1, 1, 1], 0.4) / c for c in (0.1, 0.5, 0.9)]
    np.testing.assert_allclose(away, away[0], rtol=1e-12)
    assert rough.value(lobes.view_direction(0.5), 0.5) > 1.2 * rough.value(lobes.view_direction(0.5) * [-1, 1, 1], 0.5)


# --- lights about a lobe ------------------------------------------------------------------------------------------


def test_lights_about_a_lobe() -> None:
    half_angles = np.full(300, 0.2)
    lights = about_lobe(np.random.default_rng(2), 0.1, 0.6, half_angles)
    np.testing.assert_allclose(np.linalg.norm(lights.centers, axis=-1), 1, rtol=1e-12)
    np.testing.assert_allclose(lights.radii, math.sin(0.2), rtol=1e-12)
    cut = abs(lights.centers[:, 2]) < lights.radii
    assert cut[::3].all()
    off = np.arccos(np.clip(lights.centers @ (lobes.view_direction(0.6) * [-1, 1, 1]), -1, 1))
    assert np.median(off[1::3]) <= 0.3 <= 0.6 <= np.median(off[2::3])
    assert (lights.centers[1::3, 2] >= 0).all()
    assert (lights.centers[2::3, 2] >= 0).all()


def test_the_fastest_round_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    now, turns = [0.0], []
    monkeypatch.setattr(lobe_lights.time, "process_time", lambda: now[0])

    def work(name: str, seconds: list[float]) -> Any:
        def spend() -> None:
            turns.append(name)
            now[0] += seconds.pop(0)

        return spend

    assert best_seconds([work("a", [3, 1, 2]), work("b", [5, 6, 4])], 3) == [1, 4]
    assert turns == ["a", "b"] * 3


# --- order against error ------------------------------------------------------------------------------------------


def test_the_order_that_stays_within_a_tolerance() -> None:
    errors = np.array([0.5, 0.01, 0.02, 0.01, 0.001])
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 0.01) == 4
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 1.0) == 1
    assert order_error.order_for([1, 2, 3, 4, 5], errors, 1e-4) is None


def test_order_against_error_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(order_error, "ROUGHNESSES", [0.3])
    result, rows = drawn("order_error", order_error.draw, tmp_path)
    assert (tmp_path / "order_error.png").is_file()
    fits = {(row["material"], row["fit"]) for row in rows}
    assert ("GGX, roughness 0.3", "warped") in fits
    assert ("Lambert", "warped") not in fits
    assert all(float(row["microseconds"]) > 0 for row in rows)
    cells = {row[0]: row[2:] for row in result.tables[0].rows}
    assert cells["Lambert"][1].startswith("2 (")
    assert cells["Lambert"][2] == "–"


# --- which method where -------------------------------------------------------------------------------------------


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
    cell = place()
    cell.tolerant = []
    plain, warped = ways("plain"), ways("warped")
    costs = {way: 1 + 0.01 * way.size for way in warped} | {way: 2 + 0.01 * way.size for way in plain}
    bsdf = shlight.Bsdf.ggx(0.5, 1.0)
    truth = cell.lights.shade(bsdf, "outline", tolerance=1e-9)
    for tolerance, choice in zip(which_method.TOLERANCES, cell.cheapest(costs, CLOCK), strict=True):
        assert choice.way is not None
        assert choice.way.family.name == "warped"

        def rms(way: which_method.Way) -> float:
            error = cell.lights.shade(bsdf, way.family.method, order=int(way.size)) - truth
            return float(np.sqrt(np.mean(error**2)) / truth.max())

        assert rms(choice.way) <= tolerance
        assert all(rms(way) > tolerance for way in warped if way.size < choice.way.size)
        assert choice.rms == pytest.approx(rms(choice.way), rel=1e-3, abs=1e-7)
        assert choice.rms <= choice.worst <= 3 * choice.rms
        assert choice.microseconds == costs[choice.way]
        assert choice.own_rms <= tolerance
    dearer = {way: cost + (9 if way.family.name == "warped" else 0) for way, cost in costs.items()}
    assert [choice.way.family.name for choice in cell.cheapest(dearer, CLOCK)] == ["plain"] * 3


def test_a_disturbed_measurement_does_not_choose() -> None:
    one, two = ways("plain")[:2]
    costs = [{one: a, two: b} for a, b in [(1.0, 2.0), (9.0, 2.1), (1.2, 2.2), (1.3, 2.3)]]
    found = which_method.smoothed(costs)
    np.testing.assert_allclose([here[one] for here in found], [1.2, 1.2, 1.3, 1.3])
    np.testing.assert_allclose([here[two] for here in found], [2.1, 2.1, 2.2, 2.2])
    assert which_method.smoothed(costs[:1]) == costs[:1]


def test_nothing_meets_what_none_can_reach() -> None:
    cell = place(roughness=0.1)
    cell.tolerant = []
    choices = cell.cheapest(dict.fromkeys(ways("plain")[:3], 1.0), CLOCK)
    assert all(choice.way is None and math.isnan(choice.microseconds) for choice in choices)


def test_new_shading_methods_appear_by_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    flags = {"harmonic": False, "adaptive": False, "sampled": False, "random": False}
    new = {
        name: SimpleNamespace(name=name, **{**flags, **changes})
        for name, changes in {
            "series": {"harmonic": True},
            "random": {"sampled": True, "random": True},
            "careful": {"adaptive": True},
            "plain": {},
        }.items()
    }
    real = methods.shading_methods()
    monkeypatch.setattr(methods, "shading_methods", lambda: real | new)
    found = {family.name: family.option for family in which_method.families() if family.method in new}
    assert found == {"series": "order", "random": "samples", "careful": "tolerance", "plain": ""}
    assert which_method.TRUTH not in {family.method for family in which_method.families()}


def test_which_method_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(which_method, "VIEWS", (1.0, 0.5))
    monkeypatch.setattr(which_method, "QUICK", which_method.Grid((0.02, 1.0), (0.3, 0.9), 6))
    result, rows = drawn("which_method", which_method.draw, tmp_path)
    assert (tmp_path / "which_method_method.png").is_file()
    assert (tmp_path / "which_method_time.png").is_file()
    assert len(rows) == 2 * 2 * 2 * 3
    for row in rows:
        assert row["method"] != "none"
        assert float(row["rms_error"]) <= float(row["tolerance"])
        assert float(row["microseconds"]) > 0
    assert [row[0] for row in result.tables[0].rows] == ["0.01", "0.001", "0.0001"]
