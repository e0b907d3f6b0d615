# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: edits a scene at random in a rendered viewport, with a picture each second.

Arguments: a folder, a seed and for how many seconds.
"""

import os
import random
import sys
import time
from pathlib import Path

import bpy
from mathutils import Quaternion

sys.path.append(str(Path(__file__).parent))
from debian_steps import FOLDER, area_of, start

SEED, SECONDS = map(int, sys.argv[-2:])
chance = random.Random(SEED)
found = {"resident": []}  # each second


def area():
    return area_of("VIEW_3D")


def surface():
    return bpy.data.materials["Material"].node_tree.nodes["Principled BSDF"].inputs


def place(name, height):
    bpy.data.objects[name].location = (chance.uniform(-2, 2), chance.uniform(-2, 2), height)


def hide():
    name = chance.choice(["Cube", "Ball"])
    bpy.data.objects[name].hide_set(not bpy.data.objects[name].hide_get())


def turn():
    view = area().spaces[0].region_3d
    view.view_rotation = Quaternion((0, 0, 1), chance.uniform(-0.5, 0.5)) @ view.view_rotation


EDITS = {
    "move a lamp": lambda: place("Light", 4),
    "lamp's power": lambda: setattr(bpy.data.lights["Light"], "energy", chance.choice([300, 1000])),
    "move an object": lambda: place(chance.choice(["Cube", "Ball"]), 0),
    "colour": lambda: setattr(surface()["Base Color"], "default_value", [*chance.choices([0.1, 0.8], k=3), 1]),
    "roughness": lambda: setattr(surface()["Roughness"], "default_value", chance.random()),
    "hide": hide,
    "turn": turn,
    "undo": lambda: bpy.ops.ed.undo.poll() and bpy.ops.ed.undo(),
}


def edits():
    bpy.context.scene.render.engine = "SHLIGHT"
    bpy.ops.mesh.primitive_uv_sphere_add(location=(2, 0, 0))
    bpy.context.object.name = "Ball"
    bpy.ops.mesh.primitive_plane_add(size=8, location=(0, 0, -1))
    bpy.ops.ed.undo_push(message="floor")
    space = area().spaces[0]
    space.overlay.show_overlays = space.show_gizmo = False  # nothing but the picture is drawn
    space.shading.type = "RENDERED"
    for _ in range(100):  # ten seconds at least, for the first picture
        yield
    region = next(region for region in area().regions if region.type == "WINDOW")
    found["region"] = [region.x, region.y, region.width, region.height]
    begin = time.monotonic()
    while len(found["resident"]) < SECONDS:
        name = chance.choice(list(EDITS))
        EDITS[name]()
        if name != "undo":
            bpy.ops.ed.undo_push(message=name)
        for _ in range(chance.choice([1, 3, 10])):
            yield
            if time.monotonic() - begin > len(found["resident"]):
                bpy.ops.screen.screenshot(filepath=str(FOLDER / f"{len(found['resident']):04}.png"))
                pages = int(Path("/proc/self/statm").read_text().split()[1])
                found["resident"].append(pages * os.sysconf("SC_PAGE_SIZE"))


start(edits(), found)
