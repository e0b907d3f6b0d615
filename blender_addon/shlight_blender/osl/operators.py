# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that put the light of lamps into materials, for Cycles, and take it out."""

from __future__ import annotations

from typing import Any

import bpy

from ..compat import IS_BLENDER_4
from ..names import name_of
from . import materials, script


def _selected_materials(context: Any) -> list[Any]:
    found = (slot.material for shown in context.selected_objects for slot in shown.material_slots)
    return list(dict.fromkeys(material for material in found if material is not None))


class SHLIGHT_OT_osl_insert(bpy.types.Operator):
    """Cycles draws the unshadowed light of the selected point lamps on the selected objects without noise"""

    bl_idname = "shlight.osl_insert"
    bl_label = "Lamps into Materials (OSL)"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        chosen = [shown for shown in context.selected_objects if shown.type == "LIGHT"]
        problem = "" if chosen and _selected_materials(context) else "select lamps, and objects with materials"
        if not IS_BLENDER_4:
            problem = "this needs Blender 4.0 or later"
        if not script.has_osl():
            problem = "this Blender was built without Open Shading Language"
        if problem:
            self.report({"ERROR"}, f"shlight: {problem}")
            return {"CANCELLED"}
        lamps = []
        for lamp in chosen:
            if problem := materials.problem_of_lamp(lamp):
                self.report({"WARNING"}, f"{name_of(lamp)}: {problem}")
            else:
                lamps.append(lamp)
        done = 0
        for material in _selected_materials(context):
            try:
                materials.insert(material, lamps)
                done += 1
            except ValueError as error:
                self.report({"WARNING"}, f"{name_of(material)}: {error}")
        for remark in [remark for lamp in lamps for remark in materials.link_light(lamp)]:
            self.report({"WARNING"}, remark)
        if not (lamps and done):
            self.report({"ERROR"}, "shlight: nothing that is selected is supported")
            return {"CANCELLED"}
        if context.scene.render.engine == "CYCLES":
            context.scene.cycles.shading_system, context.scene.cycles.device = True, "CPU"
        self.report({"INFO"}, f"{len(lamps)} lamps in {done} materials; Cycles uses Open Shading Language on the CPU")
        return {"FINISHED"}


class SHLIGHT_OT_osl_remove(bpy.types.Operator):
    """Takes the light of lamps out of the materials of the selected objects"""

    bl_idname = "shlight.osl_remove"
    bl_label = "Lamps out of Materials (OSL)"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        lamps = set().union(*(materials.remove(material) for material in _selected_materials(context)))
        for lamp in lamps:
            materials.link_light(lamp)
        self.report({"INFO"}, f"{len(lamps)} lamps taken out")
        return {"FINISHED"}


CLASSES = (SHLIGHT_OT_osl_insert, SHLIGHT_OT_osl_remove)


def _draw(menu: Any, context: Any) -> None:
    if context.engine == "CYCLES":
        menu.layout.separator()
        for made in CLASSES:
            menu.layout.operator(made.bl_idname)


def register() -> None:
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.VIEW3D_MT_object.append(_draw)


def unregister() -> None:
    bpy.types.VIEW3D_MT_object.remove(_draw)
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
