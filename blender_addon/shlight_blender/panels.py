# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render engine, and Blender's own panels and menu of nodes that also fit it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy

from . import pass_panels, report_panel
from .compare import panel as compare_panel
from .compat import LAMPS, has_node_switch, nodes_by_engine, shadow_switch, uses_nodes
from .engine_panel import EnginePanel, with_names_aside
from .presets import SHLIGHT_OT_use_preset, draw_presets
from .running import ENGINE

# Panels for every engine that show what shlight does not have, or are replaced below.
EXCLUDED = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_spot",
    "NODE_DATA_PT_light",
    "OBJECT_PT_shading",  # light linking
}
# Parts of panels' names for features that shlight does not draw.
NOT_DRAWN = ("_PT_freestyle", "_PT_gpencil", "_PT_grease_pencil")
# Panels of EEVEE and Cycles that edit what every engine reads.
INCLUDED = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "VIEWLAYER_PT_layer_passes",
    "VIEWLAYER_PT_layer_passes_aov",
    "VIEWLAYER_PT_layer_passes_cryptomatte",
    "VIEWLAYER_PT_layer_passes_lightgroups",
}
# Types of objects that have a surface or give light.
DRAWN_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META", "LIGHT"}


class SHLIGHT_RENDER_PT_sampling(EnginePanel, bpy.types.Panel):
    """How many camera rays pixels get."""

    bl_label = "Sampling"

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = with_names_aside(self.layout)
        settings = context.scene.shlight
        draw_presets(layout, settings)
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

CLASSES = (
    SHLIGHT_OT_use_preset,
    SHLIGHT_RENDER_PT_sampling,
    SHLIGHT_RENDER_PT_sampling_viewport,
    SHLIGHT_RENDER_PT_light,
    SHLIGHT_RENDER_PT_light_advanced,
    SHLIGHT_RENDER_PT_shadows,
    SHLIGHT_RENDER_PT_film,
    SHLIGHT_RENDER_PT_performance,
    *report_panel.CLASSES,
    *compare_panel.CLASSES,
    *pass_panels.CLASSES,
    SHLIGHT_WORLD_PT_baking,
    SHLIGHT_MATERIAL_PT_measured,
    SHLIGHT_OBJECT_PT_ray_visibility,
    SHLIGHT_LIGHT_PT_light,
    SHLIGHT_LIGHT_PT_nodes,
)


def _panels(base: Any = bpy.types.Panel) -> Iterator[Any]:
    for panel in base.__subclasses__():
        yield panel
        yield from _panels(panel)


def shared_panels() -> Iterator[Any]:
    """Blender's own panels that are shown for shlight too."""
    for panel in _panels():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is None or panel in CLASSES:
            continue
        name = panel.__name__
        excluded = name in EXCLUDED or any(part in name for part in NOT_DRAWN)
        if ("BLENDER_RENDER" in engines and not excluded) or name in INCLUDED:
            yield panel


_own_polls: dict[Any, Any] = {}  # of the items of Blender's menu of nodes


def _offer_nodes() -> None:
    """Shows for shlight the nodes that the menu shows for Cycles."""
    for item in nodes_by_engine():
        poll = _own_polls.setdefault(item, item.poll)
        item.poll = lambda context, poll=poll: poll(_as_for_cycles(context))


def _as_for_cycles(context: Any) -> Any:
    if context.engine != ENGINE:
        return context
    return SimpleNamespace(engine="CYCLES", space_data=context.space_data)


def register() -> None:
    """Adds the panels and their operators, and joins Blender's panels and its menu of nodes."""
    for panel in CLASSES:
        bpy.utils.register_class(panel)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.add(ENGINE)
    _offer_nodes()


def unregister() -> None:
    """Leaves Blender's panels and menu, and removes our own."""
    while _own_polls:
        item, poll = _own_polls.popitem()
        item.poll = poll
    for panel in _panels():
        if panel not in CLASSES:
            getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
    for panel in reversed(CLASSES):
        bpy.utils.unregister_class(panel)
