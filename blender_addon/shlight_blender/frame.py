# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels to render: resolution and render border."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


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
