# SPDX-License-Identifier: GPL-3.0-or-later
"""The IES Texture node."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from shlight import nodes
from shlight.nodes import Value
from shlight.nodes.inputs import normal_to_object

from ..compat import IES_KEEPS_EDGES
from ..report import Effect
from .nodes import NodeInputs

UNREADABLE = 100.0  # which Cycles takes for a file that it cannot read


def ies_texture(inputs: NodeInputs) -> Value:
    """Watts in a direction of the object's frame."""
    strength = inputs.number("Strength")
    direction = inputs.vector_or("Vector", normal_to_object(nodes.towards_viewer()))
    try:
        return nodes.ies(_text_of(inputs), direction, strength, keeps_edges=IES_KEEPS_EDGES)
    except (OSError, ValueError) as error:
        inputs.remark(f"its file cannot be read ({error}); {UNREADABLE:g} is used, as in Cycles", Effect.LIGHT)
        return strength * UNREADABLE


def _text_of(inputs: NodeInputs) -> str:
    node: Any = inputs.node
    if node.mode == "INTERNAL":
        return "" if node.ies is None else str(node.ies.as_string())
    path = bpy.path.abspath(node.filepath, library=node.id_data.library)
    return Path(path).read_text(encoding="latin-1")
