# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: selects shlight, shows its panels and the viewport, renders, and quits."""

import json
import sys
from pathlib import Path

import bpy

import shlight_blender
from shlight_blender import engine, panels

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
drawn = {"panels": [], "viewport_updates": 0}


def watched(original, name):
    def draw(self, context):
        original(self, context)
        if name not in drawn["panels"]:
            drawn["panels"].append(name)

    return draw


def watch():
    """Notes which of the engine's panels are drawn and how often the viewport asks for an update."""
    for panel in panels.CLASSES:
        panel.draw = watched(panel.draw, panel.__name__)
    update = engine.ShlightRenderEngine.view_update

    def view_update(self, context, depsgraph):
        update(self, context, depsgraph)
        drawn["viewport_updates"] += 1

    engine.ShlightRenderEngine.view_update = view_update


def area_of(kind):
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == kind)


def steps():
    """What happens one after the other, with redraws between."""
    scene = bpy.context.window_manager.windows[0].scene
    scene.render.engine = "SHLIGHT"
    properties = area_of("PROPERTIES").spaces[0]
    for context in ("RENDER", "OUTPUT", "VIEW_LAYER", "WORLD", "MATERIAL"):
        properties.context = context
        yield
    bpy.context.view_layer.objects.active = bpy.data.objects["Light"]
    yield
    properties.context = "DATA"
    yield
    viewport = area_of("VIEW_3D").spaces[0]
    for shading in ("RENDERED", "MATERIAL", "RENDERED", "SOLID"):
        viewport.shading.type = shading
        bpy.data.objects["Cube"].location.x += 0.1
        yield
        yield
    render = scene.render
    render.resolution_x, render.resolution_y = 64, 48
    render.image_settings.file_format = "OPEN_EXR"
    render.filepath = str(FOLDER / "final.exr")
    bpy.ops.render.render(write_still=True)
    yield


def run(plan):
    try:
        next(plan)
    except StopIteration:
        (FOLDER / "drawn.json").write_text(json.dumps(drawn))
        bpy.ops.wm.quit_blender()
        return None
    return 0.1


bpy.context.preferences.view.show_splash = False
watch()
shlight_blender.register()
plan = steps()
bpy.app.timers.register(lambda: run(plan), first_interval=0.5)
