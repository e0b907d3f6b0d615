# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render properties, and presets of their settings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..compat import position_owner
from .base import DIRECT_ONLY, draw_depth, draw_text, panel

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
    """Draft, Standard and High, and presets of the user: settings of the scene that belong together."""

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


def _props(layout: Any, owner: Any, *names: str) -> None:
    for name in names:
        layout.prop(owner, name)


@panel(
    "SHLIGHT_RENDER_PT_sampling",
    "Sampling",
    draw_header_preset=lambda layout, context: SHLIGHT_PT_presets.draw_panel_header(layout),
)
def sampling(layout: Any, context: Any) -> None:
    """How many camera rays pixels get."""
    settings = context.scene.shlight
    if settings.max_bounces == 0:
        draw_text(layout, context, DIRECT_ONLY, "INFO")
    layout.prop(settings, "noise_threshold")
    samples = ["pixel_samples"] if settings.pixel_samples else ["max_samples", "min_samples"]
    _props(layout.column(align=True), settings, *samples)
    _props(layout, settings, "time_limit", "use_denoising")


@panel("SHLIGHT_RENDER_PT_sampling_viewport", "Viewport", parent="SHLIGHT_RENDER_PT_sampling", closed=True)
def sampling_viewport(layout: Any, context: Any) -> None:
    """The same of rendered viewports."""
    settings = context.scene.shlight
    layout.prop(settings, "preview_noise_threshold")
    _props(layout.column(align=True), settings, "preview_max_samples", "preview_min_samples")
    _props(layout, settings, "preview_time_limit", "preview_use_denoising")
    layout.prop(context.scene.render, "preview_pixel_size")


@panel("SHLIGHT_RENDER_PT_light", "Light Paths", closed=True)
def light(layout: Any, context: Any) -> None:
    """Paths of light."""
    draw_depth(layout, context, context.scene.shlight.max_bounces)
    column = layout.column(align=True)
    _props(column, context.scene.shlight, "max_bounces", "glossy_bounces", "transmission_bounces")
    cycles = getattr(context.scene, "cycles", None)
    if cycles is not None:
        column.prop(cycles, "transparent_max_bounces", text="Transparent Bounces")
        layout.prop(cycles, "blur_glossy")
        layout.prop(cycles, "sample_clamp_indirect")
    layout.prop(context.scene.shlight, "preview_max_bounces", text="Viewport")


@panel("SHLIGHT_RENDER_PT_light_advanced", "Advanced", parent="SHLIGHT_RENDER_PT_light", closed=True)
def light_advanced(layout: Any, context: Any) -> None:
    """The precision with which light is integrated."""
    settings = context.scene.shlight
    column = layout.column()
    column.active = settings.order == "AUTO"
    column.prop(settings, "tolerance")
    layout.prop(settings, "order")


@panel(
    "SHLIGHT_RENDER_PT_shadows",
    "Shadows",
    draw_header=lambda layout, context: layout.prop(context.scene.shlight, "use_shadows", text=""),
)
def shadows(layout: Any, context: Any) -> None:
    """Shadows."""
    layout.active = context.scene.shlight.use_shadows
    layout.prop(context.scene.shlight, "shadow_rays")


@panel("SHLIGHT_RENDER_PT_film", "Film", closed=True)
def film(layout: Any, context: Any) -> None:
    """Film."""
    layout.prop(context.scene.render, "film_transparent", text="Transparent")
    cycles = getattr(context.scene, "cycles", None)
    if cycles is not None:
        layout.prop(cycles, "film_exposure")
        column = layout.column(align=True)
        column.prop(cycles, "pixel_filter_type", text="Pixel Filter")
        if cycles.pixel_filter_type != "BOX":
            column.prop(cycles, "filter_width", text="Width")


@panel(
    "SHLIGHT_RENDER_PT_motion_blur",
    "Motion Blur",
    closed=True,
    draw_header=lambda layout, context: layout.prop(context.scene.render, "use_motion_blur", text=""),
)
def motion_blur(layout: Any, context: Any) -> None:
    """How long the shutter is open, and when."""
    scene, render = context.scene, context.scene.render
    layout.active = render.use_motion_blur
    owner = position_owner(scene)
    if owner is not None:
        layout.prop(owner, "motion_blur_position", text="Position")
    layout.prop(render, "motion_blur_shutter")
    layout.prop(scene.shlight, "motion_times")
    layout.template_curve_mapping(render, "motion_blur_shutter_curve")


@panel("SHLIGHT_RENDER_PT_performance", "Performance", closed=True)
def performance(layout: Any, context: Any) -> None:
    """Threads, and what is kept from frame to frame."""
    render = context.scene.render
    column = layout.column()
    column.prop(render, "threads_mode")
    row = column.row()
    row.active = render.threads_mode == "FIXED"
    row.prop(render, "threads")
    layout.prop(render, "use_persistent_data", text="Persistent Data")


@panel(
    "SHLIGHT_RENDER_PT_simplify_more",
    "Textures and Culling",
    parent="RENDER_PT_simplify",
    closed=True,
    shown=lambda context: hasattr(context.scene, "cycles"),
)
def simplify_more(layout: Any, context: Any) -> None:
    """Shows the settings of Simplify that Cycles has beside subdivision."""
    cycles = context.scene.cycles
    layout.active = context.scene.render.use_simplify
    layout.prop(cycles, "texture_limit_render", text="Texture Limit")
    if hasattr(cycles, "texture_resolution_render"):
        layout.prop(cycles, "texture_resolution_render", text="Texture Resolution")
    for kind in ("camera", "distance"):
        row = layout.row(align=True)
        row.prop(cycles, f"use_{kind}_cull", text=f"{kind.title()} Culling")
        row.prop(cycles, f"{kind}_cull_margin", text="")


@panel(
    "SHLIGHT_RENDER_PT_subdivision",
    "Subdivision",
    closed=True,
    shown=lambda context: hasattr(context.scene, "cycles"),
)
def subdivision(layout: Any, context: Any) -> None:
    """Lengths of edges that adaptive subdivision ends at, which Blender's own panel shows for Cycles alone."""
    cycles = context.scene.cycles
    _props(layout.column(align=True), cycles, "dicing_rate", "preview_dicing_rate")
    _props(layout, cycles, "offscreen_dicing_scale", "max_subdivisions")
    if "feature_set" in cycles.bl_rna.properties:  # before Blender 5.0 it asks for experimental features
        layout.prop(cycles, "feature_set")


SAMPLING = (SHLIGHT_PT_presets, SHLIGHT_OT_add_preset, sampling, sampling_viewport)
FURTHER = (light, light_advanced, shadows, subdivision, film, motion_blur, performance, simplify_more)
