# SPDX-License-Identifier: GPL-3.0-or-later
"""What windows say of a picture while it is rendered."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

# Share of what is shaded that may be over the tolerance without a word.
SILENT_SHARE = 0.03


def status_of(report: Any) -> str:
    """A line about a picture as it stands; report: its shlight.RenderReport."""
    noise = f"Noise {report.noise:.4f} | " if report.passes > 0 and report.noise > 0.0 else ""
    left = f"Remaining {timedelta(seconds=round(report.seconds_left))}" if report.seconds_left > 0.0 else ""
    return f"Pass {report.passes + 1} | {noise}{left}".removesuffix(" | ")


def inexact_light(report: Any) -> str:
    """A line about a picture whose light is often less exact than was asked for; empty where it is not."""
    share = report.over_tolerance
    return f"{share:.0%} of it may be less exact than Tolerance asks for" if share > SILENT_SHARE else ""
