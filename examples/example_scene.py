# SPDX-License-Identifier: MIT
"""A small scene built by code: matt and glossy things, an area lamp, a sphere lamp and a glowing strip.

`./dev preview` renders it when it is given no other.

usage: blender --python examples/example_scene.py     to look at it
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parent))  # Blender does not look beside its script

import scene_parts as parts


def build_scene() -> Any:
    """Makes the scene in Blender's current file, gives it the window, and returns it."""
    scene = parts.new_scene("shlight example", 640, 400)

    grey = parts.surface("matt grey", (0.55, 0.55, 0.55), 0.6, specular=0.0)
    parts.add_mesh(scene, "floor", parts.grid, grey, scale=(7, 7, 1))
    parts.add_mesh(scene, "wall", parts.grid, grey, (0, 3.2, 3), scale=(7, 3, 1), rotation=(math.pi / 2, 0, 0))
    orange = parts.surface("orange plastic", (0.80, 0.24, 0.04), 0.5)
    turned = (math.radians(-12), 0, math.radians(14))
    head = parts.add_mesh(
        scene, "Suzanne", parts.monkey, orange, (0.0, 0.1, 1.0), scale=(1.1, 1.1, 1.1), rotation=turned, smooth=True
    )
    head.modifiers.new("smooth", "SUBSURF").render_levels = 2
    gold = parts.surface("rough gold", (0.92, 0.62, 0.25), 0.5, metallic=1.0)
    parts.add_mesh(scene, "gold sphere", parts.sphere, gold, (-2.1, 0.3, 0.75), scale=(0.75,) * 3, smooth=True)
    blue = parts.surface("blue plastic", (0.03, 0.12, 0.42), 0.55)
    parts.add_mesh(scene, "blue box", parts.cube, blue, (2.1, 0.7, 0.7), scale=(0.6, 0.6, 0.7), rotation=(0, 0, 0.5))
    green = parts.surface("matt green", (0.12, 0.40, 0.14), 0.8, specular=0.0)
    parts.add_mesh(scene, "green ball", parts.sphere, green, (1.3, -1.2, 0.4), scale=(0.4,) * 3, smooth=True)

    parts.add_area_lamp(scene, "window", 190.0, (-3.2, -2.2, 4.2), (0, 0, 0.8), (1.6, 1.1), (1.0, 0.96, 0.90))
    parts.add_sphere_lamp(scene, "bulb", 60.0, (3.0, -1.6, 2.6), 0.35, (0.75, 0.85, 1.0))
    glow = parts.emission("glow", (1.0, 0.45, 0.25), 9.0)
    parts.add_mesh(
        scene, "glowing strip", parts.grid, glow, (0.9, 2.6, 0.16), scale=(1.0, 0.12, 1.0), rotation=(1.2, 0, 0)
    )
    parts.add_camera(scene, (0.3, -7.4, 2.9), (0.05, 0.2, 0.95), lens=45.0)
    return scene


if __name__ == "__main__":
    build_scene()
