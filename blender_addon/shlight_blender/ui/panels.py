# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render engine, and Blender's own panels and menu of nodes that also fit it."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import bpy

from ..compare import panel as compare_panel
from ..compat import nodes_by_engine
from ..running import ENGINE
from . import data, light_mixer, report, settings

# Panels for every engine that show what shlight does not have, or are replaced below.
EXCLUDED = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_spot",
    "NODE_DATA_PT_light",
}
# Parts of panels' names for features that shlight does not draw.
NOT_DRAWN = ("_PT_gpencil", "_PT_grease_pencil")
# Panels of EEVEE and Cycles that edit what shlight reads too, in all versions of Blender.
INCLUDED = {
    "CYCLES_RENDER_PT_filter",
    "CYCLES_RENDER_PT_override",
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_WORLD_PT_mist",
    "MATERIAL_PT_preview",
    "OBJECT_PT_shadow_terminator",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "VIEWLAYER_PT_override",
    "VIEWLAYER_PT_layer_passes",
    "VIEWLAYER_PT_layer_passes_aov",
    "VIEWLAYER_PT_layer_passes_cryptomatte",
    "VIEWLAYER_PT_layer_passes_lightgroups",
}

# Panels of a tab are shown in this order.
CLASSES = (
    *settings.SAMPLING,
    *report.CLASSES,
    *light_mixer.CLASSES,
    *settings.FURTHER,
    *compare_panel.CLASSES,
    *data.CLASSES,
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


_own_engines: list[Any] = []  # panels that have got a set of engines of their own
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
    for panel in [*shared_panels()]:
        if "COMPAT_ENGINES" not in vars(panel):  # its base's, which other panels of Cycles have too
            panel.COMPAT_ENGINES = set(panel.COMPAT_ENGINES)
            _own_engines.append(panel)
        panel.COMPAT_ENGINES.add(ENGINE)
    _offer_nodes()
    light_mixer.register()


def unregister() -> None:
    """Leaves Blender's panels and menu, and removes our own."""
    light_mixer.unregister()
    while _own_polls:
        item, poll = _own_polls.popitem()
        item.poll = poll
    while _own_engines:
        del _own_engines.pop().COMPAT_ENGINES
    for panel in _panels():
        if panel not in CLASSES:
            getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
    for panel in reversed(CLASSES):
        bpy.utils.unregister_class(panel)
