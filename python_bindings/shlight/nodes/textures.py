# SPDX-License-Identifier: MIT
"""Pictures that are looked up at texture coordinates."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import _core, images
from shlight._arrays import checked_name
from shlight.nodes.inputs import uv
from shlight.nodes.values import Color, Vector, below, operation, right, steps

INTERPOLATIONS = ("closest", "linear", "cubic")
EXTENSIONS = ("repeat", "extend", "clip", "mirror")
ENCODINGS = ("linear", "srgb")


def texture_pixels(
    pixels: Any,
    encoding: str = "linear",
    interpolation: str = "linear",
    extension: str = "repeat",
) -> _core.TexturePixels:
    """A picture made ready for lookups: with it, any number of `image` share its memory.

    pixels: (height, width) or (height, width, channels), of uint8 or uint16 for 0 … 1, of float16 or other numbers as
        they are, row 0 on top; 1, 3 or 4 channels: grey, RGB, or RGB times alpha and alpha. Or the path of a file.
    encoding: "linear" or "srgb".
    interpolation, extension: as `image` will be told; a picture seen from afar has the mean brightness of what it
        shows.
    Raises ValueError naming the argument.
    """
    number = ENCODINGS.index(checked_name("encoding", encoding, ENCODINGS))
    filtering = INTERPOLATIONS.index(checked_name("interpolation", interpolation, INTERPOLATIONS))
    beyond = EXTENSIONS.index(checked_name("extension", extension, EXTENSIONS))
    if isinstance(pixels, str | os.PathLike):
        pixels = images.read_texture(pixels)
    array: NDArray[Any] = np.asarray(pixels)
    if array.ndim == 2:
        array = array[..., None]
    if array.ndim != 3 or array.shape[2] not in (1, 3, 4) or array.size == 0:
        raise ValueError(f"pixels must have shape (height, width) or (height, width, 1, 3 or 4), got {array.shape}")
    if array.dtype not in (np.uint8, np.uint16, np.float16):
        array = array.astype(np.float32)
    return _core.texture_pixels(np.ascontiguousarray(array[::-1]), number, filtering, beyond)


@dataclass(frozen=True, eq=False)
class ImageLookup:
    """A picture and how it is looked up; made for the core when a program needs it."""

    tiles: list[tuple[int, int, _core.TexturePixels | Future[_core.TexturePixels]]]
    interpolation: int
    extension: int
    unassociate: bool
    tiled: bool

    @cached_property
    def core(self) -> _core.ImageTexture:
        """The core's object of this texture."""
        tiles = [(u, v, own.result() if isinstance(own, Future) else own) for u, v, own in self.tiles]
        return _core.image_texture(tiles, self.interpolation, self.extension, self.unassociate, self.tiled)


def image(
    pixels: Any,
    place: Vector | None = None,
    *,
    encoding: str = "linear",
    interpolation: str = "linear",
    extension: str = "repeat",
    unassociate: bool = False,
    closed: bool = False,
    filtered: bool = True,
) -> Color:
    """The colour of a picture, filtered by how far texture coordinates move from camera ray to camera ray.

    pixels: as of `texture_pixels`, or what that returns, or a Future of it, or a dict {(u, v): pixels} of pictures
        that cover u … u + 1 and v … v + 1 each (UDIM tiles).
    encoding: as of `texture_pixels`; unused where that has made the pixels.
    interpolation: "linear", "closest" or "cubic" (a B-spline) between texels.
    place: (u, v), (0, 0) at the lower left corner; None: `uv()`.
    unassociate: divide colours by alpha.
    closed: the picture goes around something, so that u jumps by 1 at a seam; the footprint there goes the short way.
    filtered: False for the place alone, where the picture is smooth and the coordinates are not.
    Raises ValueError naming the argument.

    >>> checks = np.array([[40, 220], [220, 40]], np.uint8)
    >>> color = nodes.image(checks, nodes.position() * 0.5, encoding="srgb", interpolation="closest")
    >>> shiny = shlight.Bsdf.principled(color, roughness=0.3)
    """
    filtering = INTERPOLATIONS.index(checked_name("interpolation", interpolation, INTERPOLATIONS))
    beyond = EXTENSIONS.index(checked_name("extension", extension, EXTENSIONS))
    tiled = isinstance(pixels, Mapping)

    def prepared(own: Any) -> Any:
        is_made = isinstance(own, _core.TexturePixels | Future)
        return own if is_made else texture_pixels(own, encoding, interpolation, extension)

    tiles = [(int(u), int(v), prepared(own)) for (u, v), own in (pixels if tiled else {(0, 0): pixels}).items()]
    texture = ImageLookup(tiles, filtering, beyond, unassociate, tiled)
    where = uv() if place is None else place
    u, v = where.x, where.y
    if not filtered:
        return Color(*steps("image", u, v, 0.0, 0.0, 0.0, 0.0, data=texture))
    along, down = right(u), below(u)
    if closed:
        along, down = (step - operation("floor", step + 0.5) for step in (along, down))
    return Color(*steps("image", u, v, along, right(v), down, below(v), data=texture))
