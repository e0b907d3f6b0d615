# SPDX-License-Identifier: GPL-3.0-or-later
"""What a worker renders and compares."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Request:
    """The scene to render and its settings; None keeps the scene's value."""

    scene: str  # a file
    lights: list[str] | None = None  # names of the lamps that shine
    size: tuple[int, int] | None = None
    frame: int | None = None
    samples: int  # of the reference, at most
    reference_seconds: float  # for the reference; 0: as long as the samples take, in the panel none
    noise: float = 0.0  # relMSE of the reference's own noise at which it ends
    threads: int = 0  # 0: all
    denoise: bool = False  # Cycles' picture of shlight's time
    order: str | None = None
    tolerance: float | None = None
    pixel_samples: int | None = None
    shadow_rays: int | None = None
    max_bounces: int | None = None  # of both
    # The panel sets these; `scene` is its copy of the file.
    scene_name: str = ""
    view_layer: str = ""
    use_scripts: bool = False  # of the file
    images: dict[str, str] = field(default_factory=dict)  # see other_blender.save_unsaved_images

    def to_data(self) -> dict[str, Any]:
        """The request as plain data."""
        return asdict(self)

    @staticmethod
    def from_data(data: dict[str, Any]) -> Request:
        """The request of data that went through JSON, which knows no tuples."""
        return Request(**data | {"size": data["size"] and tuple(data["size"])})
