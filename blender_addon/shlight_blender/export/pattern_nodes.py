# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of textures that are formulas."""

from __future__ import annotations

from shlight import nodes

from ..compat import MAGIC_WRAPS_SCALED
from .mesh_attributes import GENERATED
from .nodes import Expression, NodeInputs, ReadNode

BRICK_NUMBERS = ("Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")


def _brick(inputs: NodeInputs) -> Expression:
    node = inputs.node
    tint, mortar = nodes.bricks(
        inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        offset=node.offset,
        offset_frequency=node.offset_frequency,
        squash=node.squash,
        squash_frequency=node.squash_frequency,
        **{name.lower().replace(" ", "_"): inputs.number(name) for name in BRICK_NUMBERS},
    )
    if inputs.output.identifier == "Fac":
        return mortar
    first, second, between = (inputs.color(name) for name in ("Color1", "Color2", "Mortar"))
    return nodes.Color(*((first * (1.0 - tint) + second * tint) * (1.0 - mortar) + between * mortar))


def _magic(inputs: NodeInputs) -> Expression:
    found = nodes.magic(
        inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        scale=inputs.number("Scale"),
        distortion=inputs.number("Distortion"),
        depth=inputs.node.turbulence_depth,
        wraps_scaled=MAGIC_WRAPS_SCALED,
    )
    return (found.x + found.y + found.z) / 3.0 if inputs.output.identifier == "Fac" else found


PATTERN_NODES: dict[str, ReadNode] = {
    "TEX_BRICK": _brick,
    "TEX_MAGIC": _magic,
}
