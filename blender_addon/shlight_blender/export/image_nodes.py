# SPDX-License-Identifier: GPL-3.0-or-later
"""Image Texture nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from shlight import nodes
from shlight.nodes import Color, Value

from .expressions import NodeInputs
from .pictures import linear_from_srgb

_textures: dict[Any, Any] = {}


def image_texture(inputs: NodeInputs) -> Color | Value:
    node = inputs.node
    place = inputs.vector("Vector") if inputs.is_linked("Vector") else nodes.uv("")
    image = node.image
    key = (image and image.name, node.interpolation, node.extension)
    if image is None:
        return Color(0.0, 0.0, 0.0)
    if key not in _textures:
        width, height = image.size
        if width < 1:
            inputs.remark("missing image")
            return Color(1.0, 0.0, 1.0)
        flat = np.empty(width * height * image.channels, dtype=np.float32)
        image.pixels.foreach_get(flat)
        pixels = flat.reshape(height, width, image.channels)
        rgba = np.ones((height, width, 4), np.float32)
        rgba[..., : image.channels] = pixels
        if not image.is_float and image.colorspace_settings.name == "sRGB":
            rgba[..., :3] = linear_from_srgb(rgba[..., :3])
        _textures[key] = rgba[::-1]
    c = nodes.image(
        _textures[key],
        place,
        interpolation=node.interpolation.lower() if node.interpolation.lower() in ("closest", "cubic") else "linear",
        extension=node.extension.lower(),
    )
    return c.alpha if inputs.output.name == "Alpha" else c
