# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of lamps, worlds, materials, objects and view layers.

Those of passes and light groups stand beside Blender's own for AOVs, Cryptomatte and the list of light groups.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..compat import (
    PASSES,
    has_node_switch,
    has_own_terminator,
    has_panorama_settings,
    material_owner,
    panorama_settings,
    shadow_switch,
    uses_nodes,
)
from .base import Draw, panel, with_names_aside

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


@panel("SHLIGHT_WORLD_PT_picture", "Picture")
def world_picture(layout: Any, context: Any) -> None:
    """Settings of the picture that a world of nodes becomes."""
    layout.prop(context.scene.shlight, "world_width")


def _draw_socket(layout: Any, owner: Any, name: str) -> None:
    """The nodes of an input of the output of something that has nodes."""
    layout.use_property_split = True
    output = owner.node_tree.get_output_node("CYCLES") if uses_nodes(owner) else None
    if output is None:
        layout.label(text="No output node")
    else:
        layout.template_node_view(owner.node_tree, output, output.inputs[name])


def _socket_panel(name: str) -> Any:
    draw: Draw = lambda layout, context: _draw_socket(layout, context.material, name)  # noqa: E731
    return panel(f"SHLIGHT_MATERIAL_PT_{name.lower()}", name, closed=True, names_aside=False)(draw)


def _preview_panel(owner: str) -> Any:
    draw: Draw = lambda layout, context: layout.template_preview(getattr(context, owner))  # noqa: E731
    return panel(f"SHLIGHT_{owner.upper()}_PT_preview", "Preview", closed=True, names_aside=False)(draw)


@panel("SHLIGHT_MATERIAL_PT_settings", "Settings", closed=True)
def material_settings(layout: Any, context: Any) -> None:
    """The settings of a material beside its nodes."""
    layout.prop(context.material, "pass_index")
    for name in ("displacement_method", "use_transparent_shadow", "use_bump_map_correction"):
        if (owner := material_owner(context.material, name)) is not None:
            layout.prop(owner, name)


@panel("SHLIGHT_MATERIAL_PT_measured", "Measured BRDF", closed=True)
def measured(layout: Any, context: Any) -> None:
    """The file of a measured BRDF, and whether it is tinted."""
    settings = context.material.shlight
    layout.prop(settings, "measured_file")
    path = bpy.path.abspath(settings.measured_file, library=context.material.library)
    if path:
        layout.prop(settings, "tints_measured")
    if path and not Path(path).is_file():
        layout.label(text="The file is missing; the nodes are drawn", icon="ERROR")


@panel(
    "SHLIGHT_OBJECT_PT_ray_visibility",
    "Ray Visibility",
    parent="OBJECT_PT_visibility",
    shown=lambda context: context.object.type in DRAWN_TYPES or context.object.is_instancer,
)
def ray_visibility(layout: Any, context: Any) -> None:
    """Kinds of rays that an object is hidden from."""
    shown = context.object
    is_lamp = shown.type == "LIGHT"
    column = layout.column()
    for kind in ("camera", "diffuse", "glossy", *([] if is_lamp else ["transmission", "shadow"])):
        column.prop(shown, f"visible_{kind}", text=kind.title())
    if is_lamp:
        return
    layout.prop(shown, "is_shadow_catcher")
    layout.prop(shown, "is_holdout")
    if (cycles := getattr(shown, "cycles", None)) is not None:
        culling = layout.column(heading="Culling", align=True)
        for name in ("use_camera_cull", "use_distance_cull"):
            culling.prop(cycles, name)


def _has_surface(context: Any) -> bool:
    return context.object.type in DRAWN_TYPES - {"LIGHT"} and hasattr(context.object, "cycles")


@panel(
    "SHLIGHT_OBJECT_PT_motion_blur",
    "Motion Blur",
    closed=True,
    shown=_has_surface,
    draw_header=lambda layout, context: layout.prop(context.object.cycles, "use_motion_blur", text=""),
)
def object_motion_blur(layout: Any, context: Any) -> None:
    """Whether an object, and its shape, move while the shutter is open."""
    layout.active = context.scene.render.use_motion_blur and context.object.cycles.use_motion_blur
    layout.prop(context.object.cycles, "use_deform_motion", text="Deformation")


@panel(
    "SHLIGHT_OBJECT_PT_shadow_terminator",
    "Shadow Terminator",
    closed=True,
    shown=lambda context: _has_surface(context) and not has_own_terminator(context.object),
)
def shadow_terminator(layout: Any, context: Any) -> None:
    """The offsets of shadows, which later versions of Blender show for all engines."""
    for name in ("shadow_terminator_offset", "shadow_terminator_geometry_offset"):
        layout.prop(context.object.cycles, name)


@panel("SHLIGHT_LIGHT_PT_light", "Light", names_aside=False)
def lamp(layout: Any, context: Any) -> None:
    """Colour, power and shape of a lamp."""
    light = context.light
    layout.prop(light, "type", expand=True)
    with_names_aside(layout)
    column = layout.column()
    for name in ("color", "use_temperature", "temperature", "energy", "exposure", "normalize"):
        if name in light.bl_rna.properties:  # 3.4 has colour and power alone
            row = column.row()
            row.active = name != "temperature" or light.use_temperature
            row.prop(light, name)
    _draw_shape(layout.column(), light)
    switch = shadow_switch(light)
    if switch is not None:
        layout.prop(*switch, text="Cast Shadow")


def _draw_shape(column: Any, light: Any) -> None:
    if light.type == "SUN":
        column.prop(light, "angle")
    elif light.type == "AREA":
        one_size = light.shape in {"SQUARE", "DISK"}
        column.prop(light, "shape")
        column.prop(light, "size", text="Size" if one_size else "Size X")
        if not one_size:
            column.prop(light, "size_y", text="Y")
        column.prop(light, "spread")
        if hasattr(light, "cycles"):
            column.prop(light.cycles, "is_portal", text="Portal")
    else:
        column.prop(light, "shadow_soft_size", text="Radius")
        if "use_soft_falloff" in light.bl_rna.properties:
            column.prop(light, "use_soft_falloff")
        if light.type == "SPOT":
            column.prop(light, "spot_size", text="Beam Size")
            column.prop(light, "spot_blend", text="Blend", slider=True)


# A type of panorama shows the properties whose names begin so.
PANORAMAS = {
    "FISHEYE_EQUIDISTANT": ("fisheye_fov",),
    "FISHEYE_EQUISOLID": ("fisheye_lens", "fisheye_fov"),
    "FISHEYE_LENS_POLYNOMIAL": ("fisheye_fov", "fisheye_polynomial"),
    "EQUIRECTANGULAR": ("latitude", "longitude"),
    "CENTRAL_CYLINDRICAL": ("central_cylindrical",),
}


@panel(
    "SHLIGHT_CAMERA_PT_panorama",
    "Panorama",
    parent="DATA_PT_lens",
    shown=lambda context: context.camera.type == "PANO" and has_panorama_settings(context.camera),
)
def panorama(layout: Any, context: Any) -> None:
    """The settings of a panoramic camera, which Blender's own panel shows for Cycles alone."""
    settings = panorama_settings(context.camera)
    layout.prop(settings, "panorama_type")
    column = layout.column(align=True)
    for name in (each.identifier for each in settings.bl_rna.properties):
        if name.startswith(PANORAMAS.get(settings.panorama_type, ())):
            column.prop(settings, name)


@panel("SHLIGHT_LIGHT_PT_nodes", "Nodes", names_aside=False)
def lamp_nodes(layout: Any, context: Any) -> None:
    """The shader of a lamp."""
    light = context.light
    if has_node_switch(light):
        layout.prop(light, "use_nodes", icon="NODETREE")
    if not uses_nodes(light):
        return
    _draw_socket(layout, light, "Surface")


@panel("SHLIGHT_VIEWLAYER_PT_passes_data", "Data", parent="VIEWLAYER_PT_layer_passes")
def passes_data(layout: Any, context: Any) -> None:
    """Passes of surfaces."""
    view_layer = context.view_layer
    column = layout.column(heading="Include", align=True)
    _draw_switches(column, view_layer, DATA)
    cycles = getattr(view_layer, "cycles", None)
    if cycles is not None:
        column.prop(cycles, "denoising_store_passes", text="Denoising Data")
    _draw_switches(layout.column(heading="Indexes", align=True), view_layer, INDEXES)
    layout.prop(view_layer, "pass_alpha_threshold")


@panel("SHLIGHT_VIEWLAYER_PT_passes_light", "Light", parent="VIEWLAYER_PT_layer_passes")
def passes_light(layout: Any, context: Any) -> None:
    """Passes of parts of the light."""
    for heading, names in LIGHT.items():
        _draw_switches(layout.column(heading=heading, align=True), context.view_layer, names)
    column = layout.column(heading="Other", align=True)
    _draw_switches(column, context.view_layer, OTHER)
    if (cycles := getattr(context.view_layer, "cycles", None)) is not None:
        column.prop(cycles, "use_pass_shadow_catcher")
    column.prop(context.scene.shlight, "use_pass_lights")


def _draw_switches(column: Any, view_layer: Any, names: tuple[str, ...]) -> None:
    for name in names:
        if f"use_pass_{name}" in PASSES:
            column.prop(view_layer, f"use_pass_{name}")


def _light_group_of(owner: str) -> Draw:
    given = {"text": "Light Group", "results_are_suggestions": True}
    return lambda layout, context: layout.prop_search(
        getattr(context, owner), "lightgroup", context.view_layer, "lightgroups", **given
    )


CLASSES = (
    *map(_preview_panel, ("world", "light")),
    world_picture,
    *map(_socket_panel, ("Volume", "Displacement")),
    material_settings,
    measured,
    ray_visibility,
    object_motion_blur,
    shadow_terminator,
    lamp,
    lamp_nodes,
    panorama,
    passes_data,
    passes_light,
    *(
        panel(f"SHLIGHT_{owner.upper()}_PT_light_group", "Light Group", closed=True)(_light_group_of(owner))
        for owner in ("object", "world")
    ),
)
