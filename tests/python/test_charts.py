# SPDX-License-Identifier: MIT
"""A small drawing of each figure of `./dev charts`."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from shlight_tools.charts import (
    figures,
    growth,
    measure,
    order_error,
    pictures,
    speed_error,
    stability,
    style,
    which_method,
)
from shlight_tools.charts.figure import Figure, Run
from shlight_tools.charts.lights import CLASSES

QUICK = ("growth", "order_error")


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (growth, speed_error, stability):
        for name in ("all_series", "main_series"):
            if hasattr(module, name):
                monkeypatch.setattr(module, name, lambda kind: measure.all_series(kind)[:2])
    monkeypatch.setattr(growth, "SHOWN", ("sphere_whole", "sphere_clipped"))
    monkeypatch.setattr(speed_error, "CLASSES", CLASSES[1:2])
    monkeypatch.setattr(speed_error, "QUICK_ORDERS", (1, 8))
    monkeypatch.setattr(stability, "REGIONS", stability.REGIONS[:1])
    monkeypatch.setattr(stability, "KINDS", {"sphere": "spheres"})
    monkeypatch.setattr(order_error, "ROUGHNESSES", [0.3])
    monkeypatch.setattr(order_error, "ORDERS", (1, 2, 4, 8, 16))
    monkeypatch.setattr(which_method, "VIEWS", (0.5,))
    monkeypatch.setattr(which_method, "QUICK", which_method.Grid((0.02, 1.0), (0.3, 0.9), 6))
    quick = replace(pictures.QUICK, width=24, height=15, half_samples=8, most_samples=8, rays=((1, 1),), rounds=1)
    monkeypatch.setattr(pictures, "QUICK", quick)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize(
    "figure",
    [pytest.param(own, marks=() if own.name in QUICK else pytest.mark.slow, id=own.name) for own in figures.FIGURES],
)
def test_a_small_drawing_of_each_figure(figure: Figure, tmp_path: Path) -> None:
    shares: list[float] = []
    run = Run(figure.name, tmp_path, quick=True, report=lambda share, _: shares.append(share))
    with style.look():
        drawn = figure.draw(run)
    assert shares == sorted(shares)
    assert 0 <= shares[0] <= shares[-1] <= 1
    assert all(table.rows for table in drawn.tables)
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".png"}
    for path in tmp_path.glob("*.csv"):
        with path.open(newline="") as stream:
            for row in csv.DictReader(stream):
                assert float(row.get("microseconds") or row.get("seconds") or 1) > 0
                if row.get("method", "").startswith("exact") and "worst_error" in row:
                    assert float(row["worst_error"]) <= (3e-6 if row["precision"] == "float32" else 1e-13)
                if figure.name == "which_method":
                    assert float(row["rms_error"]) <= float(row["tolerance"])
