# SPDX-License-Identifier: MIT
"""`./dev bench picture`, with small pictures of shlight alone."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from shlight.images import read_texture
from shlight_tools.bench import picture
from shlight_tools.bench.picture_renderers import Cycles, Image, Shlight


@pytest.mark.slow
@pytest.mark.parametrize(("chosen", "scene"), [("balls", "balls"), ("--bounces", "cornell")])
def test_curves_reach_the_chart_and_the_table(
    chosen: str, scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(picture, "QUICK_BOUNCED", ("cornell",))
    monkeypatch.setattr(picture, "QUICK", picture.Effort(32, 2, 1.5, 6.0))
    monkeypatch.setattr(picture, "_renderers", lambda: [Shlight])
    assert picture.main([chosen, "--quick", "--out", str(tmp_path)]) == 0
    with (tmp_path / "picture.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["renderer"] for row in rows} == {"shlight"}
    assert {row["round"] for row in rows} == {"1", "2"}
    for number in "12":
        errors = [float(row["rel_mse"]) for row in rows if row["round"] == number]
        assert errors[-1] < 0.5
    assert len(np.unique(read_texture(tmp_path / "picture.png"))) > 10  # drawn
    assert f"| scene | shlight |\n| --- | --- |\n| {scene} | " in capsys.readouterr().out


def test_a_sheet_beside_cycles_whose_converged_picture_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    class Grey(Cycles):
        def pictures(self, seconds: float) -> Iterator[tuple[float, Image]]:
            yield seconds, np.full((16, 16, 4), 0.4, dtype=np.float32)

        def halves(self, seconds: float) -> tuple[Image, Image]:
            made.append(seconds)
            return next(self.pictures(seconds))[1], next(self.pictures(seconds))[1]

    renderers = [Shlight, *(lambda scene, size, d=d: Grey(scene, size, denoised=d) for d in (False, True))]
    monkeypatch.setattr(picture, "Cycles", Grey)
    monkeypatch.setattr(picture, "FULL_BOUNCED", picture.Effort(16, 1, 0.5, 0.5))
    monkeypatch.setattr(picture, "_renderers", lambda: renderers)
    for _ in range(2):
        assert picture.main(["--bounces", "product", "--out", str(tmp_path)]) == 0
        assert made == [0.5]
        assert (tmp_path / "sheet.jpg").stat().st_size > 1000
        (tmp_path / "sheet.jpg").unlink()


def test_an_unknown_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert picture.main(["bowls"]) == 2
    assert "bowls" in capsys.readouterr().err


def test_errors_between_measurements() -> None:
    points = [(1.0, 1e-1), (4.0, 1e-3)]
    assert picture.Curve("s", "Cycles", [points]).error_at(2.0) == pytest.approx(1e-2)
    assert picture.Curve("s", "shlight", [points]).error_at(2.0) == 1e-1, "what is on screen"
    assert math.isinf(picture.Curve("s", "Cycles", [points]).error_at(0.5))
    assert picture.Curve("s", "Cycles", [points]).seconds_to(1e-2) == 4.0
