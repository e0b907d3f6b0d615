# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of image datablocks as textures of the core, kept from export to export while nothing changes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from shlight import _core, images
from shlight.nodes.textures import texture_pixels

# Names of colour spaces whose bytes stand for linear light, or are no colours.
LINEAR_SPACES = {"Non-Color", "Raw", "Linear", "Linear Rec.709"}
KEPT_EXPORTS = 2  # textures that so many exports have not asked for are dropped


class TextureCache:
    """Textures by what their pixels depend on."""

    def __init__(self) -> None:
        self._textures: dict[tuple[Any, ...], tuple[_core.TexturePixels, int]] = {}
        self._export = 0

    def begin_export(self) -> None:
        """Drops what has not been asked for lately."""
        self._export += 1
        limit = self._export - KEPT_EXPORTS
        self._textures = {key: entry for key, entry in self._textures.items() if entry[1] >= limit}

    def clear(self) -> None:
        """Drops everything."""
        self._textures.clear()

    def get(self, key: tuple[Any, ...], read: Any) -> _core.TexturePixels | None:
        """The texture of this key; `read()` makes its (pixels, encoding), or None if there are none."""
        if key not in self._textures:
            made = read()
            if made is None:
                return None
            self._textures[key] = (texture_pixels(*made), self._export)
        texture = self._textures[key][0]
        self._textures[key] = (texture, self._export)
        return texture

    @property
    def size_in_bytes(self) -> int:
        """Memory that the textures take."""
        return sum(texture.size_in_bytes for texture, _ in self._textures.values())


TEXTURES = TextureCache()


def is_data(image: Any) -> bool:
    """True if its numbers are no colours."""
    return image.colorspace_settings.name in ("Non-Color", "Raw")


def associates_alpha(image: Any) -> bool:
    """True if Cycles multiplies its colours with alpha."""
    return not is_data(image) and image.alpha_mode not in ("CHANNEL_PACKED", "NONE")


def encoding_of(image: Any, *, as_normals: bool) -> str:
    """How the core is to read its numbers."""
    if as_normals:
        return "normal"
    encoded = not image.is_float and image.colorspace_settings.name not in LINEAR_SPACES
    return "srgb" if encoded else "linear"


def datablock_texture(image: Any, *, as_normals: bool) -> _core.TexturePixels | None:
    """The texture of an image with one picture; None if it has no pixels."""
    width, height = image.size
    if width < 1 or height < 1:
        return None
    generated = (image.generated_type, *image.generated_color) if image.source == "GENERATED" else ()
    key = (
        *(image.as_pointer(), image.name_full, width, height, image.channels, image.is_float, image.source, generated),
        *(image.colorspace_settings.name, image.alpha_mode, as_normals, *_stamp(image)),
    )
    if image.is_dirty:
        key = (*key, TEXTURES._export)  # painted pixels have no stamp
    return TEXTURES.get(key, lambda: (_pixels(image), encoding_of(image, as_normals=as_normals)))


def file_texture(image: Any, path: str, *, as_normals: bool) -> _core.TexturePixels | None:
    """The texture of a file that belongs to an image with several; None if it cannot be read."""
    try:
        stamp = Path(path).stat().st_mtime_ns
        key = (path, stamp, image.colorspace_settings.name, image.alpha_mode, as_normals)
        return TEXTURES.get(key, lambda: _file_pixels(image, path, as_normals))
    except (OSError, ValueError):
        return None


def _stamp(image: Any) -> tuple[Any, ...]:
    if image.packed_file is not None:
        return ("packed", image.packed_file.size)
    path = bpy.path.abspath(image.filepath, library=image.library) if image.filepath else ""
    try:
        return (path, Path(path).stat().st_mtime_ns)
    except OSError:
        return (path,)


def _pixels(image: Any) -> NDArray[Any]:
    """(height, width, channels) of uint8 or float32, row 0 on top."""
    width, height = image.size
    channels = int(image.channels)
    flat = np.empty(width * height * channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    pixels: NDArray[Any] = flat.reshape(height, width, channels)[::-1]
    if not image.is_float:
        pixels = np.rint(np.clip(pixels, 0.0, 1.0) * 255.0).astype(np.uint8)
    return _with_alpha(image, pixels, straight=not image.is_float)


def _file_pixels(image: Any, path: str, as_normals: bool) -> tuple[NDArray[Any], str]:
    pixels = images.read_texture(path)
    encoded = pixels.dtype == np.uint8 and image.colorspace_settings.name not in LINEAR_SPACES
    encoding = "normal" if as_normals else "srgb" if encoded else "linear"
    return _with_alpha(image, pixels, straight=False), encoding  # OpenImageIO has multiplied it with alpha


def _with_alpha(image: Any, pixels: NDArray[Any], *, straight: bool) -> NDArray[Any]:
    """Colours times alpha where Cycles takes them so; as few channels as say the same."""
    channels = pixels.shape[2]
    if channels == 2:
        pixels = pixels[..., :1]
    if channels != 4:
        return pixels[..., :3]
    opaque = 255 if pixels.dtype == np.uint8 else 1.0
    if image.alpha_mode == "NONE" or (pixels[..., 3] == opaque).all():
        return pixels[..., :3]
    if not (straight and associates_alpha(image) and image.alpha_mode == "STRAIGHT"):
        return pixels
    alpha = pixels[..., 3:]
    if pixels.dtype == np.uint8:  # Cycles rounds the product of bytes down
        color = (pixels[..., :3].astype(np.uint16) * alpha // 255).astype(np.uint8)
    else:
        color = pixels[..., :3] * alpha
    return np.concatenate([color, alpha], axis=2)
