# SPDX-License-Identifier: GPL-3.0-or-later
"""The render that runs beside Blender's window, which has to end before a render engine is removed.

Blender frees the engines of all renders when a class of any engine is removed, and uses them until its job has ended,
after the last call of `RenderEngine.render`.
"""

from __future__ import annotations

import math
import threading
import time
from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import record
from .report import Effect
from .windows import redraw

ENGINE = "SHLIGHT"
LATEST_UNDO = 0.5  # seconds after the end of the render that it stops
LONGEST_WAIT = 30.0  # seconds; the longest part of an export that does not ask whether it is to end takes a few


class Renders:
    """Whether Blender's render job runs with this engine, and whether it is to end."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._thread: int | None = None
        self.broken_at = -math.inf  # when the last picture ended that Blender wanted no more of, by time.monotonic()
        self.stopped = ""  # the engine that is removed, for which renders end; empty: they run

    def begin(self) -> None:
        """The job has begun in this thread."""
        self._thread = threading.get_ident()

    @property
    def is_running(self) -> bool:
        return self._thread is not None

    def look(self) -> None:
        """Ends a job of whose end Blender has not told; called by the main thread while no operator renders."""
        if self.is_running and not bpy.app.is_job_running("RENDER"):
            self.end()

    def end(self) -> None:
        """The job has ended."""
        with self._changed:
            self._thread = None
            self._changed.notify_all()

    def stop(self, removed: str) -> bool:
        """Ends the job, and keeps others from running until `resume`; False if it does not end.

        removed: the engine that is removed, by its name for users.
        """
        with self._changed:
            self.stopped = removed
            if self._thread == threading.get_ident():
                return False
            if not bpy.app.is_job_running("RENDER"):
                return True
            return self._changed.wait_for(lambda: self._thread is None, LONGEST_WAIT)

    def resume(self) -> None:
        self.stopped = ""


renders = Renders()


@persistent
def _note_begin(scene: Any, *_: Any) -> None:
    if scene.render.engine == ENGINE:
        renders.begin()


@persistent
def _note_end(*_: Any) -> None:
    renders.end()
    redraw("PROPERTIES")


@persistent
def _note_undo(*_: Any) -> None:
    """Blender has stopped the render before, as if Esc had been pressed, and says nothing of it."""
    if time.monotonic() - renders.broken_at < LATEST_UNDO:
        record.last.report.add("Render", "an undo or redo has stopped it; its picture is unfinished", Effect.LIGHT)


@persistent
def _note_file(*_: Any) -> None:
    record.forget()


def _stop_for(cls: Any) -> None:
    """Blender calls a class's `unregister` before it removes it."""
    if not renders.stopped:
        renders.stop(cls.bl_label or cls.bl_idname)
        renders.resume()


HANDLERS = {
    "render_init": _note_begin,
    "render_complete": _note_end,
    "render_cancel": _note_end,
    "undo_pre": _note_undo,
    "redo_pre": _note_undo,
    "load_post": _note_file,
}


def register() -> None:
    """Watches for renders, for engines that are removed, and for files that are opened."""
    renders.resume()
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)
    bpy.types.RenderEngine.unregister = classmethod(_stop_for)


def unregister() -> None:
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    del bpy.types.RenderEngine.unregister
