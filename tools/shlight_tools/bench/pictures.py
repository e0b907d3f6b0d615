# SPDX-License-Identifier: MIT
"""Renders on one thread: where the time of one goes, and how it grows with the lamps."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

import shlight
from shlight_tools.charts.scenes import gold_room, matt_room

from .lamps import icosphere, many_lights, under_mesh
from .rounds import Spread, Work
from .row import Row
from .run import Run, duration

Size = tuple[int, int]
Works = dict[str, Work]

ROOMS: dict[str, Callable[[], shlight.Scene]] = {"matt room": matt_room, "gold room": gold_room}
ROOM_SIZE, MANY_SIZE, SPHERES_SIZE, EMITTER_SIZE = (160, 100), (96, 72), (32, 24), (64, 48)
RAYS = 4  # of the camera, per pixel, at least, in a room

RADIUS, ANGLE = 0.02, 0.9  # of lamps with extent; of the view
DETAIL = ANGLE / 24  # as of one part of a fine picture
FEW_FACES, MANY_FACES = 1, 7  # subdivisions of an icosahedron


def rooms(run: Run) -> Works:
    """Renders of the rooms, which return pairs of a picture and a report."""
    options = {"pixel_samples": RAYS, "return_report": True}
    return {name: _rendered(build(), run.size(ROOM_SIZE), **options) for name, build in ROOMS.items()}


def many(run: Run) -> list[Works]:
    """For each kind of lamp a picture under ten of them, and pictures under more of the same total strength."""

    def pictures(kind: str, counts: tuple[int, ...], size: Size, radius: float, angle: float = ANGLE) -> Works:
        return {f"{count} {kind}": _rendered(many_lights(count, radius, angle), run.size(size)) for count in counts}

    return [
        pictures("point lights", (10, 100, 1000), MANY_SIZE, 0.0),
        pictures("spheres", (10, 1000), SPHERES_SIZE, RADIUS),
        pictures("spheres, detail", (10, 1000), SPHERES_SIZE, RADIUS, DETAIL),
    ]


def emitters(run: Run) -> list[Works]:
    """For each material a picture under a mesh of few faces, and one under a mesh of many."""
    lamps = [icosphere(FEW_FACES), icosphere(MANY_FACES)]
    return [
        {
            f"{len(lamp[1])} faces over {kind} things": _rendered(under_mesh(lamp, bsdf), run.size(EMITTER_SIZE))
            for lamp in lamps
        }
        for kind, bsdf in (("matt", shlight.Bsdf.lambert(0.8)), ("glossy", shlight.Bsdf.ggx(0.5, 0.9)))
    ]


def measure_stages(run: Run) -> list[Row]:
    """Time of each stage in the rooms. The rest goes into decisions on further rays, and into waiting."""
    run = run.shorter()
    rows: list[Row] = []
    for i, (name, work) in enumerate(rooms(run).items()):
        reports = []
        for turn in range(-1, run.rounds):
            run.step((i + (turn + 1) / (run.rounds + 1)) / len(ROOMS), name)
            reports.append(work.call()[1])
        del reports[0]  # which compiled the scene and made its fits
        whole = np.array([report.render_seconds for report in reports])
        stages = {stage: np.array([r.stage_seconds[stage] for r in reports]) for stage in reports[0].stage_seconds}
        stages["rest"] = np.maximum(0.0, whole - sum(stages.values()))
        for stage, seconds in stages.items():
            detail = f"{Spread.of(100 * seconds / whole).median:.1f} % of {duration(whole)}"
            rows.append(Row.of(run.section, f"{name}, {stage}", Spread.of(1000 * seconds), "ms", detail=detail))
    return rows


def _rendered(scene: shlight.Scene, size: Size, **options: object) -> Work:
    return Work(partial(shlight.render, scene, *size, threads=1, **options, max_bounces=0), 1)
