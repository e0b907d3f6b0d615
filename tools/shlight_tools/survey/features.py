# SPDX-License-Identifier: MIT
"""Which kinds of light a scene uses that go through things: transmission, volume and subsurface."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from shlight_blender.compat import slot_materials, uses_nodes
from shlight_blender.export.nodes import all_nodes

FEATURES = ("transmission", "volume", "subsurface")
NODES = {
    "BSDF_GLASS": "transmission",
    "BSDF_REFRACTION": "transmission",
    "SUBSURFACE_SCATTERING": "subsurface",
    "PRINCIPLED_VOLUME": "volume",
    "VOLUME_ABSORPTION": "volume",
    "VOLUME_SCATTER": "volume",
    "VOLUME_COEFFICIENTS": "volume",
}
# Inputs of the Principled BSDF, the second as Blender 3.4 names them.
INPUTS = {
    "transmission": ("Transmission Weight", "Transmission"),
    "subsurface": ("Subsurface Weight", "Subsurface"),
}


def features_of(scene: Any) -> list[str]:
    """The FEATURES that a rendered object or the world uses."""
    found: set[str] = set()
    materials: set[Any] = set()
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        seen = instance.object
        if instance.show_self and (instance.is_instance or not seen.hide_render):
            found |= {"volume"} if seen.type == "VOLUME" else set()
            materials.update(material for material in slot_materials(seen) if material is not None)
    for owner in (scene.world, *materials):
        if owner is not None and uses_nodes(owner):
            for node in _nodes_in_use(owner.node_tree):
                found |= _features_of_node(node)
    return [feature for feature in FEATURES if feature in found]


def _nodes_in_use(tree: Any) -> Iterator[Any]:
    """The nodes from which the tree's output gets something, and all nodes of the groups among them."""
    waiting, known = [tree.get_output_node("CYCLES")], set()
    while waiting:
        node = waiting.pop()
        if node is None or node.name in known:
            continue
        known.add(node.name)
        yield node
        if node.type == "GROUP" and node.node_tree is not None:
            yield from all_nodes(node.node_tree)
        waiting += [link.from_node for socket in node.inputs for link in socket.links if not link.is_muted]


def _features_of_node(node: Any) -> set[str]:
    if node.mute:
        return set()
    found = {NODES[node.type]} if node.type in NODES else set()
    if node.type == "BSDF_PRINCIPLED":
        for feature, names in INPUTS.items():
            socket = next(socket for name in names if (socket := node.inputs.get(name)) is not None)
            if socket.is_linked or socket.default_value > 0:
                found.add(feature)
    return found
