# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of passes and light groups, beside Blender's own for AOVs, Cryptomatte and the list of light groups."""

from __future__ import annotations

from typing import Any

import bpy

from .compat import PASSES
from .engine_panel import EnginePanel, with_names_aside

DATA = ("z", "mist", "position", "normal", "uv")
INDEXES = ("object_index", "material_index")
LIGHT = {
    heading: tuple(f"{heading.lower()}_{part}" for part in ("direct", "indirect", "color"))
    for heading in ("Diffuse", "Glossy", "Transmission")
}
OTHER = ("emit", "environment")


class PassPanel(EnginePanel):
    """A part of the panel of a view layer's passes."""

    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_layer_passes"


class SHLIGHT_VIEWLAYER_PT_passes_data(PassPanel, bpy.types.Panel):
    """Passes of surfaces."""

    bl_label = "Data"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        view_layer = context.view_layer
        column = layout.column(heading="Include", align=True)
        _draw_switches(column, view_layer, DATA)
        cycles = getattr(view_layer, "cycles", None)
        if cycles is not None:
            column.prop(cycles, "denoising_store_passes", text="Denoising Data")
        _draw_switches(layout.column(heading="Indexes", align=True), view_layer, INDEXES)
        layout.prop(view_layer, "pass_alpha_threshold")


class SHLIGHT_VIEWLAYER_PT_passes_light(PassPanel, bpy.types.Panel):
    """Passes of parts of the light."""

    bl_label = "Light"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        for heading, names in LIGHT.items():
            _draw_switches(layout.column(heading=heading, align=True), context.view_layer, names)
        column = layout.column(heading="Other", align=True)
        _draw_switches(column, context.view_layer, OTHER)
        column.prop(context.scene.shlight, "use_pass_lights")


def _draw_switches(column: Any, view_layer: Any, names: tuple[str, ...]) -> None:
    for name in names:
        if f"use_pass_{name}" in PASSES:
            column.prop(view_layer, f"use_pass_{name}")


class LightGroupPanel(EnginePanel):
    """The light group of what `bl_context` names."""

    bl_label = "Light Group"
    bl_options = {"DEFAULT_CLOSED"}
    layout: Any  # Blender's

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown if there is something that may have a group."""
        return bool(getattr(context, cls.bl_context)) and super().poll(context)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        with_names_aside(self.layout).prop_search(
            getattr(context, self.bl_context),
            "lightgroup",
            context.view_layer,
            "lightgroups",
            text="Light Group",
            results_are_suggestions=True,
        )


class SHLIGHT_OBJECT_PT_light_group(LightGroupPanel, bpy.types.Panel):
    """The light group of an object."""

    bl_context = "object"


class SHLIGHT_WORLD_PT_light_group(LightGroupPanel, bpy.types.Panel):
    """The light group of the world."""

    bl_context = "world"


CLASSES = (
    SHLIGHT_VIEWLAYER_PT_passes_data,
    SHLIGHT_VIEWLAYER_PT_passes_light,
    SHLIGHT_OBJECT_PT_light_group,
    SHLIGHT_WORLD_PT_light_group,
)
