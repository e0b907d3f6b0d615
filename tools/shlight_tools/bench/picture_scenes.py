# SPDX-License-Identifier: MIT
"""Scenes of the picture bench as plain arrays, which each renderer's own file turns into its scene.

In metres, z upwards; radiance is linear RGB. Rectangles shine to the side that sees their corners counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import shlight
from shlight import nodes
from shlight._arrays import Floats
from shlight_tools.charts.scenes import Colour, Mesh, Point, ball, box, knot, vase

GREY: Colour = (0.6, 0.6, 0.6)


@dataclass(frozen=True)
class Thing:
    """A mesh of one material: paint, plain or with a picture, metal of a roughness α = roughness², or any other."""

    mesh: Mesh
    color: Colour = GREY
    roughness: float | None = None  # of metal
    principled: dict[str, Any] | None = None  # arguments of nodes.principled beside the colour
    emission: Colour | None = None  # of a surface that does nothing else
    picture: Any = None  # (height, width, 3) of uint8, encoded as sRGB, at …
    uvs: Any = None  # … (triangles, 3, 2)


@dataclass(frozen=True)
class Lamp:
    """A rectangle that shines to one side."""

    corners: Floats
    radiance: Colour


@dataclass(frozen=True)
class BallLamp:
    """A sphere that shines."""

    center: Point
    radius: float
    radiance: Colour


@dataclass(frozen=True)
class Sun:
    """Light in one direction from a disk of an angle [rad]."""

    direction: Point
    angle: float
    irradiance: Colour


Light = Lamp | BallLamp | Sun


@dataclass(frozen=True)
class PictureScene:
    """What is rendered: sky is a radiance, or a picture (height, width, 3) with +z on top and +x in its middle.

    max_bounces: as `shlight.render` has it. The camera sees no lamps, and sees the sky.
    """

    things: list[Thing]
    lamps: Sequence[Light] = ()
    sky: Any = None
    max_bounces: int = 0
    eye: Point = (0.0, -6.0, 2.2)
    target: Point = (0.0, 0.0, 0.7)
    fov: float = math.radians(46)

    @property
    def camera(self) -> Floats:
        """Camera to world: the camera looks along its own -z, y upwards."""
        return shlight.look_at(self.eye, self.target)

    def for_shlight(self) -> shlight.Scene:
        """The scene as `shlight.render` takes it."""
        scene = shlight.Scene()
        for thing in self.things:
            mesh = thing.mesh
            shape: dict[str, Any] = {"normals": mesh.normals, "uvs": thing.uvs}
            scene.add_mesh(mesh.vertices, mesh.triangles, **shape, bsdf=_bsdf(thing), emission=thing.emission)
        for lamp in self.lamps:
            if isinstance(lamp, BallLamp):
                scene.add_sphere_light(lamp.center, lamp.radius, lamp.radiance)
            elif isinstance(lamp, Sun):
                scene.add_sun_light(lamp.direction, lamp.angle, lamp.irradiance)
            else:
                scene.add_polygon_light(lamp.corners, lamp.radiance)
        if self.sky is not None:
            scene.set_environment(self.sky)
        scene.set_camera(self.camera, self.fov)
        return scene


def _bsdf(thing: Thing) -> Any:
    if thing.picture is not None:
        return shlight.Bsdf.lambert(nodes.image(thing.picture, encoding="srgb"))
    if thing.roughness is not None:
        return nodes.glossy(thing.color, thing.roughness)
    if thing.principled is not None:
        return nodes.principled(thing.color, **thing.principled)
    return shlight.Bsdf.lambert((0, 0, 0) if thing.emission else thing.color)


def quad(corners: list[Point]) -> Mesh:
    """A rectangle."""
    points = np.array(corners)
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    normals = np.tile(normal / np.linalg.norm(normal), (4, 1))
    return Mesh(points, normals, np.array([[0, 1, 2], [0, 2, 3]]))


def floor(half: float = 8.0, color: Colour = GREY, **others: Any) -> Thing:
    """A square at z = 0."""
    corners: list[Point] = [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)]
    return Thing(quad(corners), color, **others)


def checked_floor() -> Thing:
    """A floor with a picture."""
    checks = np.kron(np.indices((8, 8)).sum(axis=0) % 2, np.ones((64, 64)))[..., None]
    picture = np.where(checks > 0, (200, 190, 170), (60, 70, 90)).astype(np.uint8)
    return floor(picture=picture, uvs=4.0 * np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]]))


def lamp_at(place: Point, target: Point, width: float, height: float, radiance: Colour) -> Lamp:
    """A rectangular lamp at a place that shines to another."""
    pose = shlight.look_at(place, target)
    right, up = pose[:3, 0] * width / 2, pose[:3, 1] * height / 2
    # Seen from the target, right is left.
    corners = [-right - up, -right + up, right + up, right - up]
    return Lamp(np.array(place) + np.array(corners), radiance)


THREE_LAMPS = [
    lamp_at((-3, -3, 4), (0, 0, 0.5), 1.0, 1.0, (14, 12, 9)),
    lamp_at((3.5, -2, 3), (0, 0, 0.5), 0.6, 1.2, (8, 10, 14)),
    lamp_at((0.5, 3, 5), (0, 0, 0.5), 2.0, 1.0, (5, 5, 5)),
]


def balls() -> PictureScene:
    """Five balls, paint and metal, under three lamps."""
    things = [floor()]
    for i, roughness in enumerate((None, 0.3, None, 0.6, 0.45)):
        color = ((0.8, 0.3, 0.2), (0.9, 0.75, 0.4), (0.2, 0.4, 0.7), (0.85, 0.85, 0.85), (0.9, 0.6, 0.5))[i]
        things.append(Thing(ball((1.15 * (i - 2), 0.3 * (i % 2), 0.5), 0.5), color, roughness))
    return PictureScene(things, THREE_LAMPS)


def fence() -> PictureScene:
    """Thin rods between lamps and floor: nearly all of the picture is penumbra."""
    things = [floor()]
    things += [Thing(box((0.12 * i, 0.6, 0.75), (0.02, 0.02, 1.5), 0.1 * i), (0.5, 0.4, 0.3)) for i in range(-25, 26)]
    things += [Thing(box((0, 0.6, z), (6.2, 0.03, 0.03), 0.0), (0.5, 0.4, 0.3)) for z in (0.3, 1.2)]
    lamps = [
        lamp_at((-2, 4, 3), (0, 0, 0), 0.5, 0.5, (40, 34, 26)),
        lamp_at((2.5, 5, 2.5), (0, 0, 0), 0.3, 1.0, (30, 36, 44)),
    ]
    return PictureScene(things, lamps, eye=(0.0, -5.0, 2.6), target=(0.0, 0.2, 0.3))


def room() -> PictureScene:
    """A closed room with a mesh of 25 thousand triangles."""
    walls: list[tuple[list[Point], Colour]] = [
        ([(-2.6, -5, 0), (2.6, -5, 0), (2.6, 2, 0), (-2.6, 2, 0)], (0.62, 0.58, 0.53)),
        ([(-2.6, 2, 0), (2.6, 2, 0), (2.6, 2, 3.2), (-2.6, 2, 3.2)], (0.66, 0.66, 0.64)),
        ([(-2.6, -5, 0), (-2.6, 2, 0), (-2.6, 2, 3.2), (-2.6, -5, 3.2)], (0.62, 0.25, 0.18)),
        ([(2.6, 2, 0), (2.6, -5, 0), (2.6, -5, 3.2), (2.6, 2, 3.2)], (0.18, 0.36, 0.52)),
        ([(-2.6, -5, 3.2), (-2.6, 2, 3.2), (2.6, 2, 3.2), (2.6, -5, 3.2)], (0.7, 0.7, 0.7)),
    ]
    things = [Thing(quad(corners), color) for corners, color in walls]
    things += [
        Thing(knot((0.2, 0.3, 0.85), 0.85, 0.15), (0.8, 0.6, 0.3), 0.4),
        Thing(vase((-1.4, 0.7, 0.0), 1.4), (0.2, 0.47, 0.43)),
        Thing(box((1.5, 0.6, 0.4), (0.8, 0.8, 0.8), 0.5), (0.7, 0.68, 0.6)),
    ]
    lamps = [
        lamp_at((0.3, -0.4, 3.1), (0.3, -0.3, 0), 1.2, 1.2, (9, 8.5, 8)),
        lamp_at((-2.5, -1.5, 1.6), (0, 0.2, 1), 0.9, 1.2, (3, 4, 6)),
    ]
    return PictureScene(things, lamps, eye=(0.05, -4.8, 1.7), target=(0.05, 0.6, 1.1))


def textured() -> PictureScene:
    """A ball and a floor with pictures."""
    random = np.random.default_rng(4)
    coarse = random.integers(40, 255, (32, 32, 3)).astype(np.uint8)
    fine = np.kron(coarse, np.ones((16, 16, 1), dtype=np.uint8))
    made = ball((0.0, 0.2, 1.0), 1.0)
    at = made.normals[made.triangles].reshape(-1, 3)
    azimuth, elevation = np.arctan2(at[:, 1], at[:, 0]), np.arcsin(at[:, 2].clip(-1, 1))
    uvs = np.stack([azimuth / (2 * math.pi) + 0.5, elevation / math.pi + 0.5], axis=1).reshape(-1, 3, 2)
    things = [checked_floor(), Thing(made, picture=fine, uvs=uvs)]
    return PictureScene(things, THREE_LAMPS[:2], target=(0.0, 0.0, 0.8))


def lamps() -> PictureScene:
    """Balls under a hundred small lamps."""
    random = np.random.default_rng(6)
    found = []
    for _ in range(100):
        x, y = random.uniform(-5, 5, 2)
        color = random.uniform(0.3, 1.0, 3) * 8
        place = (float(x), float(y), float(random.uniform(2.5, 4.5)))
        found.append(lamp_at(place, (0.3 * x, 0.3 * y, 0), 0.25, 0.25, tuple(color.tolist())))
    return PictureScene(balls().things, found)


def sky() -> PictureScene:
    """Balls under a picture of a sky with a bright patch."""
    width, height = 512, 256
    azimuth = (np.arange(width) + 0.5) / width * 2 * math.pi - math.pi
    elevation = math.pi / 2 - (np.arange(height) + 0.5) / height * math.pi
    up = np.sin(elevation)[:, None, None]
    pixels = np.where(up > 0, np.array((0.3, 0.5, 0.9)) + (1 - up) * 0.5, 0.15) * np.ones((height, width, 1))
    place = np.stack(
        [
            np.cos(elevation)[:, None] * np.cos(azimuth),
            np.cos(elevation)[:, None] * np.sin(azimuth),
            np.sin(elevation)[:, None] * np.ones(width),
        ],
        axis=-1,
    )
    patch = np.array((-0.6, -0.5, 0.62)) / np.linalg.norm((-0.6, -0.5, 0.62))
    pixels[place @ patch > math.cos(math.radians(6))] = (60, 52, 40)
    return PictureScene(balls().things, sky=pixels.astype(np.float32))


PICTURE_SCENES = {
    "balls": balls,
    "fence": fence,
    "room": room,
    "textured": textured,
    "100 lamps": lamps,
    "sky": sky,
}
