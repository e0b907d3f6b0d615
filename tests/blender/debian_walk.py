# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: an impatient person, who renders and does other things meanwhile.

Arguments: a folder, a seed and how many steps to take. Prints the steps, so that a walk that fails is known.
"""

import os
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
    scene.render.use_persistent_data = chance.random() < 0.3
    return True


def render(**what):
    if ready() and not bpy.app.is_job_running("RENDER"):
        bpy.ops.render.render("INVOKE_DEFAULT", **what)


def compare():
    if ready() and addon_utils.check("cycles")[1] and not bpy.app.is_job_running("RENDER"):
        session = sys.modules[f"{ADDON}.compare.session"].session
        if session.job is None:
            bpy.ops.shlight.compare("INVOKE_DEFAULT")


def move():
    for shown in window().scene.objects:
        shown.location.x += chance.uniform(-0.1, 0.1)
    bpy.ops.ed.undo_push(message="move")


def undo():
    if bpy.ops.ed.undo.poll():
        bpy.ops.ed.undo()


def load():
    if Path(FILE).is_file():
        bpy.ops.wm.open_mainfile(filepath=FILE)


def shade():
    if not ready():
        return
    for area in window().screen.areas:
        if area.type == "VIEW_3D":
            area.spaces[0].shading.type = chance.choice(["RENDERED", "SOLID"])


STEP = {
    "F12": (6, lambda: ready() and press("F12")),
    "render": (6, render),
    "compare": (2, compare),
    "animation": (3, lambda: render(animation=True)),
    "Esc": (4, lambda: press("ESC")),
    "move": (2, move),
    "undo": (2, undo),
    "viewport": (1, shade),
    "new": (2, lambda: bpy.ops.wm.read_homefile()),
    "factory": (1, lambda: bpy.ops.wm.read_factory_settings()),
    "save": (2, lambda: bpy.ops.wm.save_as_mainfile(filepath=FILE)),
    "load": (2, load),
    "disable": (3, lambda: bpy.ops.preferences.addon_disable(module=ADDON)),
    "enable": (5, lambda: bpy.ops.preferences.addon_enable(module=ADDON)),
    "disable Cycles": (1, lambda: bpy.ops.preferences.addon_disable(module="cycles")),
    "reload": (2, lambda: bpy.ops.script.reload()),
    "wait": (4, lambda: None),
}
plan = chance.choices(list(STEP), [weight for weight, _ in STEP.values()], k=int(STEPS))


plan.append("quit")
STEP["quit"] = (0, bpy.ops.wm.quit_blender)


refused = 0


def walk():
    global refused
    name = plan[0]
    if refused == 0:
        print(f"step {len(plan)}: {name}", flush=True)
    try:
        with bpy.context.temp_override(window=window()):
            ask_to_write()
            STEP[name][1]()
    except (AttributeError, RuntimeError) as error:
        if any(refusal in str(error) for refusal in ("in this context", "in this state", "in readonly state")):
            return wait_to_write()
        traceback.print_exc()
    except Exception:
        traceback.print_exc()
    refused = 0
    plan.pop(0)
    return chance.choice([0.02, 0.1, 0.5]) if plan else None


def ask_to_write():
    """Fails where no script may write: add-ons and scripts that are disabled or reloaded then are left half-done."""
    scene = window().scene
    scene.frame_end = scene.frame_end


def wait_to_write():
    """Blender lets no script write while any thread is in a method of a class that draws or renders.

    Where a panel is drawn as a render ends, Blender 3.4 leaves it at that for good.
    """
    global refused
    refused += 1
    if refused == 500:
        print("Blender lets no script write any more", flush=True)
        os._exit(0)
    return 0.02


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(walk, first_interval=0.5, persistent=True)
