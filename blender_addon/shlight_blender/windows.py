# SPDX-License-Identifier: GPL-3.0-or-later
"""Areas of Blender's windows."""

from __future__ import annotations

from typing import Any

import bpy


def areas(*types: str) -> list[Any]:
    """Areas of all windows that are of these types, such as IMAGE_EDITOR."""
    windows = bpy.data.window_managers[0].windows if bpy.data.window_managers else ()
    return [area for window in windows for area in window.screen.areas if area.type in types]


def redraw(*types: str) -> None:
    """Has these areas drawn anew, which Blender does by itself only where a property has changed."""
    for area in areas(*types):
        area.tag_redraw()
