# SPDX-License-Identifier: GPL-3.0-or-later
"""Script nodes, which hold or name a script of Open Shading Language that was compiled."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from shlight import nodes
from shlight.nodes import Shader
from shlight.nodes.oso import parse

from ..names import name_of
from .nodes import Expression, NodeInputs, ReadNode, own_value


def _runs_scripts(depsgraph: Any) -> bool:
    """Whether Cycles runs scripts in this scene; without a depsgraph there is no scene to ask."""
    scene = None if depsgraph is None else depsgraph.scene
    return scene is None or bool(getattr(getattr(scene, "cycles", None), "shading_system", True))


def _compiled(node: Any) -> str:
    """The text of the compiled script; "" without one. Beside an .osl file its .oso file is read."""
    if node.mode == "INTERNAL":
        return name_of(node, "bytecode")
    path = Path(bpy.path.abspath(name_of(node, "filepath"), library=node.id_data.library)).with_suffix(".oso")
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _script(inputs: NodeInputs) -> Expression | Shader:
    """The value of an output. Cycles passes what sockets hold, but for parameters that the script itself computes."""
    if not _runs_scripts(inputs.reader.surroundings.depsgraph):
        return own_value(inputs.asked)
    text = _compiled(inputs.node)
    if not text:
        inputs.remark("it has no compiled script")
        return Shader()
    try:
        parameters = {s.name: s for s in parse(text).symbols.values() if s.kind == "param" and s.length is None}
        given = {}
        for socket in inputs.node.inputs:
            symbol = parameters.get(socket.identifier)
            if symbol is None or not symbol.default:
                continue
            if inputs.is_linked(socket.identifier) or not symbol.is_initialized:
                asked = inputs.number if symbol.width == 1 else inputs.vector
                given[symbol.name] = asked(socket.identifier)
        found = nodes.osl(text, **given).get(inputs.output.identifier)
    except ValueError as error:
        inputs.remark(f"its {error}")
        return Shader()
    return Shader() if found is None else found


SCRIPT_NODES: dict[str, ReadNode] = {"SCRIPT": _script}
