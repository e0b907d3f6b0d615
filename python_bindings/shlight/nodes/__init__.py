# SPDX-License-Identifier: MIT
"""Numbers and colours that vary over a surface, and materials made of them.

What these functions return stands where a constant stood: `Bsdf.lambert(nodes.image(pixels))`.
"""

from shlight.nodes.inputs import (
    attribute,
    backfacing,
    barycentric,
    geometric_normal,
    normal,
    object_value,
    position,
    towards_viewer,
    uv,
)
from shlight.nodes import values
from shlight.nodes.principled import glossy, oren_nayar, principled, reflecting_normal, rising_lobes
from shlight.nodes.shader import Shader, emission, ggx, lambert, mix, transparent
from shlight.nodes.textures import image
from shlight.nodes.values import Color, Value, Vector

__all__ = [
    "Color",
    "Shader",
    "Value",
    "Vector",
    "attribute",
    "backfacing",
    "barycentric",
    "emission",
    "geometric_normal",
    "ggx",
    "glossy",
    "image",
    "lambert",
    "mix",
    "normal",
    "object_value",
    "oren_nayar",
    "position",
    "principled",
    "reflecting_normal",
    "rising_lobes",
    "towards_viewer",
    "transparent",
    "uv",
    "values",
]
