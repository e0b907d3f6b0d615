# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of image datablocks: as textures of the core, kept while nothing changes them, and as light.

sRGB and linear colours are read by the core, others as Blender's OpenColorIO has them.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import bpy
import numpy as np
from numpy.typing import NDArray

from shlight import _core, images
from shlight.nodes.textures import texture_pixels

from ..compat import pixels_of
from ..names import name_of

SRGB = "sRGB"
# Colour spaces whose numbers are linear light, or not colours.
LINEAR_SPACES = {"Non-Color", "Raw", "Linear", "Linear Rec.709"}


@cache
def _configuration() -> str:
    """The file that names this Blender's colour spaces."""
    own = Path(bpy.utils.system_resource("DATAFILES")) / "colormanagement" / "config.ocio"
    return os.environ.get("OCIO") or str(own)


def needs_conversion(space: str) -> bool:
    """True for a space that the core does not read itself."""
    return space != SRGB and space not in LINEAR_SPACES


@cache
def is_known(space: str) -> bool:
    """True if pixels of a space can be read as light; others than sRGB and linear ones need OpenImageIO."""
    if not needs_conversion(space):
        return True
    try:
        import OpenImageIO as oiio
    except ImportError:
        return False
    probe = oiio.ImageBuf(np.zeros((1, 1, 3), dtype=np.float32))
    return not _converted(probe, space).has_error


def linear_light(pixels: NDArray[Any], space: str) -> NDArray[np.float32]:
    """Pixels (height, width, 1, 3 or 4) of integers for 0 … 1 or floats in a known space, as linear light times alpha.

    Colours are divided by alpha while they are converted, as in Cycles.
    """
    values = pixels.astype(np.float32)
    if np.issubdtype(pixels.dtype, np.integer):
        values /= np.iinfo(pixels.dtype).max
    if pixels.shape[2] == 1:
        values = np.repeat(values, 3, axis=2)
    if space in LINEAR_SPACES:
        return np.ascontiguousarray(values)
    import OpenImageIO as oiio

    source = oiio.ImageBuf(np.ascontiguousarray(values))
    return np.asarray(_converted(source, space).get_pixels(oiio.FLOAT), dtype=np.float32)


def _converted(source: Any, space: str) -> Any:
    import OpenImageIO as oiio

    return oiio.ImageBufAlgo.colorconvert(source, space, "scene_linear", unpremult=True, colorconfig=_configuration())


# Files that are read at a time; each takes memory for its pixels twice.
MOST_READERS = 4
KEPT_EXPORTS = 2  # textures that so many exports have not asked for are dropped


Texture: TypeAlias = "_core.TexturePixels | Future[_core.TexturePixels]"


@cache
def missing_texture(black: bool) -> _core.TexturePixels:
    """The pixel that Cycles shows in place of a picture: magenta, or black without alpha."""
    return texture_pixels(np.array([[(0.0, 0.0, 0.0, 0.0) if black else (1.0, 0.0, 1.0, 1.0)]], dtype=np.float32))


class TextureCache:
    """Textures by what their pixels depend on. Viewports and final renders ask from threads of their own."""

    def __init__(self) -> None:
        self._textures: dict[tuple[Any, ...], tuple[Texture, int]] = {}
        self._export = 0
        self._readers = ThreadPoolExecutor(MOST_READERS, thread_name_prefix="shlight textures")
        self._asked: set[str] = set()  # files of this export
        self._broken: set[str] = set()

    def begin_export(self) -> None:
        """Drops what has not been asked for lately."""
        self._export += 1
        self._asked.clear()
        limit = self._export - KEPT_EXPORTS
        self._textures = {key: entry for key, entry in list(self._textures.items()) if entry[1] >= limit}

    def get(self, key: tuple[Any, ...], make: Callable[[], Texture | None]) -> Texture | None:
        """The texture of this key; `make()` makes it, or None."""
        texture = self._textures[key][0] if key in self._textures else make()
        if texture is not None:
            self._textures[key] = (texture, self._export)
        return texture

    def from_file(self, key: tuple[Any, ...], path: str, make: Callable[[], _core.TexturePixels]) -> Texture | None:
        """The texture of this key, which `make()` makes of a file while others are read; magenta if that fails."""

        def made() -> _core.TexturePixels:
            try:
                texture = make()
            except (OSError, ValueError):
                self._broken.add(path)
                return missing_texture(False)
            self._broken.discard(path)
            return texture

        self._asked.add(path)
        return self.get(key, lambda: self._readers.submit(made))

    @property
    def unreadable(self) -> list[str]:
        """Files of this export that turned out to be broken; complete when all its programs are made."""
        return sorted(self._asked & self._broken)

    @property
    def size_in_bytes(self) -> int:
        """Memory that the textures take."""
        textures = (own.result() if isinstance(own, Future) else own for own, _ in list(self._textures.values()))
        return sum(texture.size_in_bytes for texture in textures)


TEXTURES = TextureCache()


def associates_alpha(image: Any) -> bool:
    """True if Cycles multiplies its colours with alpha."""
    is_data = image.colorspace_settings.name in ("Non-Color", "Raw")
    return not is_data and image.alpha_mode not in ("CHANNEL_PACKED", "NONE")


def space_of(image: Any) -> str:
    """The colour space of its numbers; one that nothing is known of is taken for sRGB."""
    space = str(image.colorspace_settings.name)
    return space if is_known(space) else SRGB


class TextureUse(NamedTuple):
    """The settings of a node that affect how its picture looks from afar."""

    interpolation: str  # see shlight.nodes.image
    extension: str  # likewise


def _texture(pixels: NDArray[Any], space: str, use: TextureUse) -> _core.TexturePixels:
    encoding = "srgb" if space == SRGB else "linear"
    if needs_conversion(space):
        pixels = linear_light(pixels, space)
    return texture_pixels(pixels, encoding, use.interpolation, use.extension)


def datablock_texture(image: Any, use: TextureUse) -> Texture | None:
    """The texture of an image with one picture; None if it has no pixels."""
    width, height = image.size
    if width < 1 or height < 1:
        return None
    generated = (image.generated_type, *image.generated_color) if image.source == "GENERATED" else ()
    shape = (width, height, image.channels, image.is_float, image.source, generated)
    meaning = (image.colorspace_settings.name, image.alpha_mode, use)
    key = (image.as_pointer(), name_of(image, "name_full"), *shape, *meaning, *_stamp(image))
    if image.is_dirty:
        key = (*key, TEXTURES._export)  # painted pixels have no stamp
    space = "Linear" if image.is_float else space_of(image)  # Blender keeps floats as linear light
    return TEXTURES.get(key, lambda: _texture(_pixels(image), space, use))


def file_texture(image: Any, path: str, use: TextureUse) -> Texture | None:
    """The texture of a file that belongs to an image, being read; None if it is missing or of an unknown format, or if
    there is no OpenImageIO."""
    path = bpy.path.abspath(path, library=image.library)
    try:
        stamp = Path(path).stat().st_mtime_ns
        images.check_texture(path)
    except (ImportError, OSError, ValueError):
        return None
    space, associate, mode = settings = space_of(image), associates_alpha(image), image.alpha_mode

    def read() -> _core.TexturePixels:
        pixels = images.read_texture(path, associate=False)
        return _texture(_with_alpha(pixels, associate=associate, mode=mode), space, use)

    return TEXTURES.from_file((path, stamp, settings, use), path, read)


def has_plain_file(image: Any) -> bool:
    """True if its pixels are those of one file."""
    return image.source == "FILE" and image.packed_file is None and bool(image.filepath) and not image.is_dirty


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
    pixels: NDArray[Any] = pixels_of(image)
    if not image.is_float:
        pixels = np.rint(np.clip(pixels, 0.0, 1.0) * 255.0).astype(np.uint8)
    return _with_alpha(pixels, associate=associates_alpha(image) and not image.is_float, mode=image.alpha_mode)


def _with_alpha(pixels: NDArray[Any], *, associate: bool, mode: str) -> NDArray[Any]:
    """Colours times alpha where Cycles takes them so; as few channels as say the same."""
    channels = pixels.shape[2]
    if channels == 2:
        pixels = pixels[..., :1]
    if channels != 4:
        return pixels[..., :3]
    counts = np.issubdtype(pixels.dtype, np.integer)
    opaque = np.iinfo(pixels.dtype).max if counts else 1.0
    if mode == "NONE" or (pixels[..., 3] == opaque).all():
        return pixels[..., :3]
    if not (associate and mode == "STRAIGHT"):
        return pixels
    alpha = pixels[..., 3:]
    if counts:  # Cycles rounds the product of integers down
        color = (pixels[..., :3].astype(np.uint32) * alpha // opaque).astype(pixels.dtype)
    else:
        color = pixels[..., :3] * alpha
    return np.concatenate([color, alpha], axis=2)


# The brightest that a half float holds; what is infinite becomes this.
BRIGHTEST = 65504.0


def linear_pixels(image: Any) -> NDArray[np.float32] | None:
    """Pixels (height, width, 3) with row 0 on top; None for an image without data.

    Blender keeps floats as linear light, whatever their file has; bytes are in the image's colour space.
    """
    pixels = _pixels(image)
    if not pixels.size:
        return None
    light = linear_light(pixels[..., :3], "Linear" if image.is_float else space_of(image))
    return np.nan_to_num(light, posinf=BRIGHTEST, neginf=-BRIGHTEST)
