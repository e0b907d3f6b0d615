# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of lamps, worlds, materials, objects and view layers.

Those of passes and light groups stand beside Blender's own for AOVs, Cryptomatte and the list of light groups.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..compat import LAMPS, PASSES, has_node_switch, shadow_switch, uses_nodes
from .base import EnginePanel, with_names_aside

# Types of objects that have a surface or give light.
DRAWN_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META", "LIGHT"}
# Passes by their names in Blender.
DATA = ("z", "mist", "position", "normal", "uv")
INDEXES = ("object_index", "material_index")
LIGHT = {
    heading: tuple(f"{heading.lower()}_{part}" for part in ("direct", "indirect", "color"))
    for heading in ("Diffuse", "Glossy", "Transmission")
}
OTHER = ("emit", "environment")


class SHLIGHT_WORLD_PT_baking(EnginePanel, bpy.types.Panel):
    """Settings of baked worlds."""

    bl_label = "Baking"
    bl_context = "world"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown if there is a world."""
        return bool(context.world) and super().poll(context)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        layout.prop(context.scene.shlight, "world_width")


class SHLIGHT_MATERIAL_PT_measured(EnginePanel, bpy.types.Panel):
    """The file of a measured BRDF."""

    bl_label = "Measured BRDF"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown if there is a material."""
        return bool(context.material) and super().poll(context)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout, settings = with_names_aside(self.layout), context.material.shlight
        layout.prop(settings, "measured_file")
        path = bpy.path.abspath(settings.measured_file, library=context.material.library)
        if path and not Path(path).is_file():
            layout.label(text="The file is missing; the nodes are drawn", icon="ERROR")


class SHLIGHT_OBJECT_PT_ray_visibility(EnginePanel, bpy.types.Panel):
    """Kinds of rays that an object is hidden from; dim where that is not supported."""

    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown for objects that are drawn or show others."""
        shown = context.object
        return bool(shown) and (shown.type in DRAWN_TYPES or shown.is_instancer) and super().poll(context)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        shown = context.object
        is_lamp = shown.type == "LIGHT"
        column = layout.column()
        column.active = is_lamp or (shown.is_instancer and LAMPS.instancer_hides)
        for kind in ("camera", "diffuse", "glossy", *([] if is_lamp else ["shadow"])):
            column.prop(shown, f"visible_{kind}", text=kind.title())


class LampPanel(EnginePanel):
    """Base of panels of lamps."""

    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown for lamps."""
        return bool(context.light) and super().poll(context)


class SHLIGHT_LIGHT_PT_light(LampPanel, bpy.types.Panel):
    """Colour, power and shape of a lamp."""

    bl_label = "Light"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        light = context.light
        layout.prop(light, "type", expand=True)
        with_names_aside(layout)
        column = layout.column()
        for name in ("color", "use_temperature", "temperature", "energy", "exposure", "normalize"):
            if name in light.bl_rna.properties:  # 3.4 has colour and power alone
                row = column.row()
                row.active = name != "temperature" or light.use_temperature
                row.prop(light, name)
        _DRAW_SHAPE[light.type](layout.column(), light)
        switch = shadow_switch(light)
        if switch is not None:
            layout.prop(*switch, text="Cast Shadow")


class SHLIGHT_LIGHT_PT_nodes(LampPanel, bpy.types.Panel):
    """The shader of a lamp."""

    bl_label = "Nodes"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        light = context.light
        if has_node_switch(light):
            layout.prop(light, "use_nodes", icon="NODETREE")
        if not uses_nodes(light):
            return
        layout.use_property_split = True
        output = light.node_tree.get_output_node("CYCLES")
        if output is None:
            layout.label(text="No output node")
        else:
            layout.template_node_view(light.node_tree, output, output.inputs["Surface"])


def _draw_point(column: Any, light: Any) -> None:
    column.prop(light, "shadow_soft_size", text="Radius")
    if "use_soft_falloff" in light.bl_rna.properties:
        column.prop(light, "use_soft_falloff")


def _draw_spot(column: Any, light: Any) -> None:
    _draw_point(column, light)
    column.prop(light, "spot_size", text="Beam Size")
    column.prop(light, "spot_blend", text="Blend", slider=True)


def _draw_sun(column: Any, light: Any) -> None:
    column.prop(light, "angle")


def _draw_area(column: Any, light: Any) -> None:
    column.prop(light, "shape")
    if light.shape in {"SQUARE", "DISK"}:
        column.prop(light, "size")
    else:
        column.prop(light, "size", text="Size X")
        column.prop(light, "size_y", text="Y")
    column.prop(light, "spread")


_DRAW_SHAPE = {"POINT": _draw_point, "SPOT": _draw_spot, "SUN": _draw_sun, "AREA": _draw_area}


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
    SHLIGHT_WORLD_PT_baking,
    SHLIGHT_MATERIAL_PT_measured,
    SHLIGHT_OBJECT_PT_ray_visibility,
    SHLIGHT_LIGHT_PT_light,
    SHLIGHT_LIGHT_PT_nodes,
    SHLIGHT_VIEWLAYER_PT_passes_data,
    SHLIGHT_VIEWLAYER_PT_passes_light,
    SHLIGHT_OBJECT_PT_light_group,
    SHLIGHT_WORLD_PT_light_group,
)
