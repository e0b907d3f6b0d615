# SPDX-License-Identifier: MIT
"""How a render's time grows with the number of lights: of the same total strength, around the same things."""

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
SIZE, QUICK_SIZE, SPHERES_SIZE = (96, 72), (48, 36), (32, 24)
RADIUS = 0.02  # of lights with extent
SEED = 1
HALF, STRENGTH = 4.0, 30.0  # of the floor; of all lights together
OBSTACLES, EDGE = 6, 0.3
ANGLE, DETAIL = 0.9, 0.9 / 24  # as of one part of a fine picture
EYE, TARGET = (0.0, -6.0, 4.0), (0.0, 0.0, 0.2)


def measure(run: Run) -> list[Row]:
    size = QUICK_SIZE if run.quick else SIZE
    few_and_many = (COUNTS[0], COUNTS[-1])
    return [
        *_rows(run, 0, "point lights", {count: scene_of(count, 0.0) for count in COUNTS}, size),
        *_rows(run, 1, "spheres", {count: scene_of(count, RADIUS) for count in few_and_many}, SPHERES_SIZE),
        *_rows(run, 2, "spheres, detail", {n: scene_of(n, RADIUS, DETAIL) for n in few_and_many}, SPHERES_SIZE),
    ]


def _rows(run: Run, part: int, kind: str, scenes: dict[int, shlight.Scene], size: tuple[int, int]) -> list[Row]:
    works = {
        f"{count} {kind}": Work(partial(shlight.render, scene, *size, threads=1), 1) for count, scene in scenes.items()
    }
    seconds = run.alternate(works, (part, 3))
    least, *others = works
    return [run.ratio(seconds, name, least, unit="×", bound=BOUND if name == others[-1] else None) for name in others]


def scene_of(count: int, radius: float, angle: float = ANGLE) -> shlight.Scene:
    """Tetrahedra on a floor under `count` lights; radius 0: sources without extent. angle: of the view."""
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
        intensity = STRENGTH / count * colour
        if radius == 0:
            scene.add_point_light(position, tuple(intensity))
        else:
            scene.add_sphere_light(position, radius, tuple(intensity / (np.pi * radius**2)))
    scene.set_camera(look_at(EYE, TARGET), angle)
    return scene
