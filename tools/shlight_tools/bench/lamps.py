# SPDX-License-Identifier: MIT
"""Scenes whose lamps are many, or whose lamp is a mesh of many faces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import shlight
from shlight_tools.charts.scenes import add_quad

SEED = 1
HALF, STRENGTH = 4.0, 30.0  # of the floor; of all lights together
OBSTACLES, EDGE = 6, 0.3
CENTER, RADIUS, RADIANCE = (0.9, -0.6, 2.4), 0.4, (10.0, 10.0, 10.0)  # of the lamp that is a mesh

Solid = tuple[NDArray[np.float64], NDArray[np.int64]]


def floored(bsdf: shlight.Bsdf) -> shlight.Scene:
    scene = shlight.Scene()
    add_quad(scene, [(-HALF, -HALF, 0), (HALF, -HALF, 0), (HALF, HALF, 0), (-HALF, HALF, 0)], bsdf)
    return scene


def many_lights(count: int, radius: float, angle: float) -> shlight.Scene:
    """Tetrahedra on a floor under `count` lights; radius 0: sources without extent. angle: of the view."""
    rng = np.random.default_rng(SEED)
    scene = floored(shlight.Bsdf.lambert(0.8))
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
    scene.set_camera(shlight.look_at((0.0, -6.0, 4.0), (0.0, 0.0, 0.2)), angle)
    return scene


def under_mesh(lamp: Solid, bsdf: shlight.Bsdf) -> shlight.Scene:
    """A ball on a floor, under a mesh that shines."""
    scene = ball_on_floor(bsdf)
    vertices, faces = lamp
    scene.add_mesh(RADIUS * vertices + CENTER, faces, emission=RADIANCE)
    return scene


def ball_on_floor(bsdf: shlight.Bsdf) -> shlight.Scene:
    """A scene with a camera and without lamps."""
    scene = floored(bsdf)
    normals, faces = icosphere(4)
    scene.add_mesh(0.8 * normals + (0, 0, 0.8), faces, bsdf=bsdf, normals=normals)
    scene.set_camera(shlight.look_at((0.0, -6.0, 3.0), (0.0, 0.0, 0.5)), 0.7)
    return scene


def icosphere(subdivisions: int) -> Solid:
    """A unit sphere: vertices and triangles of an icosahedron with each face cut into 4^subdivisions."""
    golden = (1 + np.sqrt(5)) / 2
    near = [(0.0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll(v, k) for k in range(3) for v in near]) / np.hypot(1, golden)
    edge = 2 / np.hypot(1, golden)
    close = np.linalg.norm(vertices[:, None] - vertices, axis=-1) < 1.01 * edge
    triples = np.array([(i, j, k) for i in range(12) for j in range(i) for k in range(j)])
    i, j, k = triples.T
    faces = triples[close[i, j] & close[j, k] & close[k, i]]
    inward = np.linalg.det(vertices[faces]) < 0
    faces[inward] = faces[inward, ::-1]
    for _ in range(subdivisions):
        vertices, faces = _quartered(vertices, faces)
    return vertices, faces


def _quartered(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Solid:
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
    edges, index = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[edges].sum(axis=1)
    middles /= np.linalg.norm(middles, axis=-1, keepdims=True)
    a, b, c = faces.T
    ab, bc, ca = (len(vertices) + index.reshape(-1, 3)).T
    quarters = np.stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca], axis=-1)
    return np.concatenate([vertices, middles]), quarters.reshape(-1, 3)
