# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render engine, and Blender's own that also fit it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .engine import ENGINE

# Panels for every engine that show what shlight does not have, or are replaced below.
EXCLUDED = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_spot",
    "NODE_DATA_PT_light",
    "RENDER_PT_freestyle",
    "RENDER_PT_gpencil",
    "VIEWLAYER_PT_freestyle",
}
# Panels of EEVEE that edit what every engine reads.
INCLUDED = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
}


class EnginePanel:
    """What the panels below have in common."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown while shlight is the scene's engine."""
        return context.engine in cls.COMPAT_ENGINES


class SHLIGHT_RENDER_PT_accuracy(EnginePanel, bpy.types.Panel):
    """How precisely light is integrated."""

    bl_label = "Accuracy"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.shlight
        layout.prop(settings, "order")
        column = layout.column()
        column.active = settings.order == "AUTO"
        column.prop(settings, "tolerance")
        layout.prop(settings, "pixel_samples")
        layout.prop(settings, "world_width")


class SHLIGHT_RENDER_PT_shadows(EnginePanel, bpy.types.Panel):
    """Shadows."""

    bl_label = "Shadows"

    def draw_header(self, context: Any) -> None:
        """Draws the switch."""
        self.layout.prop(context.scene.shlight, "use_shadows", text="")

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.shlight
        layout.active = settings.use_shadows
        layout.prop(settings, "shadow_rays")


class SHLIGHT_RENDER_PT_film(EnginePanel, bpy.types.Panel):
    """Film."""

    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(context.scene.render, "film_transparent", text="Transparent")


class SHLIGHT_LIGHT_PT_light(EnginePanel, bpy.types.Panel):
    """Colour, power and shape of a lamp."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown for lamps."""
        return bool(context.light) and super().poll(context)

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        light = context.light
        layout.prop(light, "type", expand=True)
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name in ("color", "use_temperature", "temperature", "energy", "exposure", "normalize"):
            if name in light.bl_rna.properties:  # 3.4 has colour and power alone
                row = column.row()
                row.active = name != "temperature" or light.use_temperature
                row.prop(light, name)
        _DRAW_SHAPE[light.type](layout.column(), light)


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

CLASSES = (
    SHLIGHT_RENDER_PT_accuracy,
    SHLIGHT_RENDER_PT_shadows,
    SHLIGHT_RENDER_PT_film,
    SHLIGHT_LIGHT_PT_light,
)


def shared_panels() -> Iterator[Any]:
    """Blender's own panels that are shown for shlight too."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is None or panel in CLASSES:
            continue
        if ("BLENDER_RENDER" in engines and panel.__name__ not in EXCLUDED) or panel.__name__ in INCLUDED:
            yield panel


def register() -> None:
    """Adds the panels and joins Blender's."""
    for panel in CLASSES:
        bpy.utils.register_class(panel)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    """Leaves Blender's panels and removes our own."""
    for panel in bpy.types.Panel.__subclasses__():
        if panel not in CLASSES:
            getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
    for panel in reversed(CLASSES):
        bpy.utils.unregister_class(panel)
