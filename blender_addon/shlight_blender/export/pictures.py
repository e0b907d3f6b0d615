# SPDX-License-Identifier: GPL-3.0-or-later
"""Image datablocks as linear radiance."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .color_spaces import LINEAR_SPACES, SRGB, is_known, linear_light

# The brightest that a half float holds; what is infinite becomes this.
BRIGHTEST = 65504.0


def linear_pixels(image: Any) -> NDArray[np.float32] | None:
    """Pixels (height, width, 3) with row 0 on top; None for an image without data.

    Blender keeps floats as linear light, whatever their file has; bytes are in the image's colour space.
    """
    width, height = image.size
    if width < 1 or height < 1:
        return None
    channels = int(image.channels)
    flat = np.empty(width * height * channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, channels)[::-1]
    rgb = pixels[..., :3] if channels >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    rgb = np.nan_to_num(rgb, posinf=BRIGHTEST, neginf=-BRIGHTEST)
    if not image.is_float and channels == 4 and image.alpha_mode == "STRAIGHT":
        rgb = rgb * pixels[..., 3:]  # before the colour space is undone, as Cycles does
    space = image.colorspace_settings.name
    if not image.is_float and space not in LINEAR_SPACES:
        rgb = linear_light(rgb, space if is_known(space) else SRGB)
    return np.ascontiguousarray(rgb, dtype=np.float32)
