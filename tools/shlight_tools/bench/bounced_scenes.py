# SPDX-License-Identifier: MIT
"""Scenes of the picture bench whose light bounces, as those of picture_scenes."""

from __future__ import annotations

import importlib.util
import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from shlight import images
from shlight._arrays import Floats
from shlight.commands import CommandError
from shlight_tools.charts.scenes import Colour, Mesh, Point, ball, box, grid_mesh, knot, revolved, vase

from .picture_scenes import BallLamp, Light, PictureScene, Sun, Thing, checked_floor, floor, lamp_at, quad

BOUNCES = 4
WHITE: Colour = (0.8, 0.8, 0.8)


def _shell(low: Point, high: Point, colors: dict[str, Colour]) -> list[Thing]:
    """The walls of a box, each by its side; one without a colour is left open."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners: dict[str, list[Point]] = {
        "floor": [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)],
        "ceiling": [(x0, y0, z1), (x0, y1, z1), (x1, y1, z1), (x1, y0, z1)],
        "left": [(x0, y0, z0), (x0, y1, z0), (x0, y1, z1), (x0, y0, z1)],
        "right": [(x1, y1, z0), (x1, y0, z0), (x1, y0, z1), (x1, y1, z1)],
        "back": [(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)],
        "front": [(x1, y0, z0), (x0, y0, z0), (x0, y0, z1), (x1, y0, z1)],
    }
    return [Thing(quad(corners[side]), color) for side, color in colors.items()]


def cornell() -> PictureScene:
    """The Cornell box."""
    grey = dict.fromkeys(("floor", "ceiling", "back"), (0.4, 0.4, 0.4))
    things = _shell((-5.56, 0, 0), (0, 5.592, 5.488), {**grey, "left": (0.5, 0.0, 0.0), "right": (0.0, 0.5, 0.0)})
    things += [
        Thing(box((-3.68, 3.51, 1.65), (1.65, 1.65, 3.3), 0.3007), (0.5, 0.5, 0.5)),
        Thing(box((-1.85, 1.69, 0.825), (1.65, 1.65, 1.65), -0.29), (0.5, 0.5, 0.5)),
        Thing(
            quad([(-3.43, 2.27, 5.478), (-3.43, 3.32, 5.478), (-2.13, 3.32, 5.478), (-2.13, 2.27, 5.478)]),
            emission=(30.0, 28.0, 26.0),
        ),
    ]
    return PictureScene(things, eye=(-2.78, -8.0, 2.73), target=(-2.78, 0.0, 2.73), fov=0.6832, max_bounces=BOUNCES)


def daylight() -> PictureScene:
    """A closed room lit by sky and sun through one window."""
    sides = ("ceiling", "right", "back", "front")
    things = _shell((-2, -2.5, 0), (2, 2.5, 2.7), {**dict.fromkeys(sides, WHITE), "floor": (0.45, 0.3, 0.18)})
    # The wall of the window: below, above and beside it.
    wall: list[tuple[Point, Point]] = [
        ((-2.125, 0, 0.4), (0.25, 5.5, 0.8)),
        ((-2.125, 0, 2.55), (0.25, 5.5, 0.5)),
        ((-2.125, -1.75, 1.55), (0.25, 2.0, 1.5)),
        ((-2.125, 2.2, 1.55), (0.25, 1.1, 1.5)),
    ]
    things += [Thing(box(center, size, 0.0), WHITE) for center, size in wall]
    things += [
        Thing(box((0.9, 1.2, 0.36), (1.4, 0.8, 0.72), 0.15), (0.5, 0.32, 0.2)),
        Thing(vase((0.7, 1.2, 0.72), 0.6), (0.2, 0.47, 0.43)),
        Thing(ball((1.25, 1.15, 0.9), 0.18), (0.9, 0.7, 0.4), 0.4),
        Thing(box((-0.7, 1.6, 0.25), (0.5, 0.5, 0.5), 0.5), (0.7, 0.2, 0.15)),
    ]
    sun = Sun((1.0, 0.15, -0.85), math.radians(0.53), (8.0, 7.2, 6.0))
    return PictureScene(
        things,
        [sun],
        sky=(1.2, 1.6, 2.2),
        max_bounces=BOUNCES,
        eye=(0.3, -2.3, 1.5),
        target=(-0.1, 1.5, 1.05),
        fov=math.radians(68),
    )


def lounge() -> PictureScene:
    """A room with 35 thousand triangles and six lamps."""
    plain = dict.fromkeys(("ceiling", "back", "front"), (0.66, 0.66, 0.64))
    colors = {**plain, "floor": (0.62, 0.58, 0.53), "left": (0.62, 0.25, 0.18), "right": (0.18, 0.36, 0.52)}
    things = _shell((-2.6, -5, 0), (2.6, 2, 3.2), colors)
    things += [
        Thing(knot((0.2, 0.3, 0.85), 0.85, 0.15), (0.8, 0.6, 0.3), 0.4),
        Thing(vase((-1.4, 0.7, 0.0), 1.4), (0.2, 0.47, 0.43)),
        Thing(box((1.5, 0.6, 0.4), (0.8, 0.8, 0.8), 0.5), (0.7, 0.68, 0.6)),
        Thing(vase((1.5, 0.6, 0.8), 0.5), (0.7, 0.7, 0.2), principled={"roughness": 0.25}),
    ]
    lamps: list[Light] = [
        lamp_at((0.3, -0.4, 3.1), (0.3, -0.3, 0), 1.0, 1.0, (5, 4.7, 4.4)),
        lamp_at((-2.5, -1.5, 1.6), (0, 0.2, 1), 0.9, 1.2, (2, 2.7, 4)),
        BallLamp((-2.1, 1.5, 2.2), 0.12, (14, 10, 6)),
        BallLamp((2.1, 1.5, 2.0), 0.12, (14, 10, 6)),
        lamp_at((2.5, -1.0, 2.4), (0.2, 0.3, 0.8), 0.3, 0.8, (6, 3, 2)),
        BallLamp((1.2, -1.4, 2.6), 0.2, (4, 4, 5)),
    ]
    return PictureScene(things, lamps, eye=(0.05, -4.8, 1.7), target=(0.05, 0.6, 1.1), max_bounces=BOUNCES)


def glossy_balls() -> PictureScene:
    """Metal balls of growing roughness on a dark floor."""
    things = [floor(color=(0.06, 0.06, 0.06))]
    for i, roughness in enumerate((0.1, 0.2, 0.3, 0.5, 0.8)):
        things.append(Thing(ball((1.15 * (i - 2), 0, 0.5), 0.5), (0.90, 0.87, 0.82), roughness))
    lamps: list[Light] = [
        BallLamp((-2.6, -2.4, 3.0), 0.6, (18.3, 15.7, 12.8)),
        lamp_at((2.6, -1.6, 2.8), (0, 0, 0.5), 1.8, 1.0, (33.1, 39.5, 46.0)),
        BallLamp((0.4, -2.2, 4.0), 0.15, (68.0, 68.0, 68.0)),
    ]
    return PictureScene(things, lamps, max_bounces=BOUNCES, eye=(0, -6.5, 4.6), target=(0, -0.2, 0.35), fov=0.75)


def _sweep() -> Mesh:
    """A floor that bends upwards into a wall behind."""
    angle = np.linspace(0, math.pi / 2, 33)
    bend = np.stack([1.5 + 1.5 * np.sin(angle), 1.5 - 1.5 * np.cos(angle)], axis=-1)
    profile = np.concatenate([[(-6.0, 0.0)], bend, [(3.0, 6.0)]])
    points = np.stack(np.broadcast_arrays(np.array([[-6.0, 6.0]]), profile[:, :1], profile[:, 1:]), axis=-1)
    return grid_mesh(np.swapaxes(points, 0, 1), closed=(False, False))


def _rounded(points: list[tuple[float, float]], steps: int = 24) -> Floats:
    """A profile for `revolved` that bends at the points (radius, height)."""
    corners = np.array(points)
    ends = (corners[:-1] + corners[1:]) / 2
    t = np.linspace(0, 1, steps)[:, None]
    bends = [
        (1 - t) ** 2 * a + 2 * t * (1 - t) * c + t**2 * b
        for a, c, b in zip(ends[:-1], corners[1:-1], ends[1:], strict=True)
    ]
    return np.concatenate([corners[:1], *bends, corners[-1:]])


def _turned(profile: Floats, center: Point, segments: int = 128) -> Mesh:
    """The curve turned about the vertical, open by a hair at the axis, where it would have no normals."""
    return revolved(np.maximum(profile, (1e-4, 0.0)), center, segments)


def _sharp(profile: list[tuple[float, float]], center: Point, color: Colour) -> list[Thing]:
    """The same with an edge at each point."""
    return [Thing(_turned(np.array(piece), center), color) for piece in pairwise(profile)]


def product() -> PictureScene:
    """A bottle, its cap and its carton on a sweep under three area lamps."""
    bottle = _rounded([(0, 0), (0.42, 0), (0.42, 0), (0.42, 0.6), (0.42, 1.1), (0.14, 1.2), (0.14, 1.35), (0, 1.35)])
    cap = _rounded([(0, 0), (0.17, 0), (0.17, 0), (0.17, 0.25), (0.17, 0.3), (0.1, 0.3), (0, 0.3)])
    things = [
        Thing(_sweep(), (0.75, 0.74, 0.72)),
        Thing(_turned(bottle, (0.0, 0.0, 0.0)), (0.05, 0.25, 0.45), principled={"roughness": 0.15}),
        Thing(_turned(cap, (0.0, 0.0, 1.3)), (0.9, 0.75, 0.45), 0.25),
        Thing(box((0.95, 0.35, 0.6), (0.7, 0.5, 1.2), 0.35), (0.75, 0.3, 0.2)),
        Thing(ball((-0.75, -0.2, 0.22), 0.22), (0.85, 0.85, 0.85), principled={"roughness": 0.4}),
    ]
    lamps = [
        lamp_at((-2.6, -1.6, 2.6), (0, 0, 0.7), 1.6, 1.6, (8, 7.8, 7.4)),
        lamp_at((2.8, -1.2, 1.8), (0, 0, 0.6), 0.8, 2.0, (3.4, 3.6, 4)),
        lamp_at((0, 0.8, 3.6), (0, 0.1, 0.5), 2.4, 0.8, (5, 5, 5)),
    ]
    return PictureScene(things, lamps, max_bounces=BOUNCES, eye=(0.15, -4.6, 1.5), target=(0.15, 0, 0.75))


def chrome() -> PictureScene:
    """Glass and chrome on a floor with a picture."""
    glass = {"transmission_weight": 1.0, "ior": 1.45}
    things = [
        checked_floor(),
        Thing(ball((-1.1, 0.3, 0.7), 0.7), (0.9, 0.9, 0.9), 0.0),
        Thing(ball((0.45, -0.3, 0.6), 0.6), (1.0, 1.0, 1.0), principled={**glass, "roughness": 0.0}),
        Thing(ball((1.6, 0.5, 0.5), 0.5), (0.9, 1.0, 0.95), principled={**glass, "roughness": 0.3}),
        Thing(box((0.5, 1.4, 0.5), (0.9, 0.9, 1.0), 0.4), (0.95, 0.65, 0.5), 0.12),
        Thing(ball((-0.3, -1.3, 0.25), 0.25), (0.8, 0.15, 0.1)),
    ]
    lamps = [
        lamp_at((-3, -3, 4), (0, 0, 0.5), 1.6, 1.6, (7, 6.2, 5)),
        lamp_at((3.5, -1, 3), (0, 0, 0.5), 1.0, 1.6, (4, 5, 7)),
    ]
    return PictureScene(things, lamps, sky=(0.25, 0.3, 0.35), target=(0.15, 0, 0.5), max_bounces=BOUNCES)


def pavilion() -> PictureScene:
    """Columns and a roof in the open, under a photographed sky that comes with Blender's module."""
    stone: Colour = (0.6, 0.55, 0.47)
    plinth = [(2.0, 0.0), (2.0, 0.15), (1.8, 0.15), (1.8, 0.3), (0.0, 0.3)]
    column = _rounded([(0.17, 0), (0.17, 0.05), (0.13, 0.2), (0.11, 1.9), (0.17, 2.05), (0.17, 2.1)])
    roof = [(0.0, 0.0), (1.75, 0.0), (1.75, 0.2), (1.6, 0.2), (1.2, 0.55), (0.65, 0.8), (0.0, 0.9)]
    things = [
        floor(20.0, (0.16, 0.2, 0.09)),
        *_sharp(plinth, (0.0, 0.0, 0.0), stone),
        *_sharp(roof, (0.0, 0.0, 2.4), (0.45, 0.2, 0.14)),
        Thing(knot((0.0, 0.0, 1.15), 0.6, 0.11), (0.55, 0.35, 0.2), 0.3),
    ]
    for i in range(8):
        turn = 2 * math.pi * (i + 0.5) / 8
        things.append(Thing(_turned(column, (1.45 * math.cos(turn), 1.45 * math.sin(turn), 0.3), 64), stone))
    return PictureScene(
        things, sky=_photographed_sky("forest.exr"), max_bounces=BOUNCES, eye=(1.2, -6.2, 1.7), target=(0.0, 0.0, 1.45)
    )


def _photographed_sky(name: str) -> Floats:
    module = importlib.util.find_spec("bpy")
    found = [] if module is None or module.origin is None else Path(module.origin).parent.rglob(f"world/{name}")
    for path in found:
        return np.maximum(images.read_exr(path)[..., :3], 0.0)
    raise CommandError("the scene pavilion needs a sky of the module bpy: pip install 'shlight[blender]'", 1)


def studio() -> PictureScene:
    """A white studio, where most of the light has bounced."""
    sides = ("floor", "ceiling", "left", "right", "back", "front")
    things = _shell((-3, -4, 0), (3, 3, 3), dict.fromkeys(sides, (0.88, 0.88, 0.88)))
    things += [
        Thing(box((-1.1, 0.9, 0.75), (0.9, 0.9, 1.5), 0.4), (0.85, 0.85, 0.83)),
        Thing(ball((0.3, 0.4, 0.6), 0.6), (0.88, 0.87, 0.85)),
        Thing(vase((1.5, 0.8, 0.0), 1.3), (0.8, 0.5, 0.45), principled={"roughness": 0.3}),
        Thing(box((0.9, -0.7, 0.15), (0.6, 0.4, 0.3), -0.3), (0.5, 0.65, 0.8)),
    ]
    lamps = [
        lamp_at((-2.8, -1.5, 1.9), (0, 0.5, 0.6), 1.4, 1.4, (2.2, 2.2, 2.1)),
        lamp_at((1.4, -0.5, 2.9), (0.5, 0.3, 0), 1.2, 0.6, (2.0, 2.0, 2.1)),
    ]
    return PictureScene(things, lamps, eye=(0.1, -3.8, 1.5), target=(0.1, 0.6, 0.9), max_bounces=BOUNCES)


BOUNCED_SCENES = {
    "cornell": cornell,
    "daylight": daylight,
    "lounge": lounge,
    "glossy balls": glossy_balls,
    "product": product,
    "chrome": chrome,
    "pavilion": pavilion,
    "studio": studio,
}
