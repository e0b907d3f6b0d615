# SPDX-License-Identifier: GPL-3.0-or-later
"""What the comparison adds to Blender beside its panel: its settings, a key, and a watch over its results."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import overlay, results
from .job import session
from .panel import SHLIGHT_CompareSettings, SHLIGHT_OT_drag_split

_keys: list[tuple[Any, Any]] = []


_shown: list[tuple[Any, str]] = []  # before an undo


@persistent
def _before_undo(*_: Any) -> None:
    session.end("an undo")
    _shown[:] = results.shown()


@persistent
def _after_undo(*_: Any) -> None:
    results.make_images()  # Blender has removed those that are younger than what was undone
    results.show(_shown)
    _shown.clear()


@persistent
def _forget(*_: Any) -> None:
    session.end("another file")
    overlay.remove()
    results.forget()


HANDLERS = {
    "undo_pre": _before_undo,
    "redo_pre": _before_undo,
    "undo_post": _after_undo,
    "redo_post": _after_undo,
    "load_pre": _forget,
}


def register() -> None:
    bpy.utils.register_class(SHLIGHT_CompareSettings)
    bpy.types.WindowManager.shlight_compare = bpy.props.PointerProperty(type=SHLIGHT_CompareSettings)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:  # None in the background
        keymap = keys.keymaps.new("Image", space_type="IMAGE_EDITOR")
        _keys.append((keymap, keymap.keymap_items.new(SHLIGHT_OT_drag_split.bl_idname, "LEFTMOUSE", "PRESS")))


def unregister() -> None:
    """Ends the comparison that runs, and removes all of it with the results."""
    session.end("the add-on's removal")
    overlay.remove()
    results.remove()
    while _keys:
        keymap, item = _keys.pop()
        keymap.keymap_items.remove(item)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    del bpy.types.WindowManager.shlight_compare
    bpy.utils.unregister_class(SHLIGHT_CompareSettings)
