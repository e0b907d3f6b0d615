# SPDX-License-Identifier: MIT
"""The two scenes of the pictures: a room and its things, lit by two spheres and a quad, as Fig. 1 of Zhou & Wei 2020.

The same shapes and lights, once in matt paint and once in rough gold. Procedural, in metres, z upwards; the camera
looks along +y.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import shlight
from shlight._arrays import Floats

Colour = tuple[float, float, float]
Point = tuple[float, float, float]

GOLD = (1.0, 0.766, 0.336)
GOLD_ROUGHNESS = 0.5


@dataclass(frozen=True)
class Mesh:
    """Triangles with a normal at each vertex."""

    vertices: Floats
    normals: Floats
    triangles: Floats


def grid_mesh(points: Floats, *, closed: tuple[bool, bool]) -> Mesh:
    """points (k, j, 3) as a surface; closed: whether the last row or column joins the first. Front: ∂k × ∂j."""
    first, second = (_difference(points, axis, closed[axis]) for axis in (0, 1))
    normals = np.cross(first, second)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    index = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    for axis in (0, 1):
        if closed[axis]:
            index = np.concatenate([index, np.take(index, [0], axis)], axis)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return Mesh(points.reshape(-1, 3), normals.reshape(-1, 3), triangles)


def _difference(points: Floats, axis: int, closed: bool) -> Floats:
    if closed:
        return np.roll(points, -1, axis) - np.roll(points, 1, axis)
    return np.gradient(points, axis=axis)


def revolved(profile: Floats, center: Point, segments: int = 128) -> Mesh:
    """A curve (k, 2) of radii and heights, from bottom to top, turned about the vertical through `center`."""
    azimuth = 2 * math.pi * np.arange(segments) / segments
    radius, height = profile[:, :1], profile[:, 1:]
    points = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height + 0 * azimuth], axis=-1)
    # ∂azimuth × ∂height points outwards.
    return grid_mesh(np.swapaxes(points, 0, 1) + np.asarray(center), closed=(True, False))


def ball(center: Point, radius: float) -> Mesh:
    angle = np.linspace(-0.5, 0.5, 65) * math.pi
    made = revolved(radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1), center)
    return Mesh(made.vertices, (made.vertices - np.asarray(center)) / radius, made.triangles)


def vase(center: Point, height: float) -> Mesh:
    """A belly, a neck and a lip that bends outwards."""
    t = np.linspace(0, 1, 97)
    radius = 0.17 + 0.22 * np.sin(math.pi * np.clip(1.25 * t, 0, 1)) ** 2 * (1 - 0.35 * t) + 0.14 * t**7 - 0.04 * t
    return revolved(height * np.stack([radius, t], axis=-1), center)


def knot(center: Point, size: float, thickness: float) -> Mesh:
    """The (2, 3) torus knot as a tube."""
    t = 2 * math.pi * np.arange(320) / 320
    ring = 2 + np.cos(3 * t)
    path = size / 3 * np.stack([ring * np.cos(2 * t), 0.9 * np.sin(3 * t), ring * np.sin(2 * t)], axis=-1)
    along = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    # A frame that cannot twist where the tube closes: towards the knot's own axis, made perpendicular.
    side = np.cross(along, path)
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(along, side)
    phi = 2 * math.pi * np.arange(40) / 40
    # Turned so that ∂t × ∂phi points outwards.
    tube = np.cos(phi)[:, None] * side[:, None] - np.sin(phi)[:, None] * up[:, None]
    return grid_mesh(np.asarray(center) + path[:, None] + thickness * tube, closed=(True, True))


def box(center: Point, size: Point, turn: float) -> Mesh:
    """turn: about the vertical [rad]."""
    c, s = math.cos(turn), math.sin(turn)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    sides = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal, u = np.zeros(3), np.zeros(3)
            normal[axis], u[(axis + 1) % 3] = sign, 1
            v = np.cross(normal, u)
            corners = [normal - u - v, normal + u - v, normal + u + v, normal - u + v]
            sides.append((np.array(corners) * np.asarray(size) / 2, normal))
    vertices = np.concatenate([corners for corners, _ in sides]) @ turned.T + np.asarray(center)
    normals = np.repeat([normal for _, normal in sides], 4, axis=0) @ turned.T
    quads = 4 * np.arange(6)[:, None]
    triangles = np.concatenate([quads + np.array([0, 1, 2]), quads + np.array([0, 2, 3])])
    return Mesh(vertices, normals, triangles)


def add(scene: shlight.Scene, mesh: Mesh, bsdf: shlight.Bsdf) -> None:
    scene.add_mesh(mesh.vertices, mesh.triangles, normals=mesh.normals, bsdf=bsdf)


def add_quad(scene: shlight.Scene, corners: list[Point], bsdf: shlight.Bsdf) -> None:
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], bsdf=bsdf)


def _lit_room(shell: Callable[[Colour], shlight.Bsdf], thing: Callable[[Colour], shlight.Bsdf]) -> shlight.Scene:
    """shell, thing: the materials of walls and of what stands in the room, of a colour in matt paint."""
    scene = shlight.Scene()
    add_quad(scene, [(-2.6, -3, 0), (2.6, -3, 0), (2.6, 2, 0), (-2.6, 2, 0)], shell((0.62, 0.58, 0.53)))
    add_quad(scene, [(-2.6, 2, 0), (2.6, 2, 0), (2.6, 2, 3.2), (-2.6, 2, 3.2)], shell((0.66, 0.66, 0.64)))
    add_quad(scene, [(-2.6, -3, 0), (-2.6, 2, 0), (-2.6, 2, 3.2), (-2.6, -3, 3.2)], shell((0.62, 0.25, 0.18)))
    add_quad(scene, [(2.6, 2, 0), (2.6, -3, 0), (2.6, -3, 3.2), (2.6, 2, 3.2)], shell((0.18, 0.36, 0.52)))
    add(scene, box((-1.25, 0.75, 0.3), (0.9, 0.9, 0.6), 0.3), shell((0.7, 0.68, 0.6)))
    add(scene, vase((-1.25, 0.75, 0.6), 1.15), thing((0.20, 0.47, 0.43)))
    add(scene, knot((0.15, 0.35, 0.83), 0.8, 0.16), thing((0.75, 0.58, 0.22)))
    add(scene, ball((1.45, 0.5, 0.45), 0.45), thing((0.70, 0.30, 0.22)))
    add(scene, ball((0.95, -0.75, 0.22), 0.22), thing((0.75, 0.75, 0.75)))
    add(scene, box((-0.75, -0.75, 0.16), (0.32, 0.32, 0.32), 0.9), thing((0.30, 0.35, 0.62)))
    scene.add_sphere_light((-1.75, -0.9, 2.35), 0.32, (26.0, 20.0, 14.0))
    scene.add_sphere_light((1.95, -0.5, 1.9), 0.18, (24.0, 29.0, 36.0))
    # Counter-clockwise as the room sees it: a polygon shines to one side.
    scene.add_polygon_light([(-0.2, -0.2, 3.1), (-0.2, 0.9, 3.1), (1.3, 0.9, 3.1), (1.3, -0.2, 3.1)], (8.0, 7.7, 7.2))
    scene.set_camera(shlight.look_at((0.05, -4.6, 1.75), (0.05, 0.6, 0.95)), math.radians(46))
    return scene


def matt_room() -> shlight.Scene:
    return _lit_room(shlight.Bsdf.lambert, shlight.Bsdf.lambert)


def gold_room() -> shlight.Scene:
    """The same things in gold, between walls of other metals as rough."""
    gold = shlight.Bsdf.ggx(GOLD_ROUGHNESS, GOLD)

    def shell(colour: Colour) -> shlight.Bsdf:
        return shlight.Bsdf.ggx(GOLD_ROUGHNESS, colour)

    return _lit_room(shell, lambda _: gold)
