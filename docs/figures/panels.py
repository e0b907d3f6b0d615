# SPDX-License-Identifier: MIT
"""Takes the pictures of docs/panels.md: the add-on's panels in a window of Blender, each tab with its panels open.

xvfb-run -a -s '-screen 0 640x2400x24 +extension GLX' env LIBGL_ALWAYS_SOFTWARE=1 blender --factory-startup -noaudio \\
    --window-geometry 0 0 640 2400 --python-expr "import sys; sys.path[:0] = ['python_bindings', 'blender_addon']" \\
    --python docs/figures/panels.py

It needs Debian's Blender, xvfb and ImageMagick.
"""

import os
import subprocess
import traceback
from pathlib import Path

import bpy

import shlight_blender
from shlight_blender.ui import panels

FOLDER = Path(__file__).resolve().parents[1] / "images" / "panels"
TABS = ("RENDER", "VIEW_LAYER", "WORLD", "OBJECT", "DATA", "MATERIAL")


def take(name):
    """The picture of the window, without what is empty below."""
    file = str(FOLDER / f"{name.lower()}.png")
    subprocess.run(["import", "-window", "root", file], check=True)
    trim = ["-fuzz", "3%", "-trim", "+repage", "+dither", "-colors", "32"]
    subprocess.run(["mogrify", *trim, "-define", "png:compression-level=9", file], check=True)


def steps():
    """Shows a tab after the other, with redraws between."""
    window = bpy.context.window_manager.windows[0]
    scene, area = window.scene, next(area for area in window.screen.areas if area.type == "PROPERTIES")
    scene.render.engine = "SHLIGHT"
    scene.shlight.use_light_mixer = True
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.scene.view_layer_add_lightgroup(name="desk")
        bpy.data.objects["Light"].lightgroup = "desk"
        bpy.ops.render.render()
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    yield
    properties = next(area.spaces[0] for area in window.screen.areas if area.type == "PROPERTIES")
    for tab in TABS:
        object_name = "Cube" if tab == "MATERIAL" else "Light"
        bpy.context.view_layer.objects.active = bpy.data.objects[object_name]
        yield
        properties.context = tab
        yield
        yield
        take(tab)


def step():
    """One of the steps; Blender ends after the last."""
    try:
        next(plan)
    except StopIteration:
        os._exit(0)
    except Exception:
        traceback.print_exc()
        os._exit(1)
    return 0.3


bpy.context.preferences.view.show_splash = False
for each in panels.CLASSES:
    if issubclass(each, bpy.types.Panel):
        each.bl_options = set()  # open
shlight_blender.register()
plan = steps()
FOLDER.mkdir(exist_ok=True)
bpy.app.timers.register(step, first_interval=0.5, persistent=True)
