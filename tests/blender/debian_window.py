# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: selects shlight, shows panels and viewport, renders twice, and quits."""

import sys
from pathlib import Path

import bpy
import nodeitems_utils

from shlight_blender import engine, record
from shlight_blender.ui import panels

sys.path.append(str(Path(__file__).parent))
from debian_steps import FOLDER, area_of, start

ended = []
REPORT = "SHLIGHT_RENDER_PT_report"
drawn = {"panels": {}, "redrawn": [], "nodes": {}, "viewport_updates": 0, "messages": [], "previews": []}


def watched(original, name):
    def draw(self, context):
        original(self, context)
        drawn["panels"][name] = drawn["panels"].get(name, 0) + 1

    return draw


def watch():
    """Notes which of the engine's panels are drawn and how often the viewport asks for an update."""
    for panel in (each for each in panels.CLASSES if issubclass(each, bpy.types.Panel)):
        panel.draw = watched(panel.draw, panel.__name__)
    update = engine.ShlightRenderEngine.view_update

    def view_update(self, context, depsgraph):
        update(self, context, depsgraph)
        drawn["viewport_updates"] += 1

    engine.ShlightRenderEngine.view_update = view_update


def steps():
    """The test's steps, with redraws between."""
    scene = bpy.context.window_manager.windows[0].scene
    scene.render.engine = "SHLIGHT"
    scene.shlight.max_bounces = scene.shlight.preview_max_bounces = 0
    properties = area_of("PROPERTIES").spaces[0]
    for context in ("RENDER", "OUTPUT", "VIEW_LAYER", "WORLD", "MATERIAL"):
        properties.context = context
        yield
    bpy.context.view_layer.objects.active = bpy.data.objects["Light"]
    yield
    properties.context = "DATA"
    yield
    yield from note_nodes(scene)
    viewport = area_of("VIEW_3D").spaces[0]
    for shading in ("RENDERED", "WIREFRAME", "RENDERED", "SOLID"):
        viewport.shading.type = shading
        bpy.data.objects["Cube"].location.x += 0.1
        yield
        yield
    yield from note_previews()
    set_sky(scene)
    properties.context = "RENDER"
    yield
    for number in range(2):
        yield from final_render(scene, FOLDER / f"final_{number}.exr")
    yield from undo_during_a_render(scene)


def note_previews():
    """Notes the mean colour of the previews of materials; a measured one is green."""
    red, blue = (0.8, 0.05, 0.05, 1), (0.05, 0.05, 0.8, 1)
    for color, measured in ((red, ""), (blue, ""), (red, str(FOLDER / "green.bin"))):
        material = bpy.data.materials.new("Preview")
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        material.shlight.measured_file = measured
        material.asset_mark()
        material.asset_generate_preview()
        while bpy.app.is_job_running("RENDER_PREVIEW") or not any(material.preview.image_pixels_float):
            yield
        pixels = list(material.preview.image_pixels_float)
        drawn["previews"].append([sum(pixels[channel::4]) for channel in range(3)])


def note_nodes(scene):
    """Notes what the Shader editor's Add menu offers for each engine."""
    window = bpy.context.window_manager.windows[0]
    area = area_of("DOPESHEET_EDITOR")
    area.ui_type = "ShaderNodeTree"
    yield
    for name in ("BLENDER_WORKBENCH", "CYCLES", "SHLIGHT"):
        scene.render.engine = name
        with bpy.context.temp_override(window=window, area=area):
            items = list(nodeitems_utils.node_items_iter(bpy.context))
        drawn["nodes"][name] = [item.nodetype for item in items if hasattr(item, "nodetype")]
        yield


def set_sky(scene):
    """A world of nodes, around things that are drawn as they are."""
    bpy.data.objects["Cube"].data.materials.clear()
    tree = scene.world.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], tree.nodes["Background"].inputs["Color"])
    scene.shlight.world_width = 256


def final_render(scene, path):
    """Renders like F12, while the window goes on."""
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    bpy.context.preferences.view.render_display_type = "NONE"  # a window that opens has all others drawn anew
    ended.clear()
    bpy.ops.render.render("INVOKE_DEFAULT")
    # The job is not yet running while it waits for another one, such as the material's preview, to stop.
    while not ended or bpy.app.is_job_running("RENDER"):
        yield
    yield
    yield
    drawn["redrawn"].append(drawn["panels"].get(REPORT, 0) > ended[0])
    drawn["messages"].append(record.last.messages)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)


def undo_during_a_render(scene):
    """Notes what the report says of a render that an undo ends."""
    bpy.ops.ed.undo_push(message="one step")
    bpy.ops.ed.undo_push(message="another")
    scene.shlight.noise_threshold = 0.0
    scene.render.resolution_x = 1920
    before = record.last
    bpy.ops.render.render("INVOKE_DEFAULT")
    while record.last is before or not record.last.settings:
        yield
    bpy.ops.ed.undo()
    drawn["undone"] = record.last.report.lines()


watch()
for handlers in (bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel):
    handlers.append(lambda *_: ended.append(drawn["panels"].get(REPORT, 0)))
start(steps(), drawn)
