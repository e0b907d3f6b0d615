# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene is rendered with."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class RenderOptions:
    """The scene to render and its settings; None keeps the scene's value."""

    scene: str  # a file
    lights: list[str] | None = None  # names of the lamps that shine
    size: tuple[int, int] | None = None
    frame: int | None = None
    samples: int  # of the reference, at most
    reference_seconds: float  # for the reference; 0: as long as the samples take
    threads: int = 0  # 0: all
    denoise: bool = False  # Cycles' picture of shlight's time
    order: str | None = None
    tolerance: float | None = None
    pixel_samples: int | None = None
    shadow_rays: int | None = None
    max_bounces: int | None = None  # of both

    def to_data(self) -> dict[str, Any]:
        """The options as plain data."""
        return asdict(self)
