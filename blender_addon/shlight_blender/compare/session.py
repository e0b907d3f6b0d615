# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison that runs, and what it has in Blender's windows meanwhile."""

from __future__ import annotations

from typing import Any

import bpy

from .job import Job


class Session:
    """At most one job at a time."""

    def __init__(self) -> None:
        self.job: Job | None = None
        self.ended_by = ""  # what ended the last one before its end
        self._timer: Any = None

    def watch(self, context: Any, seconds: float) -> None:
        """Has the window tick, and shows the state."""
        self._timer = context.window_manager.event_timer_add(seconds, window=context.window)
        self.show()

    def show(self) -> None:
        """Shows the state in the status bar and the panel."""
        text = None
        if self.job:
            stage = self.job.stage
            text = f"Compare with Cycles: {stage.name} ({stage.seconds:.0f} s)   Esc: cancel"
        for window in bpy.context.window_manager.windows:
            with bpy.context.temp_override(window=window):
                bpy.context.workspace.status_text_set(text)
            for area in window.screen.areas:
                if area.type in {"PROPERTIES", "IMAGE_EDITOR"}:
                    area.tag_redraw()

    def end(self, ended_by: str = "") -> None:
        """Ends the job, if there is one, and leaves nothing of it."""
        if self.job is None:
            return
        self.job.end()
        self.job, self.ended_by = None, ended_by
        if self._timer is not None:
            bpy.context.window_manager.event_timer_remove(self._timer)
            self._timer = None
            self.show()


session = Session()
