# SPDX-License-Identifier: GPL-3.0-or-later
"""What all panels of the render engine have in common."""

from __future__ import annotations

import textwrap
from typing import Any

from ..running import ENGINE

PIXELS_PER_LETTER = 7.0


class EnginePanel:
    """A panel of the render properties."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Shown while shlight is the scene's engine."""
        return context.engine in cls.COMPAT_ENGINES


def with_names_aside(layout: Any) -> Any:
    """The layout, whose properties have their names in a column of their own from here on, and no keyframe buttons."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def draw_text(layout: Any, context: Any, text: str, icon: str) -> None:
    """Text in lines that fit the region; the icon is before the first of them."""
    scale = context.preferences.system.ui_scale
    letters = max(int((context.region.width / scale - 60) / PIXELS_PER_LETTER), 20)
    for number, line in enumerate(textwrap.wrap(text, letters)):
        layout.label(text=line, icon="BLANK1" if number else icon)
