# SPDX-License-Identifier: MIT
"""Pictures of models, as Pillow has read them, as textures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.images import decoded_srgb
from shlight.models.parts import Floats
from shlight.nodes.values import Color, Vector


class Pictures:
    """Pictures of one file; each is kept once in each way of looking it up."""

    def __init__(self) -> None:
        self._kept: dict[tuple[Any, ...], Any] = {}
        self._read: dict[int, tuple[Any, NDArray[Any]]] = {}  # with the picture, whose id must not be given to another

    def image(
        self, picture: Any, place: Vector | None, encoding: str, interpolation: str, extension: str
    ) -> tuple[Color, Floats]:
        """A picture of Pillow as an expression with its alpha, not multiplied with it, and the mean of its pixels."""
        pixels = self._pixels(picture)
        rgb = pixels[..., :3]
        made = self._looked_up(picture, "rgb", rgb, place, encoding, interpolation, extension)
        if pixels.shape[2] == 4 and (pixels[..., 3] != np.iinfo(pixels.dtype).max).any():
            alpha = self._looked_up(picture, "alpha", pixels[..., 3], place, "linear", interpolation, extension)
            made = Color(made.x, made.y, made.z, alpha.x)
        values = decoded_srgb(rgb) if encoding == "srgb" else rgb / np.iinfo(rgb.dtype).max
        return made, np.broadcast_to(values, (*values.shape[:2], 3)).mean(axis=(0, 1))

    def _looked_up(self, picture: Any, part: str, pixels: NDArray[Any], place: Vector | None, *way: str) -> Color:
        key = (id(picture), part, *way)
        if key not in self._kept:
            encoding, interpolation, extension = way
            self._kept[key] = nodes.textures.texture_pixels(pixels, encoding, interpolation, extension)
        return nodes.image(self._kept[key], place, interpolation=way[1], extension=way[2])

    def _pixels(self, picture: Any) -> NDArray[Any]:
        """(height, width, 1, 3 or 4) of uint8 or uint16."""
        if id(picture) not in self._read:
            mode = picture.mode
            if mode not in ("L", "RGB", "RGBA", "I;16"):
                has_alpha = "A" in mode or "transparency" in picture.info
                mode = "RGBA" if has_alpha else "RGB"
            array = np.asarray(picture if picture.mode == mode else picture.convert(mode))
            self._read[id(picture)] = picture, np.atleast_3d(array)
        return self._read[id(picture)][1]
