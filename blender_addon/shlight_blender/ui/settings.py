# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render properties, and presets of their settings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from .base import EnginePanel, with_names_aside

PRESETS = Path(__file__).with_name("presets")
PRESET_SETTINGS = (
    "noise_threshold",
    "min_samples",
    "max_samples",
    "tolerance",
    "pixel_samples",
    "order",
    "shadow_rays",
)


class SHLIGHT_PT_presets(PresetPanel, bpy.types.Panel):
    """Draft, Preview and Final, and presets of the user: settings of the scene that belong together."""

    bl_label = "Presets"
    preset_subdir = "shlight"
    preset_operator = "script.execute_preset"
    preset_add_operator = "shlight.add_preset"

    def path_menu(self, searchpaths: list[str], operator: str, **further: Any) -> None:
        """Lists the add-on's presets before the user's."""
        bpy.types.Menu.path_menu(self, [str(PRESETS), *searchpaths], operator, **further)


class SHLIGHT_OT_add_preset(AddPresetBase, bpy.types.Operator):
    """Adds or removes a preset of all of Sampling, Light and Shadows but the switches and the time limit."""

    bl_idname = "shlight.add_preset"
    bl_label = "Add Preset"
    preset_menu = "SHLIGHT_PT_presets"
    preset_defines = ["settings = bpy.context.scene.shlight"]
    preset_values = [f"settings.{name}" for name in PRESET_SETTINGS]
    preset_subdir = SHLIGHT_PT_presets.preset_subdir


class SHLIGHT_RENDER_PT_sampling(EnginePanel, bpy.types.Panel):
    """How many camera rays pixels get."""

    bl_label = "Sampling"

    def draw_header_preset(self, context: Any) -> None:
        """Draws the button of the presets."""
        SHLIGHT_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        settings = context.scene.shlight
        layout.prop(settings, "noise_threshold")
        column = layout.column(align=True)
        if settings.pixel_samples:
            column.prop(settings, "pixel_samples")
        else:
            column.prop(settings, "max_samples")
            column.prop(settings, "min_samples")
        layout.prop(settings, "time_limit")
        layout.prop(settings, "use_denoising")


class SHLIGHT_RENDER_PT_sampling_viewport(EnginePanel, bpy.types.Panel):
    """The same of rendered viewports."""

    bl_label = "Viewport"
    bl_parent_id = "SHLIGHT_RENDER_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        settings = context.scene.shlight
        layout.prop(settings, "preview_noise_threshold")
        column = layout.column(align=True)
        column.prop(settings, "preview_max_samples")
        column.prop(settings, "preview_min_samples")
        layout.prop(settings, "preview_time_limit")
        layout.prop(settings, "preview_use_denoising")
        layout.prop(context.scene.render, "preview_pixel_size")


class SHLIGHT_RENDER_PT_light(EnginePanel, bpy.types.Panel):
    """Paths of light, and the precision of its integration."""

    bl_label = "Light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        column = layout.column(align=True)
        for name in ("max_bounces", "glossy_bounces", "transmission_bounces"):
            column.prop(context.scene.shlight, name)
        cycles = getattr(context.scene, "cycles", None)
        if cycles is not None:
            column.prop(cycles, "transparent_max_bounces", text="Transparent Bounces")
        layout.prop(context.scene.shlight, "preview_max_bounces", text="Viewport")


class SHLIGHT_RENDER_PT_light_advanced(EnginePanel, bpy.types.Panel):
    """Settings that are rarely changed."""

    bl_label = "Advanced"
    bl_parent_id = "SHLIGHT_RENDER_PT_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        settings = context.scene.shlight
        column = layout.column()
        column.active = settings.order == "AUTO"
        column.prop(settings, "tolerance")
        layout.prop(settings, "order")


class SHLIGHT_RENDER_PT_shadows(EnginePanel, bpy.types.Panel):
    """Shadows."""

    bl_label = "Shadows"

    def draw_header(self, context: Any) -> None:
        """Draws the switch."""
        self.layout.prop(context.scene.shlight, "use_shadows", text="")

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        settings = context.scene.shlight
        layout.active = settings.use_shadows
        layout.prop(settings, "shadow_rays")


class SHLIGHT_RENDER_PT_film(EnginePanel, bpy.types.Panel):
    """Film."""

    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        layout.prop(context.scene.render, "film_transparent", text="Transparent")
        cycles = getattr(context.scene, "cycles", None)
        if cycles is not None:
            column = layout.column(align=True)
            column.prop(cycles, "pixel_filter_type", text="Pixel Filter")
            if cycles.pixel_filter_type != "BOX":
                column.prop(cycles, "filter_width", text="Width")


class SHLIGHT_RENDER_PT_performance(EnginePanel, bpy.types.Panel):
    """Threads, and what is kept from frame to frame."""

    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        render = context.scene.render
        column = layout.column()
        column.prop(render, "threads_mode")
        row = column.row()
        row.active = render.threads_mode == "FIXED"
        row.prop(render, "threads")
        layout.prop(render, "use_persistent_data", text="Persistent Data")


CLASSES = (
    SHLIGHT_PT_presets,
    SHLIGHT_OT_add_preset,
    SHLIGHT_RENDER_PT_sampling,
    SHLIGHT_RENDER_PT_sampling_viewport,
    SHLIGHT_RENDER_PT_light,
    SHLIGHT_RENDER_PT_light_advanced,
    SHLIGHT_RENDER_PT_shadows,
    SHLIGHT_RENDER_PT_film,
    SHLIGHT_RENDER_PT_performance,
)
