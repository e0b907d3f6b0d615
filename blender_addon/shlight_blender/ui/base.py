# SPDX-License-Identifier: GPL-3.0-or-later
"""How panels of the render engine are made, and what several of them draw."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import Any

import bpy

from ..running import ENGINE

PIXELS_PER_LETTER = 7.0
DIRECT_ONLY = "Direct light only: Max Bounces is 0"
MORE_IN_CYCLES = "This file lets light bounce {} times in Cycles"
# Tabs of the Properties editor by the part of panels' names, and what of the context a tab is about.
TABS = {
    "RENDER": ("render", "scene"),
    "VIEWLAYER": ("view_layer", "view_layer"),
    "WORLD": ("world", "world"),
    "OBJECT": ("object", "object"),
    "MATERIAL": ("material", "material"),
    "LIGHT": ("data", "light"),
    "CAMERA": ("data", "camera"),
}
# A function that draws, given a layout and the context.
Draw = Callable[[Any, Any], None]


def panel(
    name: str,
    label: str,
    *,
    parent: str = "",
    closed: bool = False,
    names_aside: bool = True,
    shown: Callable[[Any], bool] = lambda context: True,
    **headers: Draw,
) -> Callable[[Draw], Any]:
    """Makes a panel of what a function draws; the function's name then stands for the panel.

    name: as Blender wants it, with the tab (see TABS). names_aside: see `with_names_aside`. shown: of a context with
    shlight as its engine that has what the tab is about. headers: draw_header and draw_header_preset.
    """
    tab, subject = TABS[name.split("_")[1]]

    def poll(_: Any, context: Any) -> bool:
        return context.engine == ENGINE and bool(getattr(context, subject)) and shown(context)

    def method(draw: Draw, aside: bool) -> Callable[[Any, Any], None]:
        return lambda own, context: draw(with_names_aside(own.layout) if aside else own.layout, context)

    def made(draw: Draw) -> Any:
        return type(
            name,
            (bpy.types.Panel,),
            {
                "__module__": draw.__module__,
                "__doc__": draw.__doc__,
                "bl_label": label,
                "bl_space_type": "PROPERTIES",
                "bl_region_type": "WINDOW",
                "bl_context": tab,
                "bl_parent_id": parent,
                "bl_options": {"DEFAULT_CLOSED"} if closed else set(),
                "COMPAT_ENGINES": {ENGINE},
                "poll": classmethod(poll),
                "draw": method(draw, names_aside),
                **{each: method(header, False) for each, header in headers.items()},
            },
        )

    return made


def draw_depth(layout: Any, context: Any, bounces: int) -> None:
    """Says what a picture of so many bounces lacks of what the file asks Cycles for."""
    asked = context.scene.cycles.max_bounces if hasattr(context.scene, "cycles") else 0
    if bounces < max(asked, 1):
        draw_text(layout, context, MORE_IN_CYCLES.format(asked) if bounces else DIRECT_ONLY, "INFO")


def with_names_aside(layout: Any) -> Any:
    """The layout, whose properties have their names in a column of their own from here on, and no keyframe buttons."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def draw_text(layout: Any, context: Any, text: str, icon: str) -> None:
    """Text in lines that fit the region; the icon is before the first of them."""
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    letters = max(int((context.region.width / scale - 60) / PIXELS_PER_LETTER), 20)
    for number, line in enumerate(textwrap.wrap(text, letters)):
        layout.label(text=line, icon="BLANK1" if number else icon)
