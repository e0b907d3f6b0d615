# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: an impatient person, who renders and does other things meanwhile.

Arguments: a folder, a seed and how many steps to take. Prints the steps, so that a walk that fails is known.
"""

import random
import sys
import traceback
from pathlib import Path

import addon_utils
import bpy

FOLDER, SEED, STEPS = sys.argv[sys.argv.index("--") + 1 :]
FILE = str(Path(FOLDER) / "walk.blend")
ADDON = "shlight_blender"
chance = random.Random(int(SEED))


def window():
    return bpy.context.window_manager.windows[0]


def press(key):
    for value in ("PRESS", "RELEASE"):
        window().event_simulate(type=key, value=value, x=600, y=400)


def ready():
    """Whether shlight can be the engine; then it is, though the file be new. Other engines would take long here."""
    if not addon_utils.check(ADDON)[1]:
        return False
    scene = window().scene
    scene.render.engine = "SHLIGHT"
    scene.render.resolution_x, scene.render.resolution_y = 128, 96
    scene.render.filepath = str(Path(FOLDER) / "frame_")
    scene.frame_end = 3
    scene.shlight.pixel_samples = chance.choice([1, 16, 1024])
    scene.shlight.max_bounces = scene.shlight.preview_max_bounces = 0
    scene.render.use_persistent_data = chance.random() < 0.3
    return True


def render(**what):
    if ready() and not bpy.app.is_job_running("RENDER"):
        bpy.ops.render.render("INVOKE_DEFAULT", **what)


def compare():
    if ready() and addon_utils.check("cycles")[1] and not bpy.app.is_job_running("RENDER"):
        session = sys.modules[f"{ADDON}.compare.job"].session
        if session.job is None:
            bpy.ops.shlight.compare("INVOKE_DEFAULT")


def move():
    for shown in window().scene.objects:
        shown.location.x += chance.uniform(-0.1, 0.1)
    bpy.ops.ed.undo_push(message="move")


def undo(again=False):
    operator = bpy.ops.ed.redo if again else bpy.ops.ed.undo
    if operator.poll():
        operator()


def edit():
    if bpy.ops.object.editmode_toggle.poll():
        bpy.ops.object.editmode_toggle()


def switch():
    if ready():
        window().scene.render.engine = "BLENDER_WORKBENCH"


def load():
    if Path(FILE).is_file():
        bpy.ops.wm.open_mainfile(filepath=FILE)


def shade():
    if not ready():
        return
    for area in window().screen.areas:
        if area.type == "VIEW_3D":
            area.spaces[0].shading.type = chance.choice(["RENDERED", "SOLID"])


def orbit():
    for area in window().screen.areas:
        if area.type == "VIEW_3D":
            area.spaces[0].region_3d.view_distance *= chance.choice([0.8, 1.25])


def light():
    for lamp in bpy.data.lights:
        lamp.energy *= chance.choice([0.8, 1.25])


class SHLIGHT_OT_probe(bpy.types.Operator):
    bl_idname = "shlight.probe"
    bl_label = "Probe"


def reload():
    """Raises where Blender lets no script write, which would leave its own scripts half registered."""
    bpy.utils.register_class(SHLIGHT_OT_probe)
    bpy.utils.unregister_class(SHLIGHT_OT_probe)
    bpy.ops.script.reload()


def mix():
    """Draws a slider of the light mixer, or presses one of its buttons."""
    if not ready():
        return
    settings = window().scene.shlight
    settings.use_light_mixer = chance.random() < 0.8
    for row in settings.light_mix:
        row.power, row.on = chance.choice([0.0, 0.5, 1.0, 2.0, 20.0]), chance.random() < 0.8
    if chance.random() < 0.3:
        chance.choice([bpy.ops.shlight.apply_light_mix, bpy.ops.shlight.reset_light_mix])()


def delete():
    """Lamps alone: without a camera a render ends in a popup that takes all keys."""
    if bpy.ops.object.delete.poll():
        bpy.ops.object.select_by_type(type="LIGHT")
        bpy.ops.object.delete()


STEP = {
    "F12": (6, lambda: ready() and press("F12")),
    "render": (6, render),
    "compare": (2, compare),
    "animation": (3, lambda: render(animation=True)),
    "Esc": (4, lambda: press("ESC")),
    "move": (2, move),
    "undo": (2, undo),
    "redo": (1, lambda: undo(again=True)),
    "edit mode": (2, edit),
    "engine": (2, switch),
    "viewport": (4, shade),
    "orbit": (3, orbit),
    "light": (3, light),
    "mix": (4, mix),
    "delete": (1, delete),
    "new": (2, lambda: bpy.ops.wm.read_homefile()),
    "factory": (1, lambda: bpy.ops.wm.read_factory_settings()),
    "save": (2, lambda: bpy.ops.wm.save_as_mainfile(filepath=FILE)),
    "load": (2, load),
    "disable": (3, lambda: bpy.ops.preferences.addon_disable(module=ADDON)),
    "enable": (5, lambda: bpy.ops.preferences.addon_enable(module=ADDON)),
    "disable Cycles": (1, lambda: bpy.ops.preferences.addon_disable(module="cycles")),
    "reload": (2, reload),
    "wait": (4, lambda: None),
}
plan = chance.choices(list(STEP), [weight for weight, _ in STEP.values()], k=int(STEPS))
plan.append("quit")
STEP["quit"] = (0, bpy.ops.wm.quit_blender)
KEY = "F19"
# Blender lets no script write while any thread is in a method of a class that draws or renders, and sometimes leaves it
# at that as a render ends, for which a step waits that has begun before. What it prints of that is the test's to judge.
READ_ONLY = "can't run in readonly state"
# Nor does it reload scripts while a comparison or a render goes on in the window.
REFUSALS = (READ_ONLY, "Can't reload with running modal operators")


class SHLIGHT_OT_step(bpy.types.Operator):
    """Takes a step. A key starts it, so that its context is the window's own.

    In a context that a script gives, Blender 3.4 takes Python's lock for its own while a thread that renders has it.
    """

    bl_idname = "shlight.step"
    bl_label = "Step"

    def execute(self, context):
        name = plan.pop(0)
        print(f"step {len(plan)}: {name}", flush=True)
        try:
            STEP[name][1]()
        except Exception as error:
            if not any(refusal in str(error) for refusal in REFUSALS):
                traceback.print_exc()
        return {"FINISHED"}


def knock():
    press(KEY)
    return chance.choice([0.02, 0.1, 0.5])


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.system.viewport_aa = "OFF"
bpy.utils.register_class(SHLIGHT_OT_step)
keys = bpy.context.window_manager.keyconfigs.addon.keymaps.new("Window", space_type="EMPTY")
keys.keymap_items.new(SHLIGHT_OT_step.bl_idname, KEY, "PRESS")
bpy.app.timers.register(knock, first_interval=0.5, persistent=True)
