# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading node trees: following links through groups, reroutes and muted nodes, and constant values of sockets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..names import name_of

RGB = NDArray[np.float64]


def rgb(values: RGB) -> tuple[float, float, float]:
    """A colour as the core takes it."""
    return float(values[0]), float(values[1]), float(values[2])


@dataclass(frozen=True)
class Origin:
    """The source of a socket's value: `node` and its output, or no node and the value of the last `socket`.

    `groups` are the group nodes entered on the way, outermost first: links of a Group Input lead back out of them.
    """

    socket: Any
    node: Any = None
    output: Any = None
    groups: tuple[Any, ...] = ()

    @property
    def key(self) -> tuple[Any, ...]:
        """The same for the same output in the same groups."""
        return self.node.as_pointer(), self.output.identifier, tuple(group.as_pointer() for group in self.groups)


def _active_group_output(tree: Any) -> Any:
    outputs = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
    return next((node for node in outputs if node.is_active_output), outputs[0] if outputs else None)


def _socket_named(sockets: Any, identifier: str) -> Any:
    return next((socket for socket in sockets if socket.identifier == identifier), None)


def _muted_input(node: Any, output: Any) -> Any:
    return next((link.from_socket for link in node.internal_links if link.to_socket == output), None)


def origin(socket: Any, groups: tuple[Any, ...] = ()) -> Origin:
    """Follows an input socket's link to the node that makes its value; a circle of muted nodes makes none."""
    passed = set()
    while True:
        place = (socket.as_pointer(), tuple(group.as_pointer() for group in groups))
        if place in passed:
            return Origin(socket, groups=groups)
        passed.add(place)
        link = socket.links[0] if socket.is_linked and socket.links else None
        if link is None or link.is_muted:
            return Origin(socket, groups=groups)
        node, output = link.from_node, link.from_socket
        inner: Any = None
        if node.type == "REROUTE":
            inner = node.inputs[0]
        elif node.mute:
            inner = _muted_input(node, output)
        elif node.type == "GROUP" and node.node_tree is not None:
            group_output = _active_group_output(node.node_tree)
            if group_output is not None:
                inner = _socket_named(group_output.inputs, output.identifier)
                groups = (*groups, node)
        elif node.type == "GROUP_INPUT" and groups:
            inner = _socket_named(groups[-1].inputs, output.identifier)
            groups = groups[:-1]
        else:
            return Origin(socket, node, output, groups)
        if inner is None:
            return Origin(socket, groups=groups)
        socket = inner


def all_nodes(tree: Any) -> Iterator[Any]:
    """The nodes of a tree and of the groups in it."""
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree is not None:
            yield from all_nodes(node.node_tree)


def node_name(node: Any) -> str:
    """A node as the user finds it: its label if it has one, else its name."""
    return name_of(node, "label") or name_of(node)
