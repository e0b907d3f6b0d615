# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour spaces of pictures: sRGB and linear ones as the core reads them, others as Blender's OpenColorIO has them."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

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
    import OpenImageIO as oiio

    values = pixels.astype(np.float32)
    if np.issubdtype(pixels.dtype, np.integer):
        values /= np.iinfo(pixels.dtype).max
    if pixels.shape[2] == 1:
        values = np.repeat(values, 3, axis=2)
    source = oiio.ImageBuf(np.ascontiguousarray(values))
    return np.asarray(_converted(source, space).get_pixels(oiio.FLOAT), dtype=np.float32)


def _converted(source: Any, space: str) -> Any:
    import OpenImageIO as oiio

    return oiio.ImageBufAlgo.colorconvert(source, space, "scene_linear", unpremult=True, colorconfig=_configuration())
