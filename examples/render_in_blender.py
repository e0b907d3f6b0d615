# SPDX-License-Identifier: MIT
"""Blender's render call with the engine shlight, on a scene built by code.

usage: python examples/render_in_blender.py [picture.png [percent]]                  with the module bpy
       blender -b --python examples/render_in_blender.py -- [picture.png [percent]]  with Blender itself
"""

import sys
from pathlib import Path

import bpy

# In the source tree the add-on need not be installed, and Blender does not look beside its script.
sys.path.append(str(Path(__file__).resolve().parents[1] / "blender_addon"))
sys.path.append(str(Path(__file__).resolve().parent))

from example_scene import build_scene

import shlight_blender

arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]

shlight_blender.register()
scene = build_scene()
scene.render.engine = "SHLIGHT"
scene.shlight.shadow_rays = 32
scene.render.resolution_percentage = int(arguments[1]) if len(arguments) > 1 else 50
scene.render.filepath = str(Path(arguments[0] if arguments else "example.png").resolve())
bpy.ops.render.render(write_still=True, scene=scene.name)
