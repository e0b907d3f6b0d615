# SPDX-License-Identifier: MIT
"""An office of 6 × 4 × 2.8 m, the scene of several pages: two desks with screens, a cabinet, eight panels of light."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import shlight

Array = npt.NDArray[np.float64]

SIZE = np.array([6.0, 4.0, 2.8])
DESK_HEIGHT = 0.75
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def box(low: npt.ArrayLike, high: npt.ArrayLike) -> tuple[Array, npt.NDArray[np.int64]]:
    """Vertices (8, 3) and triangles (12, 3) of an upright box."""
    corners = np.array([low, high], dtype=float)
    vertices = np.array([[corners[i, 0], corners[j, 1], corners[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    triangles = [triangle for a, b, c, d in FACES for triangle in ((a, b, c), (a, c, d))]
    return vertices, np.array(triangles)


def furnished() -> shlight.Scene:
    """The room and what stands in it, without a lamp; a camera in a corner."""
    scene = shlight.Scene()
    scene.add_mesh(*box((0, 0, 0), SIZE), bsdf=shlight.Bsdf.lambert((0.7, 0.69, 0.66)))
    wood = shlight.Bsdf.principled((0.35, 0.2, 0.1), roughness=0.35)
    for x in (0.8, 3.6):
        scene.add_mesh(*box((x, 1.2, DESK_HEIGHT - 0.03), (x + 1.6, 2.0, DESK_HEIGHT)), bsdf=wood)
        for left in (x + 0.02, x + 1.54):
            scene.add_mesh(*box((left, 1.25, 0), (left + 0.04, 1.95, DESK_HEIGHT - 0.03)), bsdf=wood)
        scene.add_mesh(*box((x, 2.0, 0.3), (x + 1.6, 2.03, 1.3)), bsdf=shlight.Bsdf.lambert((0.25, 0.4, 0.3)))
    scene.add_mesh(*box((2.6, 3.5, 0), (3.4, 4, 1.9)), bsdf=shlight.Bsdf.lambert((0.15, 0.25, 0.3)))
    scene.set_camera(shlight.look_at((5.7, 0.3, 1.7), (2.3, 2.3, 0.8)), np.deg2rad(75))
    return scene


def add_panels(scene: shlight.Scene, radiance: npt.ArrayLike = 7.0, camera: bool = True) -> list[shlight.Light]:
    """Eight panels of 60 × 30 cm under the ceiling, which shine down with a radiance [W/m²/sr].

    camera: whether it sees them.
    """
    panels = []
    for x in (0.9, 2.3, 3.7, 5.1):
        for y in (1.1, 2.9):
            corners = [[-0.3, -0.15], [-0.3, 0.15], [0.3, 0.15], [0.3, -0.15]]
            vertices = [[x + u, y + v, SIZE[2] - 0.01] for u, v in corners]
            group = "window side" if y < 2 else "door side"
            panels.append(scene.add_polygon_light(vertices, radiance, group=group, camera=camera))
    return panels
