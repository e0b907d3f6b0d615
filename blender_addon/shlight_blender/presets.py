# SPDX-License-Identifier: GPL-3.0-or-later
"""Draft, Preview and Final: settings of the scene that belong together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy


@dataclass(frozen=True)
class Preset:
    """Settings by name; those that it does not name have their defaults."""

    label: str
    description: str
    values: dict[str, Any] = field(default_factory=dict)


PRESETS = {
    "DRAFT": Preset(
        "Draft",
        "To see where light falls: some noise in penumbrae",
        {"noise_threshold": 0.05, "min_samples": 1, "max_samples": 16, "tolerance": 0.01},
    ),
    "PREVIEW": Preset("Preview", "What the eye does not tell from a converged picture"),
    "FINAL": Preset(
        "Final",
        "For pictures that are edited further: a fifth of the noise, and light to a ten-thousandth",
        {"noise_threshold": 0.002, "min_samples": 16, "max_samples": 4096, "tolerance": 1e-4},
    ),
}
NAMES = ("noise_threshold", "min_samples", "max_samples", "tolerance", "pixel_samples", "order", "shadow_rays")


def preset_values(settings: Any, name: str) -> dict[str, Any]:
    """All that a preset sets."""
    properties = settings.bl_rna.properties
    return {key: PRESETS[name].values.get(key, properties[key].default) for key in NAMES}


def is_set(settings: Any, name: str) -> bool:
    """Whether the scene's settings are those of a preset."""
    values = preset_values(settings, name)
    return all(
        abs(getattr(settings, key) - value) <= 1e-6 * abs(value)
        if isinstance(value, float)
        else getattr(settings, key) == value
        for key, value in values.items()
    )


class SHLIGHT_OT_use_preset(bpy.types.Operator):
    """Sets all of Sampling, Light and Shadows but the switches and the time limit."""

    bl_idname = "shlight.use_preset"
    bl_label = "Use Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    preset: bpy.props.EnumProperty(items=[(name, each.label, each.description) for name, each in PRESETS.items()])

    @classmethod
    def description(cls, context: Any, properties: Any) -> str:
        """The tooltip of a preset's button."""
        return PRESETS[properties.preset].description

    def execute(self, context: Any) -> set[str]:
        """Sets them."""
        for key, value in preset_values(context.scene.shlight, self.preset).items():
            setattr(context.scene.shlight, key, value)
        return {"FINISHED"}


def draw_presets(layout: Any, settings: Any) -> None:
    """A button for each; that of the scene's settings is pressed."""
    row = layout.row(align=True)
    for name, preset in PRESETS.items():
        button = row.operator(SHLIGHT_OT_use_preset.bl_idname, text=preset.label, depress=is_set(settings, name))
        button.preset = name
