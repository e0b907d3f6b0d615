# SPDX-License-Identifier: MIT
"""A bent metal strip whose roughness grows from 0 at the left to 1 at the right in small steps.

Camera and lamps are so far away that every step sees them alike: a jump from one step to the next that its neighbours
do not make is a seam between two ways of computing the same reflection. The strip turns from the camera to grazing
angles at its upper and lower edge.

usage: ./dev preview roughness_ramp                  to render it and compare with Cycles
       blender --python examples/roughness_ramp.py   to look at it
"""

from __future__ import annotations

import math
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parent))  # Blender does not look beside its script

import scene_parts as parts

# Steps of 0.0025 up to 0.05, then of 2.8 % up to 1: a reflection's brightness goes with the fourth power.
ROUGHNESSES = (*(i / 400 for i in range(20)), *(20.0 ** (i / 108 - 1.0) for i in range(109)))
WIDTH = 0.05
SEGMENTS = 96


def build_scene() -> Any:
    """Makes the scene in Blender's current file, gives it the window, and returns it."""
    count = len(ROUGHNESSES)
    scene = parts.new_scene("roughness ramp", 6 * count, 252)
    for number, roughness in enumerate(ROUGHNESSES):
        metal = parts.metal(f"metal {roughness:.4f}", (0.9, 0.9, 0.9), roughness)
        x = (number - 0.5 * (count - 1)) * WIDTH
        parts.add_mesh(scene, f"step {roughness:.4f}", _bent_strip, metal, (x, 0, 0), smooth=True)
    # Radiances of about 4, 4 and 1: the sphere above, a bright window below, and one behind the upper edge.
    parts.add_sphere_lamp(scene, "sphere", 6300.0, (0, -32, 26), 6.0, (1.0, 0.86, 0.70))
    parts.add_area_lamp(scene, "quad", 3000.0, (0, -36, -14), (0, 0, 0), (60.0, 5.0), (0.72, 0.86, 1.0))
    parts.add_area_lamp(scene, "edge", 3000.0, (0, 34, 18), (0, 0, 0), (60.0, 12.0), (0.8, 1.0, 0.8))
    parts.add_camera(scene, (0, -60, 0), (0, 0, 0), type="ORTHO", ortho_scale=count * WIDTH, clip_end=1000.0)
    return scene


def _bent_strip(form: Any) -> None:
    """The half of a cylinder of radius 1 about the x axis that faces -Y, `WIDTH` wide."""
    rows = []
    for i in range(SEGMENTS + 1):
        angle = math.pi * (i / SEGMENTS - 0.5)
        y, z = -math.cos(angle), math.sin(angle)
        rows.append([form.verts.new((x, y, z)) for x in (-0.5 * WIDTH, 0.5 * WIDTH)])
    for (a, b), (d, c) in pairwise(rows):
        form.faces.new((a, b, c, d))


if __name__ == "__main__":
    build_scene()
