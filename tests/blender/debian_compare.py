# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: compares with Cycles, drags the split, ends comparisons."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np

import shlight_blender
from shlight_blender.compare import overlay, panel, results
from shlight_blender.compare.job import session

sys.path.append(str(Path(__file__).parent))
from debian_steps import FOLDER, start

found = {"ends": {}}


def window():
    return bpy.context.window_manager.windows[0]


def area_of(kind):
    return next((area for area in window().screen.areas if area.type == kind), None)


def here(area=None):
    region = next((each for each in area.regions if each.type == "WINDOW"), None) if area else None
    return bpy.context.temp_override(window=window(), area=area, region=region)


def press(key, value="PRESS", x=600, y=400):
    window().event_simulate(type=key, value=value, x=int(x), y=int(y))


def screenshot(name):
    """Pixels of the screen (height, width, 3), bytes, row 0 at the bottom."""
    path = FOLDER / f"{name}.png"
    subprocess.run(["import", "-window", "root", str(path)], check=True)
    image = bpy.data.images.load(str(path))
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    width, height = image.size
    bpy.data.images.remove(image)
    return np.round(255 * values.reshape(height, width, -1)[..., :3]).astype(int)


def files():
    return {path.name for path in Path(bpy.app.tempdir).iterdir()}


def build(scene):
    """Blender's own scene with a cube that shlight draws otherwise."""
    scene.render.engine, scene.shlight.max_bounces = "SHLIGHT", 0
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    bpy.ops.mesh.primitive_plane_add(size=12, location=(0, 0, -1))
    material = bpy.data.objects["Cube"].active_material
    tree = material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeBsdfHair").outputs[0], tree.nodes["Material Output"].inputs[0])
    bpy.ops.ed.undo_push(message="built")
    bpy.data.objects["Cube"].rotation_euler.z = 0.2
    bpy.ops.ed.undo_push(message="turned")


def begin(**options):
    with here(area_of("PROPERTIES")):
        assert bpy.ops.shlight.compare("INVOKE_DEFAULT", **options) == {"RUNNING_MODAL"}


def steps():
    """The test's steps, with redraws between."""
    bpy.context.preferences.view.render_display_type = "AREA"
    with here(area_of("VIEW_3D")):
        build(window().scene)
    area_of("PROPERTIES").spaces[0].context = "RENDER"
    yield
    yield from compare()
    yield from drag()
    yield from look_at_difference()
    yield from undo_and_redo()
    for way in (press_escape, press_cancel, undo, close_file, disable):
        yield from end_by(way)


def compare():
    """One that ends well; the panel and the status bar meanwhile."""
    found["was_dirty"] = bpy.data.is_dirty
    begin(reference_seconds=1.0)
    try:
        begin()
    except RuntimeError as error:
        found["twice"] = str(error)
    found["stages"] = []
    while session.job is not None:
        if session.job.worker.stage.name not in found["stages"]:
            found["stages"].append(session.job.worker.stage.name)
        yield
    for _ in range(3):
        yield
    found["is_dirty"] = bpy.data.is_dirty
    found["unsaved_images"] = [image.name for image in bpy.data.images if image.is_dirty]
    found["shown"] = area_of("IMAGE_EDITOR").spaces[0].image.name
    found["places"] = [(place["place"], place["messages"]) for place in results.last.figures["differences"]]
    screenshot("panel")


def to_screen(x, y):
    editor = area_of("IMAGE_EDITOR")
    region = next(each for each in editor.regions if each.type == "WINDOW")
    x, y = region.view2d.view_to_region(x, y, clip=False)
    return region.x + x, region.y + y


def drag():
    """The mouse takes the split from the middle to a quarter."""
    with here(area_of("IMAGE_EDITOR")):
        bpy.ops.image.view_all(fit_view=True)
    yield
    start_x, y = to_screen(0.5, 0.3)
    end_x, _ = to_screen(0.25, 0.3)
    press("MOUSEMOVE", "NOTHING", start_x, y)
    yield
    press("LEFTMOUSE", "PRESS", start_x, y)
    for share in np.linspace(0, 1, 5):
        press("MOUSEMOVE", "NOTHING", start_x + share * (end_x - start_x), y)
        yield
    screenshot("split")
    press("LEFTMOUSE", "RELEASE", end_x, y)
    yield
    press("MOUSEMOVE", "NOTHING", start_x, y)
    yield
    found["split"] = bpy.context.window_manager.shlight_compare.split
    for _ in range(10):
        yield
    found["unsaved_after_drag"] = [image.name for image in bpy.data.images if image.is_dirty]


def look_at_difference():
    """Checks a corner of the screen, and the position of the drawn marker."""
    with here(area_of("IMAGE_EDITOR")):
        bpy.ops.shlight.show_comparison(image=results.DIFFERENCE)
    yield
    yield
    shot = screenshot("difference")
    x, y = (int(value) for value in to_screen(0.02, 0.97))
    found["corner_on_screen"] = shot[y, x].tolist()
    pixels = np.array(bpy.data.images[results.DIFFERENCE].pixels[:]).reshape(64, 96, -1)
    found["corner"] = np.round(255 * pixels[int(0.97 * 64), int(0.02 * 96), :3]).astype(int).tolist()
    place = results.last.figures["differences"][0]
    x, y = to_screen(place["x"] / 96, place["y"] / 64)
    radius = overlay.RADIUS * bpy.context.preferences.system.ui_scale
    found["marker"] = shot[int(y + radius) - 2 : int(y + radius) + 3, int(x)].max(axis=1).max().item()


def undo_and_redo():
    """Images that are younger than what is undone."""
    names = [image.name for image in bpy.data.images]
    for move in (bpy.ops.ed.undo, bpy.ops.ed.redo):
        with here(area_of("IMAGE_EDITOR")):
            move()
        yield
    found["kept"] = names == [image.name for image in bpy.data.images]
    found["shown_after_undo"] = getattr(area_of("IMAGE_EDITOR").spaces[0].image, "name", None)


def end_by(way):
    before = files()
    begin()
    process = session.job.worker._process.pid
    for _ in range(5):
        yield
    running = session.job is not None and Path(f"/proc/{process}").exists()
    with here():
        way()
    yield
    yield
    found["ends"][way.__name__] = {
        "running": running,
        "job": session.job is not None,
        "process": Path(f"/proc/{process}").exists(),
        "files": sorted(files() - before),
    }


def press_escape():
    press("ESC")
    press("ESC", "RELEASE")


def press_cancel():
    bpy.ops.shlight.cancel_comparison()


def undo():
    bpy.ops.ed.undo()


def close_file():
    bpy.ops.wm.read_homefile()
    window().scene.render.engine = "SHLIGHT"
    found["after_file"] = [overlay._handler is not None, results.last is not None]


def disable():
    shlight_blender.unregister()
    found["operator_left"] = hasattr(bpy.types, "SHLIGHT_OT_compare")


panel.comparison.bl_options = set()
start(steps(), found)
