# SPDX-License-Identifier: MIT
"""A ball on a floor under a window and a lamp: shlight from Python alone, without Blender.

usage: python examples/render_from_python.py [picture.png]
"""

from __future__ import annotations

import sys

import numpy as np
import numpy.typing as npt

import shlight

Array = npt.NDArray[np.float64]


def ball(center: tuple[float, float, float], radius: float, rings: int = 64) -> tuple[Array, npt.NDArray[np.int64]]:
    """Vertices and triangles of a sphere, its poles on the z axis."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False))
    vertices = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    index = np.arange(theta.size).reshape(theta.shape)
    a, b = index[:, :-1], index[:, 1:]
    d, c = np.roll(a, -1, axis=0), np.roll(b, -1, axis=0)
    lower = np.stack([a, b, c], axis=-1)[:, :-1]  # at the poles one triangle of each quad has no area
    upper = np.stack([a, c, d], axis=-1)[:, 1:]
    triangles = np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])
    return np.asarray(center) + radius * vertices.reshape(-1, 3), triangles


def build() -> shlight.Scene:
    """The scene, in metres."""
    scene = shlight.Scene()
    floor = [[-4, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]]
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], bsdf=shlight.Bsdf.lambert(0.6))
    vertices, triangles = ball((0.0, 0.0, 0.8), 0.8)
    normals = (vertices - (0.0, 0.0, 0.8)) / 0.8
    coat, base = shlight.Bsdf.ggx(0.5, 0.04, ior=1.5), shlight.Bsdf.lambert((0.7, 0.12, 0.05))
    scene.add_mesh(vertices, triangles, normals=normals, bsdf=shlight.Bsdf.layer(coat, base))
    scene.add_sphere_light((1.8, -1.2, 2.2), 0.3, (6.0, 7.0, 9.0))
    # Counter-clockwise as the ball sees it: a polygon shines to one side.
    window = np.array([[-2.5, -1.0, 1.2], [-2.5, -1.0, 2.6], [-1.7, -2.4, 2.6], [-1.7, -2.4, 1.2]])
    scene.add_polygon_light(window, (5.0, 4.5, 4.0))
    scene.set_camera(shlight.look_at((0.0, -5.0, 1.8), (0.0, 0.0, 0.74)), np.deg2rad(40.0))
    return scene


def main() -> None:
    """Renders the scene into a file."""
    result = shlight.render(build(), 480, 320)
    result.save(sys.argv[1] if len(sys.argv) > 1 else "ball.png")
    report = result.report
    print(f"{report.render_seconds:.2f} s, {report.hits} camera hits, {report.shadow_rays} shadow rays")


if __name__ == "__main__":
    main()
