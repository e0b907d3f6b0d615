# SPDX-License-Identifier: MIT
"""A polished floor seen to the horizon: at grazing angles the reflections of two lamps stretch towards the camera.

usage: ./dev preview glossy_floor                    to render it and compare with Cycles
       ./dev preview glossy_floor --light quad       under one of its lamps: sphere or quad
       blender --python examples/glossy_floor.py     to look at it
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parent))  # Blender does not look beside its script

import scene_parts as parts


def build_scene() -> Any:
    """Makes the scene in Blender's current file, gives it the window, and returns it."""
    scene = parts.new_scene("glossy floor", 720, 360)
    polished = parts.metal("polished metal", (0.9, 0.9, 0.9), 0.2)
    parts.add_mesh(scene, "floor", parts.grid, polished, scale=(400, 400, 1))
    clay = parts.matt("clay", (0.5, 0.4, 0.3))
    parts.add_mesh(scene, "pillar", parts.cube, clay, (-1.5, 9.0, 1.0), scale=(0.1, 0.1, 1.0))
    parts.add_mesh(scene, "ball", parts.sphere, clay, (2.3, 6.0, 0.4), scale=(0.4,) * 3, smooth=True)
    parts.add_sphere_lamp(scene, "sphere", 900.0, (-4.5, 30.0, 2.6), 1.0, (1.0, 0.80, 0.55))
    parts.add_area_lamp(scene, "quad", 500.0, (4.5, 30.0, 2.4), (4.5, 0.0, 2.4), (4.0, 2.0), (0.6, 0.8, 1.0))
    parts.add_camera(scene, (0, -7.0, 1.0), (0, 10.0, -0.6), lens=40.0, clip_end=2000.0)
    return scene


if __name__ == "__main__":
    build_scene()
