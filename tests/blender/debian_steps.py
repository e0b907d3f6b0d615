# SPDX-License-Identifier: MIT
"""Runs a test's steps inside a window of Debian's Blender, with redraws between, writes what was found, and quits."""

import json
import os
import sys
import traceback
from collections.abc import Generator
from pathlib import Path
from typing import Any

import bpy

import shlight_blender

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])


def area_of(kind: str) -> Any:
    """The window's first area of a kind, which is there."""
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == kind)


def start(plan: Generator[None, None, None], found: dict[str, Any], seconds: float = 0.1) -> None:
    """A step as often; `found` becomes the file found.json."""

    def step() -> float | None:
        try:
            next(plan)
            return seconds
        except StopIteration:
            (FOLDER / "found.json").write_text(json.dumps(found))
        except Exception:
            traceback.print_exc()
            os._exit(1)
        try:
            bpy.ops.wm.quit_blender()
        except RuntimeError:  # the preview of a material is being rendered
            return seconds
        return None

    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.system.viewport_aa = "OFF"  # else each change draws a viewport many times, by software here
    shlight_blender.register()
    bpy.app.timers.register(step, first_interval=0.5, persistent=True)
