# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that AOV Output nodes give to passes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from shlight.nodes import Shader

from ..compat import aov_name
from .surface import ShaderInputs, ShaderReader


def with_aovs(shader: Shader, reader: ShaderReader, tree: Any) -> Shader:
    """A shader with what the nodes of its tree give to the AOVs that are asked for."""
    wanted = reader.surroundings.passes.aovs
    aovs = {}
    for node, groups in _outputs(tree):
        kind = wanted.get(aov_name(node))
        if kind is not None:
            inputs = ShaderInputs(reader, node, None, groups)
            aovs[aov_name(node)] = inputs.number("Value") if kind == "VALUE" else inputs.color("Color")
    return shader.with_aovs(aovs) if aovs else shader


def _outputs(tree: Any, groups: tuple[Any, ...] = ()) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """AOV Output nodes of a tree and its groups, with the groups entered on the way."""
    for node in tree.nodes:
        if node.mute:
            continue
        if node.type == "OUTPUT_AOV":
            yield node, groups
        elif node.type == "GROUP" and node.node_tree is not None:
            yield from _outputs(node.node_tree, (*groups, node))
