# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the latest render of this process, for scripts and the preview: Blender itself keeps only pixels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass
class RenderRecord:
    """One render; empty where it did not come that far."""

    settings: dict[str, Any] = field(default_factory=dict)  # arguments of shlight.render
    messages: list[dict[str, object]] = field(default_factory=list)  # ExportReport.to_data()
    export_seconds: float = 0.0
    statistics: Any = None  # the report of shlight.render
    scene_error: str = ""  # why the scene cannot be rendered at all


last = RenderRecord()


def begin() -> RenderRecord:
    """Starts the record of a new render."""
    global last
    last = RenderRecord()
    return last
