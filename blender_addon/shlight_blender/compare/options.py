# SPDX-License-Identifier: GPL-3.0-or-later
"""What is compared."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..comparison.options import RenderOptions


@dataclass(frozen=True, kw_only=True)
class CompareOptions(RenderOptions):
    """A frame as F12 would render it; `scene`: the copy of the file. reference_seconds: 0 for no reference."""

    samples: int = 2**16
    scene_name: str
    view_layer: str
    use_scripts: bool = False  # of the file
    images: dict[str, str] = field(default_factory=dict)  # see other_blender.save_unsaved_images
