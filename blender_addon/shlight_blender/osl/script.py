# SPDX-License-Identifier: GPL-3.0-or-later
"""shlight_direct.osl in Blender: compiled by Blender's own compiler, in a node group that all materials share."""

from __future__ import annotations

import hashlib
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import bpy

SOURCE = Path(__file__).with_name("shlight_direct.osl")
GROUP = "shlight Direct Light"
# The shader's inputs by the kind of their sockets; a vector of 0 stands for the surface's normal.
INPUTS = {
    "Color": "Color",
    "Roughness": "Float",
    "Normal": "Vector",
    "Lobe": "Int",
    "Center": "Vector",
    "Radius": "Float",
    "Intensity": "Color",
    "Is_Disk": "Int",
}
OUTPUT = "Light"


def has_osl() -> bool:
    """Whether Blender was built with Open Shading Language."""
    try:
        import _cycles
    except ImportError:
        return False
    return bool(getattr(_cycles, "with_osl", False))


@lru_cache(maxsize=1)
def bytecode() -> str:
    """The compiled shader. Raises RuntimeError if Blender's compiler refuses it."""
    import _cycles

    from .lobes import parameters

    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder, SOURCE.name), Path(folder, "shlight_direct.oso")
        source.write_bytes(SOURCE.read_bytes())
        Path(folder, "lobes.h").write_text(parameters())
        if not _cycles.osl_compile(str(source), str(result)):
            raise RuntimeError(f"Blender cannot compile {SOURCE.name}")
        return result.read_text()


def group() -> Any:
    """The file's node group of the shader, which is made where it is missing."""
    text = bytecode()
    digest = hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
    for tree in bpy.data.node_groups:
        if tree.get(GROUP) == digest:
            return tree
    tree = bpy.data.node_groups.new(GROUP, "ShaderNodeTree")
    tree[GROUP] = digest
    node, given, taken = (tree.nodes.new(name) for name in ("ShaderNodeScript", "NodeGroupInput", "NodeGroupOutput"))
    given.location.x, taken.location.x = -300, 300
    # A node with bytecode and without a text makes no sockets.
    node.bytecode, node.bytecode_hash = text, digest
    for name, kind in INPUTS.items():
        tree.interface.new_socket(name, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        tree.links.new(given.outputs[name], node.inputs.new(f"NodeSocket{kind}", name, identifier=name))
    tree.interface.new_socket(OUTPUT, in_out="OUTPUT", socket_type="NodeSocketShader")
    tree.links.new(node.outputs.new("NodeSocketShader", OUTPUT, identifier=OUTPUT), taken.inputs[OUTPUT])
    return tree
