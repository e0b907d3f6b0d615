# SPDX-License-Identifier: MIT
"""The figures of `shlight charts` about coefficients, drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from charts_cases import drawn, dummy
from command_cases import names

from shlight.charts import growth, measure, speed_error, stability
from shlight.charts.figure import Run
from shlight.charts.lights import CLASSES


@pytest.fixture
def only_exact_and_dummy(register: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    register(dummy())
    for module in (growth, speed_error, stability):
        for name in ("all_series", "main_series"):
            if hasattr(module, name):
                few = [series for series in measure.all_series("sphere") if series.label in ("exact", "dummy")]
                monkeypatch.setattr(module, name, lambda kind, few=few: few)


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_growth_draws_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "SHOWN", ("sphere_whole", "sphere_clipped"))
    result, rows = drawn("growth", growth.draw, tmp_path)
    assert (tmp_path / "growth.png").is_file()
    reached = {name: max(int(row["order"]) for row in rows if row["method"] == name) for name in ("exact", "dummy")}
    assert reached == {"exact": 64, "dummy": 8}
    fused = [row for row in rows if "Eq. 5" in row["method"]]
    assert {row["precision"] for row in fused} == {"float32"}
    assert {(row["lights"], row["method"]) for row in fused} == {
        ("sphere_whole", "exact, with Eq. 5"),
        ("sphere_clipped", "exact, with Eq. 5"),
        ("sphere_clipped", "glossy lobe, with Eq. 5"),
    }
    assert all(float(row["microseconds"]) > 0 for row in rows)
    cells = {(row[0], row[1], row[2]): row[3] for row in result.tables[0].rows}
    assert 0 < float(cells["sphere_clipped", "float32", "exact"]) < 4


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_speed_and_error_of_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed_error, "CLASSES", CLASSES[1:2])
    monkeypatch.setattr(speed_error, "QUICK_ORDERS", (1, 2, 8, 16))
    result, rows = drawn("speed_error", speed_error.draw, tmp_path)
    for precision, floor in (("float32", 3e-6), ("float64", 1e-13)):
        assert (tmp_path / f"speed_error_sphere_clipped_{precision}.png").is_file()
        own = [row for row in rows if row["precision"] == precision]
        for row in own:
            error = float(row["worst_error"])
            assert float(row["median_error"]) <= error
            assert error <= floor if row["method"].startswith("exact") else 1e-3 <= error <= 1.1e-2
        assert {row["order"] for row in own if row["method"] == "dummy"} == {"1", "2", "8"}
    ratios = result.tables[0].rows
    assert [row[:3] for row in ratios] == [["sphere_clipped", p, "dummy"] for p in ("float32", "float64")]
    assert all(float(cell) > 0 for row in ratios for cell in row[3:6])
    assert ratios[0][6] == ""


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_a_map_of_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "REGIONS", stability.REGIONS[:2])
    monkeypatch.setattr(stability, "KINDS", {"sphere": "spheres"})
    result, rows = drawn("stability", stability.draw, tmp_path, "stability_sphere_map_8")
    assert [name for name in names(tmp_path) if "map" in name] == [
        f"stability_sphere_map_{order}.{kind}" for order in (16, 8) for kind in ("csv", "png")
    ]
    assert (tmp_path / "stability_sphere_horizon_16.png").is_file()
    for row in rows:
        hidden = np.radians(float(row["elevation [°]"])) < -float(row["half angle [rad]"])
        for method, least, most in (("exact", 0, 3e-6), ("dummy", 1e-6, 1.1e-2)):
            error = row[f"{method}, float32"]
            assert error == "hidden" if hidden else least <= float(error) <= most
    table = {row[2]: row[3:] for row in result.tables[0].rows if row[1] == "all lights"}
    assert all(cell.endswith(" · 0.0 % · 0.0 %") for cell in table["exact"])
    assert [bool(cell) for cell in table["dummy"]] == [True, False, True, False]
    worst, over, broken = table["dummy"][0].split(" · ")
    assert 1e-3 <= float(worst) <= 1.1e-2
    assert float(over.removesuffix(" %")) >= 90
    assert broken == "0.0 %"


def made_map(errors: list[list[float]]) -> stability.Map:
    series = measure.all_series("sphere")[0]
    return stability.Map("sphere", stability.REGIONS[0], 8, "float32", series, np.array(errors))


def test_shares_of_a_map_by_hand() -> None:
    unknown, covered = stability.UNKNOWN, stability.COVERED
    of = made_map([[1e-6, unknown, 0.5], [covered, np.inf, 1e-4]])
    assert of.worst() == 0.5
    assert of.share_over_limit() == 0.5  # what is not finite is above any limit
    assert of.share_not_finite() == 0.25


def test_a_coarse_map_fills_its_picture() -> None:
    unknown = stability.UNKNOWN
    of = made_map([[1, unknown, 2], [unknown] * 3, [3, unknown, 4], [unknown] * 3])
    np.testing.assert_array_equal(stability._filled(of.errors), [[1, 1, 2], [1, 1, 2], [3, 3, 4], [3, 3, 4]])


def test_a_slow_method_has_a_coarse_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "batch_size", lambda *_: 20)
    region = replace(stability.REGIONS[0], title="some lights")
    monkeypatch.setattr(stability, "main_series", lambda kind: measure.all_series(kind)[:1])
    for of in stability._measure(Run("stability", Path(), quick=True), "sphere", region, lambda *_: None):
        rows, columns = (np.flatnonzero(~np.isnan(of.errors).all(axis=axis)) for axis in (1, 0))
        np.testing.assert_array_equal(rows, [0, 3, 6])
        np.testing.assert_array_equal(columns, [0, 3, 6, 9, 12])
