# SPDX-License-Identifier: MIT
"""How a render's time grows with the number of point lights: of the same total strength, around the same things."""

from __future__ import annotations

from functools import partial

import numpy as np

import shlight
from shlight.charts.scenes import look_at

from .rounds import Work
from .row import Row
from .run import Run

COUNTS = (10, 100, 1000)
BOUND = 20.0  # of the most beside the least
SIZE, QUICK_SIZE = (96, 72), (48, 36)
SEED = 1
HALF, STRENGTH = 4.0, 30.0  # of the floor; of all lights together
OBSTACLES, EDGE = 6, 0.3
EYE, TARGET = (0.0, -6.0, 4.0), (0.0, 0.0, 0.2)


def measure(run: Run) -> list[Row]:
    width, height = QUICK_SIZE if run.quick else SIZE
    scenes = {count: scene_of(count) for count in COUNTS}
    works = {
        _name(count): Work(partial(shlight.render, scene, width, height, threads=1), 1)
        for count, scene in scenes.items()
    }
    seconds = run.alternate(works)
    least, most = _name(COUNTS[0]), _name(COUNTS[-1])
    return [
        run.ratio(seconds, _name(count), least, unit="×", bound=BOUND if _name(count) == most else None)
        for count in COUNTS[1:]
    ]


def scene_of(count: int) -> shlight.Scene:
    """Tetrahedra on a floor under `count` point lights."""
    rng = np.random.default_rng(SEED)
    scene = shlight.Scene()
    floor = HALF * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    scene.add_mesh(floor, np.array([[0, 1, 2], [0, 2, 3]]), bsdf=shlight.Bsdf.lambert(0.8))
    corners = EDGE * np.array([[1.0, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    for _ in range(OBSTACLES):
        center = np.append(rng.uniform(-HALF / 2, HALF / 2, 2), EDGE)
        scene.add_mesh(corners + center, faces, bsdf=shlight.Bsdf.lambert(0.6))
    positions = rng.uniform((-3, -3, 1.5), (3, 3, 3), (count, 3))
    for position, colour in zip(positions, rng.uniform(0.5, 1.5, (count, 3)), strict=True):
        scene.add_point_light(position, tuple(STRENGTH / count * colour))
    scene.set_camera(look_at(EYE, TARGET), 0.9)
    return scene


def _name(count: int) -> str:
    return f"{count} point lights"
