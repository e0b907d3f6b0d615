# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels to render: resolution and render border."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

# Memory that a picture takes at most while it is rendered, by the renderer, Blender, and the copies between them.
BYTES_PER_PIXEL = 160
MEMORY_INFO = Path("/proc/meminfo")


@dataclass(frozen=True)
class Frame:
    """The picture in pixels and the part of it to render; pixel coordinates count from the lower left corner."""

    full_width: int
    full_height: int
    left: int
    bottom: int
    right: int
    top: int

    @property
    def width(self) -> int:
        """Width of the part to render."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Height of the part to render."""
        return self.top - self.bottom

    @property
    def corners(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """The lower left and the upper right corner of the part to render."""
        return (self.left, self.bottom), (self.right, self.top)


def whole_frame(width: int, height: int) -> Frame:
    """The frame of a picture rendered as a whole."""
    return Frame(width, height, 0, 0, width, height)


def frame_of(render: Any) -> Frame:
    """The frame of `scene.render`: resolution, percentage and render border, rounded as Blender rounds them."""
    width = max(render.resolution_x * render.resolution_percentage // 100, 1)
    height = max(render.resolution_y * render.resolution_percentage // 100, 1)
    if not render.use_border:
        return whole_frame(width, height)
    # Blender multiplies in single precision and cuts off.
    left, right = (int(np.float32(x) * np.float32(width)) for x in (render.border_min_x, render.border_max_x))
    bottom, top = (int(np.float32(y) * np.float32(height)) for y in (render.border_min_y, render.border_max_y))
    if right <= left or top <= bottom:
        return whole_frame(width, height)
    return Frame(width, height, left, bottom, right, top)


def memory_problem(frame: Frame) -> str:
    """Why the memory that is free does not hold the picture while it is rendered; empty if it does, or who knows."""
    needed, free = BYTES_PER_PIXEL * frame.width * frame.height, _free_memory()
    if needed <= free:
        return ""
    return (
        f"a picture of {frame.width} × {frame.height} pixels takes about {needed / 1e9:.1f} GB of memory to render, "
        f"and {free / 1e9:.1f} GB are free; render it in parts (Output Properties > Render Region) or with fewer pixels"
    )


def _free_memory() -> float:
    """Bytes that Linux can give without taking them from other programs; elsewhere infinite."""
    try:
        lines = MEMORY_INFO.read_text(encoding="ascii").splitlines()
    except OSError:
        return math.inf
    kilobytes = {name: float(rest.split()[0]) for name, _, rest in (line.partition(":") for line in lines)}
    return 1024.0 * (kilobytes["MemAvailable"] + kilobytes["SwapFree"])
