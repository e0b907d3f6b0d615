# SPDX-License-Identifier: MIT
"""Pictures that are looked up at texture coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np

from shlight import _core
from shlight.nodes.inputs import uv
from shlight.nodes.values import Color, Vector, below, right, steps

INTERPOLATIONS = ("closest", "linear", "cubic")
EXTENSIONS = ("repeat", "extend", "clip", "mirror")


def image(
    pixels: Any, place: Vector | None = None, *, interpolation: str = "linear", extension: str = "repeat"
) -> Color:
    """The colour of a picture, filtered by how far texture coordinates move from pixel to pixel of the render.

    pixels: (height, width, 4) linear RGBA, row 0 on top.
    place: (u, v), (0, 0) at the lower left corner; None: `uv()`.
    """
    where = uv() if place is None else place
    rgba = np.ascontiguousarray(np.asarray(pixels, dtype=np.float32)[::-1])
    texture = _core.image_texture(rgba, INTERPOLATIONS.index(interpolation), EXTENSIONS.index(extension))
    u, v = where.x, where.y
    return Color(*steps("image", u, v, right(u), right(v), below(u), below(v), data=texture))
