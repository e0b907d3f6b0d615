# SPDX-License-Identifier: MIT
"""Files of pictures, OpenEXR or PNG: written whole or by tiles, and known again by the hash in their header."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from shlight.farm.frames import PNG
from shlight.farm.pictures import Box, Picture, Rendered
from shlight.images import close_output, complete_or_absent, is_readable, opened_output, write_pixels

KEY = "shlight:key"
TILE = 64  # side of the file's tiles


def encode(picture: Picture, rendered: Rendered) -> bytes:
    """The file of a picture: 32-bit float OpenEXR, compressed without loss, or PNG. OSError if it cannot be made."""
    with tempfile.TemporaryDirectory(prefix="shlight-") as folder:
        path = Path(folder) / picture.path.with_stem("picture").name
        spec, pixels = _spec(picture, rendered), np.ascontiguousarray(rendered.pixels)
        write_pixels(picture.path, spec, pixels, _format(picture), path)
        return path.read_bytes()


def write(path: Path, data: bytes) -> None:
    """Puts a file in its place, whole or not at all."""
    with complete_or_absent(path) as temporary:
        temporary.write_bytes(data)


class TiledFile:
    """A picture that is written tile by tile, as they come, and appears under its name when all are there."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture
        self._missing = set(picture.boxes)
        self._stack = ExitStack()
        self._target: Any = None
        self._place = Path()

    def add(self, box: Box, tile: Rendered) -> bool:
        """Writes one; whether the file is complete with it. OSError leaves no file."""
        if self._target is None:
            spec = _spec(self._picture, tile)
            spec.tile_width = spec.tile_height = TILE
            spec.attribute("openexr:lineOrder", "randomY")  # else what comes early would be kept in memory
            path = self._picture.path
            self._place = self._stack.enter_context(complete_or_absent(path))
            self._target = opened_output(path, spec, _format(self._picture), self._place)
        left, top, right, bottom = box
        pixels = np.ascontiguousarray(tile.pixels, dtype=np.float32)
        if not self._target.write_tiles(left, right, top, bottom, 0, 1, pixels):
            raise OSError(f"{self._picture.path}: {self._target.geterror().strip()}")
        self._missing.discard(box)
        if self._missing:
            return False
        close_output(self._picture.path, self._target, self._place)
        self._stack.close()
        self._target = None
        return True

    def drop(self) -> None:
        """Leaves no file of one that is not complete."""
        if self._target is not None:
            self._target.close()
            self._stack.__exit__(OSError, OSError(), None)


def is_whole(picture: Picture) -> bool:
    """Whether its file is there, is of this scene and these settings, and can be read to its end."""
    import OpenImageIO as oiio

    if not picture.path.is_file():
        return False
    source = oiio.ImageInput.open(str(picture.path))
    if source is None:
        oiio.geterror()
        return False
    spec = source.spec()
    if spec.getattribute(KEY) != picture.key or (spec.width, spec.height) != picture.size:
        source.close()
        return False
    return is_readable(source)


def _spec(picture: Picture, rendered: Rendered) -> Any:
    import OpenImageIO as oiio

    is_png = picture.path.suffix == PNG
    spec = oiio.ImageSpec(*picture.size, len(rendered.channels), "uint8" if is_png else "float")
    spec.attribute("oiio:UnassociatedAlpha", int(is_png))
    spec.channelnames = rendered.channels
    # OpenImageIO would add the time; without it the same picture is the same file.
    fixed = {"compression": "zip", "DateTime": "1970:01:01 00:00:00", KEY: picture.key}
    for name, value in {**rendered.attributes, **fixed}.items():
        spec.attribute(name, value)
    return spec


def _format(picture: Picture) -> str:
    return picture.path.suffix.removeprefix(".") or "exr"
