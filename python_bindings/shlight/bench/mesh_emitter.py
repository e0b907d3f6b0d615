# SPDX-License-Identifier: MIT
"""How a render's time grows with the number of faces of a mesh that shines."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

import shlight
from shlight.charts.scenes import look_at

from .rounds import Work
from .row import Row
from .run import Run

FEW, MANY = 1, 7  # subdivisions of an icosahedron
BOUND = 3.0
SIZE, QUICK_SIZE = (64, 48), (32, 24)
EYE, TARGET = (0.0, -6.0, 3.0), (0.0, 0.0, 0.5)
CENTER, RADIUS, RADIANCE = (0.9, -0.6, 2.4), 0.4, (10.0, 10.0, 10.0)  # of the lamp

Solid = tuple[NDArray[np.float64], NDArray[np.int64]]


def measure(run: Run) -> list[Row]:
    size = QUICK_SIZE if run.quick else SIZE
    solids = [icosphere(FEW), icosphere(MANY)]
    bsdfs = {"matt": shlight.Bsdf.lambert(0.8), "glossy": shlight.Bsdf.ggx(0.5, 0.9)}
    rows = []
    for part, (kind, bsdf) in enumerate(bsdfs.items()):
        works = {
            f"{len(solid[1])} faces over {kind} things": Work(
                partial(shlight.render, scene_of(solid, bsdf), *size, threads=1), 1
            )
            for solid in solids
        }
        seconds = run.alternate(works, (part, len(bsdfs)))
        few, many = works
        rows.append(run.ratio(seconds, many, few, unit="×", bound=BOUND))
    return rows


def scene_of(lamp: Solid, bsdf: shlight.Bsdf) -> shlight.Scene:
    """A ball on a floor, under a mesh."""
    scene = ball_on_floor(bsdf)
    vertices, faces = lamp
    scene.add_mesh(RADIUS * vertices + CENTER, faces, emission=RADIANCE)
    return scene


def ball_on_floor(bsdf: shlight.Bsdf) -> shlight.Scene:
    """With a camera, and without a lamp."""
    scene = shlight.Scene()
    floor = 4 * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    scene.add_mesh(floor, np.array([[0, 1, 2], [0, 2, 3]]), bsdf=bsdf)
    normals, faces = icosphere(4)
    scene.add_mesh(0.8 * normals + (0, 0, 0.8), faces, bsdf=bsdf, normals=normals)
    scene.set_camera(look_at(EYE, TARGET), 0.7)
    return scene


def icosphere(subdivisions: int) -> Solid:
    """Of radius 1: each face of an icosahedron in 4^subdivisions; vertices and triangles."""
    golden = (1 + np.sqrt(5)) / 2
    near = [(0.0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll(v, k) for k in range(3) for v in near]) / np.hypot(1, golden)
    edge = 2 / np.hypot(1, golden)
    close = np.linalg.norm(vertices[:, None] - vertices, axis=-1) < 1.01 * edge
    triples = np.array([(i, j, k) for i in range(12) for j in range(i) for k in range(j)])
    i, j, k = triples.T
    faces = triples[close[i, j] & close[j, k] & close[k, i]]
    corners = vertices[faces]
    inward = np.einsum("fi,fi->f", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) < 0
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
