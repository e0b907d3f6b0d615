# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's part of Blender's preferences: whether everything that it needs is installed."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from .native import native_problem


class SHLIGHT_Preferences(bpy.types.AddonPreferences):
    """What is missing, if anything."""

    bl_idname = __package__

    def draw(self, context: Any) -> None:
        problem = native_problem()
        column = self.layout.column()
        if not problem:
            column.label(text="Ready: choose shlight as Render Engine in the Render properties", icon="CHECKMARK")
            return
        for number, line in enumerate(textwrap.wrap(f"shlight cannot render: {problem}", 100)):
            column.label(text=line, icon="NONE" if number else "ERROR")


def register() -> None:
    bpy.utils.register_class(SHLIGHT_Preferences)


def unregister() -> None:
    bpy.utils.unregister_class(SHLIGHT_Preferences)
