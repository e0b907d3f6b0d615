# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the comparison: `window_manager.shlight_compare`, which Blender keeps until it ends."""

from __future__ import annotations

from typing import Any

import bpy

from . import results

DENOISE: dict[str, Any] = {
    "name": "Denoise",
    "description": "Cycles denoises its picture, which counts as its time",
    "default": False,
}
REFERENCE_SECONDS: dict[str, Any] = {
    "name": "Reference",
    "description": "Time for a reference, which Cycles renders. At 0 there is none",
    "default": 0.0,
    "min": 0.0,
    "soft_max": 600.0,
    "unit": "TIME_ABSOLUTE",
    "step": 100,
}


def _move_split(settings: Any, context: Any) -> None:
    results.show_split(settings.split)


class SHLIGHT_CompareSettings(bpy.types.PropertyGroup):
    """Settings of the comparison, and the position of the split."""

    denoise: bpy.props.BoolProperty(**DENOISE)
    reference_seconds: bpy.props.FloatProperty(**REFERENCE_SECONDS)
    split: bpy.props.FloatProperty(
        name="Split",
        description="Share of the width that shows shlight's picture; the rest shows Cycles'",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_move_split,
    )
