# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of textures that are made of cells."""

from __future__ import annotations

from shlight import nodes

from ..compat import CELLS
from .mesh_attributes import GENERATED
from .nodes import Expression, NodeInputs, ReadNode

# Inputs of a Voronoi Texture node, which are arguments of `nodes.voronoi`. In Blender 3.4 the octaves' are missing.
VORONOI_NUMBERS = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")


def _voronoi(inputs: NodeInputs) -> Expression:
    node = inputs.node
    found = nodes.voronoi(
        inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        dimensions=int(node.voronoi_dimensions[0]),
        feature=node.feature.lower(),
        metric=node.distance.lower(),
        normalize=getattr(node, "normalize", False),
        definition=CELLS,
        **{name.lower(): inputs.number(name) for name in VORONOI_NUMBERS},
    )
    outputs: dict[str, Expression] = {"Color": found.color, "Position": found.position, "W": found.w}
    return outputs.get(inputs.output.identifier, found.distance)


def _gabor(inputs: NodeInputs) -> Expression:
    dimensions = int(inputs.node.gabor_type[0])
    found = nodes.gabor(
        inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        dimensions=dimensions,
        scale=inputs.number("Scale"),
        frequency=inputs.number("Frequency"),
        anisotropy=inputs.number("Anisotropy"),
        orientation=inputs.number("Orientation 2D") if dimensions == 2 else inputs.vector("Orientation 3D"),
    )
    outputs: dict[str, Expression] = {"Phase": found.phase, "Intensity": found.intensity}
    return outputs.get(inputs.output.identifier, found.value)


CELL_NODES: dict[str, ReadNode] = {
    "TEX_VORONOI": _voronoi,
    "TEX_GABOR": _gabor,
}
