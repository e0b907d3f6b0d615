# SPDX-License-Identifier: MIT
"""Where a render's time goes, on one thread; the rest is what decides on further rays, and waits."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

import shlight
from shlight.charts.scenes import gold_room, matt_room

from .rounds import Spread
from .row import Row
from .run import Run, duration

SCENES: Mapping[str, Callable[[], shlight.Scene]] = {"matt room": matt_room, "gold room": gold_room}
WHOLE = "whole"
SIZE, QUICK_SIZE = (160, 100), (64, 40)
RAYS = 4  # of the camera, per pixel, at least


def measure(run: Run) -> list[Row]:
    width, height = QUICK_SIZE if run.quick else SIZE
    rows: list[Row] = []
    for i, (name, build) in enumerate(SCENES.items()):
        scene = build()
        shlight.render(scene, width, height, pixel_samples=RAYS, threads=1)  # compiles the scene, makes its fits
        seconds: dict[str, list[float]] = {}
        for turn in range(run.rounds):
            run.step((i + turn / run.rounds) / len(SCENES), name)
            report = shlight.render(scene, width, height, pixel_samples=RAYS, threads=1, return_report=True)[1]
            stages = report.stage_seconds
            stages["rest"] = max(0.0, report.render_seconds - sum(stages.values()))
            for stage, spent in {**stages, WHOLE: report.render_seconds}.items():
                seconds.setdefault(stage, []).append(spent)
        whole = np.array(seconds.pop(WHOLE))
        for stage, of_stage in seconds.items():
            spent_in_all = np.array(of_stage)
            share = Spread.of(100 * spent_in_all / whole).median
            detail = f"{share:.1f} % of {duration(whole)}"
            rows.append(Row.of(run.section, f"{name}, {stage}", Spread.of(1000 * spent_in_all), "ms", detail=detail))
    return rows
