# SPDX-License-Identifier: MIT
"""Three balls of fabric under three sphere lights, as in Fig. 4 of Zhou & Wei 2020.

usage: python examples/fabric_ball.py [measured.bin or .binary] [picture.png]

The first ball shows the measured material, a file of UTIA's or MERL's databases, or else a satin. The second one's is
velvet, whose fibres stand upright; the third one's is silk, with threads of two colours at right angles.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from render_from_python import ball

import shlight
from shlight import Bsdf, images

Array = npt.NDArray[np.float64]
ORDER = 16


def threads(view: Array, light: Array, along: float, across: float) -> Array:
    """Ashikhmin–Shirley's distribution of normals over what keeps its BRDF finite; exponents along x and along y."""
    half = view + light
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    rest = np.maximum(1 - half[:, 2] ** 2, 1e-12)
    exponent = (along * half[:, 0] ** 2 + across * half[:, 1] ** 2) / rest
    height = np.sqrt((along + 1) * (across + 1)) / (8 * np.pi)
    steep = (view * half).sum(axis=1) * np.maximum(view[:, 2], light[:, 2])
    return np.asarray(height * half[:, 2] ** exponent / steep)


def satin(view: Array, light: Array) -> Array:
    """Blue floats of threads along x."""
    return np.array([0.01, 0.03, 0.09]) + threads(view, light, 4, 60)[:, None] * [0.1, 0.2, 0.45]


def silk(view: Array, light: Array) -> Array:
    """Gold threads along x, and violet ones along y."""
    gold = threads(view, light, 6, 120)[:, None] * [0.5, 0.3, 0.05]
    violet = threads(view, light, 120, 6)[:, None] * [0.3, 0.03, 0.35]
    return 0.01 + (gold + violet) / 2


def velvet(view: Array, light: Array) -> Array:
    """Ashikhmin, Premože & Shirley 2000: upright fibres, bright at grazing angles, over a red ground."""
    half = view + light
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    tangent2 = half[:, 2] ** 2 / np.maximum(1 - half[:, 2] ** 2, 1e-6)  # cot²
    fibres = 1 + 4 * np.exp(-tangent2 / 0.25)
    together = light[:, 2] + view[:, 2] - light[:, 2] * view[:, 2]
    rim = fibres / (np.pi * 6 * 4 * together)
    return np.array([0.05, 0.004, 0.01]) + rim[:, None] * [0.5, 0.06, 0.12]


def build(materials: list[Bsdf]) -> shlight.Scene:
    """The scene, in metres."""
    scene = shlight.Scene()
    vertices, triangles = ball((0.0, 0.0, 0.0), 1.0, rings=96)
    for i, material in enumerate(materials):
        place = np.eye(4)
        place[0, 3] = 2.3 * (i - (len(materials) - 1) / 2)
        # Without texture coordinates threads run around the mesh's own z-axis, and across.
        scene.add_mesh(vertices, triangles, normals=vertices, bsdf=material, transforms=[place])
    scene.add_sphere_light((4.5, -4.0, 4.5), 1.0, (22.0, 20.0, 17.0))
    scene.add_sphere_light((-6.0, -3.0, 1.0), 1.2, (7.0, 9.0, 12.0))
    scene.add_sphere_light((0.0, 2.5, 4.5), 0.6, (30.0, 30.0, 30.0))
    to_world = np.array([[1.0, 0, 0, 0], [0, 0, -1, -9], [0, 1, 0, 0], [0, 0, 0, 1]])
    scene.set_camera(to_world, np.deg2rad(44.0))
    return scene


def main() -> None:
    """Renders the scene into a file."""
    measured = [name for name in sys.argv[1:] if Path(name).suffix in (".bin", ".binary")]
    pictures = [name for name in sys.argv[1:] if name not in measured]
    first = Bsdf.read(measured[0]) if measured else Bsdf.from_function(satin, isotropic=False)
    materials = [first, Bsdf.from_function(velvet), Bsdf.from_function(silk, isotropic=False)]
    image, report = shlight.render(build(materials), 720, 260, order=ORDER, max_bounces=0, return_report=True)
    images.write_png(pictures[0] if pictures else "fabric_ball.png", images.linear_to_srgb8(image))
    print(f"{report.render_seconds:.2f} s, {report.hits} camera hits, {report.shadow_rays} shadow rays")


if __name__ == "__main__":
    main()
