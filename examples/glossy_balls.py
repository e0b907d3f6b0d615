# SPDX-License-Identifier: MIT
"""Metal balls of growing roughness on a dark floor, under a sphere, a quad and a small lamp.

usage: ./dev preview glossy_balls                    to render it and compare with Cycles
       ./dev preview glossy_balls --light quad       under one of its lamps: sphere, quad or small
       blender --python examples/glossy_balls.py     to look at it
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parent))  # Blender does not look beside its script

import scene_parts as parts

ROUGHNESSES = (0.1, 0.2, 0.3, 0.5, 0.8)
RADIUS = 0.5
SPACING = 1.15


def build_scene() -> Any:
    """Makes the scene in Blender's current file, gives it the window, and returns it."""
    scene = parts.new_scene("glossy balls", 900, 300)
    floor = parts.matt("dark floor", (0.06, 0.06, 0.06))
    parts.add_mesh(scene, "floor", parts.grid, floor, scale=(8, 8, 1))
    for number, roughness in enumerate(ROUGHNESSES):
        metal = parts.metal(f"metal {roughness}", (0.90, 0.87, 0.82), roughness)
        x = (number - 0.5 * (len(ROUGHNESSES) - 1)) * SPACING
        parts.add_mesh(
            scene, f"ball {roughness}", parts.sphere, metal, (x, 0, RADIUS), scale=(RADIUS,) * 3, smooth=True
        )
    parts.add_sphere_lamp(scene, "sphere", 260.0, (-2.6, -2.4, 3.0), 0.6, (1.0, 0.86, 0.70))
    parts.add_area_lamp(scene, "quad", 260.0, (2.6, -1.6, 2.8), (0, 0, 0.5), (1.8, 1.0), (0.72, 0.86, 1.0))
    parts.add_sphere_lamp(scene, "small", 60.0, (0.4, -2.2, 4.0), 0.06)
    parts.add_camera(scene, (0, -9.0, 3.2), (0, 0, 0.42), lens=55.0)
    return scene


if __name__ == "__main__":
    build_scene()
