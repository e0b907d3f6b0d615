# SPDX-License-Identifier: GPL-3.0-or-later
"""Image datablocks as linear radiance."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

# The brightest that a half float holds; what is infinite becomes this.
BRIGHTEST = 65504.0


def linear_from_srgb(encoded: NDArray[Any]) -> NDArray[Any]:
    """The light that values encoded as sRGB stand for."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def linear_pixels(image: Any) -> NDArray[np.float32] | None:
    """Pixels (height, width, 3) with row 0 on top, never negative; None for an image without data.

    Blender keeps floats as linear light, whatever their file has; bytes may be encoded as sRGB.
    """
    width, height = image.size
    if width < 1 or height < 1:
        return None
    channels = int(image.channels)
    flat = np.empty(width * height * channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, channels)[::-1]
    rgb = pixels[..., :3] if channels >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    rgb = np.clip(np.nan_to_num(rgb, posinf=BRIGHTEST), 0.0, None)
    if not image.is_float and channels == 4 and image.alpha_mode == "STRAIGHT":
        rgb = rgb * pixels[..., 3:]  # before the colour space is undone, as Cycles does
    encoded = not image.is_float and image.colorspace_settings.name == "sRGB"
    return np.ascontiguousarray(linear_from_srgb(rgb) if encoded else rgb, dtype=np.float32)
