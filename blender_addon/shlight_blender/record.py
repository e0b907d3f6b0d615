# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the latest render of this process, for scripts and windows: Blender itself keeps only pixels."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any

from .names import name_of
from .report import ExportReport

# Share of what is shaded that may be over the tolerance without a word.
SILENT_SHARE = 0.03
LONG = 99.5  # seconds; longer times are told in minutes


def status_of(report: Any) -> str:
    """A line about a picture as it stands; report: its shlight.RenderReport."""
    taken, left = report.render_seconds, report.seconds_left
    if not left > 0.0:
        return "Rendering"
    words = f"{left:.0f} s" if left < LONG else str(timedelta(seconds=round(left)))
    return f"Rendering {taken / (taken + left):.0%}, {words} left"


def light_name(max_bounces: int) -> str:
    """Names what a picture shows."""
    return "direct light" if max_bounces == 0 else f"{max_bounces} bounce{'s' if max_bounces > 1 else ''}"


def inexact_light(report: Any) -> str:
    """A line about a picture whose light is often less exact than was asked for; empty where it is not."""
    share = report.over_tolerance
    return f"{share:.0%} of it may be less exact than Tolerance asks for" if share > SILENT_SHARE else ""


@dataclass
class RenderRecord:
    """One render; empty where it did not come that far. Times and statistics are those of its last view layer."""

    scene: str = ""  # its name
    settings: dict[str, Any] = field(default_factory=dict)  # arguments of shlight.render
    report: ExportReport = field(default_factory=ExportReport)  # of all view layers
    export_seconds: float = 0.0
    statistics: Any = None  # the report of shlight.render
    operations: dict[str, int] = field(default_factory=dict)  # for a hit on each material whose values vary
    texture_bytes: int = 0
    scene_error: str = ""  # why the scene cannot be rendered at all
    mix: Any = None  # a light_mix.LightMix of a picture of one view layer and one view, if the light mixer was on
    dark: str = ""  # why the picture of a view layer is black: the message that nothing gives light

    @property
    def messages(self) -> list[dict[str, object]]:
        """The report as plain data."""
        return self.report.to_data()

    def is_of(self, scene: Any) -> bool:
        """Whether it is of this scene."""
        return bool(self.scene == name_of(scene))


last = RenderRecord()
shown = last  # in the Report panel: of the latest render, or of a viewport after it


def begin(scene: Any) -> RenderRecord:
    """Starts the record of a new render."""
    global last, shown
    last = shown = RenderRecord(name_of(scene))
    return last


def show_viewport(scene: Any, exported: Any) -> None:
    """Shows what a viewport's `export.ExportedScene` says."""
    global shown
    bounces = {"max_bounces": int(scene.shlight.preview_max_bounces)}
    shown = RenderRecord(name_of(scene), settings=bounces, report=exported.report)


def forget() -> None:
    """Nothing is known any more, as of a file that is opened."""
    global last, shown
    last = shown = RenderRecord()
