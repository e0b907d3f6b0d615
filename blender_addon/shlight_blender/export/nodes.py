# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading node trees: following links through groups, reroutes and muted nodes, and constant values of sockets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.photometry import LUMINANCE

from ..names import name_of
from ..report import ExportReport
from .blackbody import blackbody_rgb

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


def _own_value(socket: Any) -> float | RGB:
    value = getattr(socket, "default_value", None)
    if value is None:
        return 0.0
    if isinstance(value, int | float):
        return float(value)
    return np.array(value[:3], dtype=np.float64)


def all_nodes(tree: Any) -> Iterator[Any]:
    """The nodes of a tree and of the groups in it."""
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree is not None:
            yield from all_nodes(node.node_tree)


def node_name(node: Any) -> str:
    """A node as the user finds it: its label if it has one, else its name."""
    return name_of(node, "label") or name_of(node)


class ConstantReader:
    """Constant values of a tree's sockets; whatever is not constant is reported and replaced by the socket's value.

    `place` names the tree's owner in the report, for instance "Material 'Wood'".
    """

    def __init__(self, place: str, report: ExportReport) -> None:
        self.place = place
        self.report = report

    def at(self, node: Any) -> str:
        """The place of one node in the report."""
        return f"{self.place}, node '{node_name(node)}'"

    def number(self, node: Any, name: str, groups: tuple[Any, ...] = ()) -> float:
        """Value of the input `name` as a number; colours count with their luminance, as in Cycles."""
        value = self._value(node, node.inputs[name], groups)
        return value if isinstance(value, float) else float(value @ LUMINANCE)

    def share(self, node: Any, name: str, groups: tuple[Any, ...] = ()) -> float:
        """Value of the input `name` as a number, clamped to 0 … 1 as Cycles does."""
        return min(max(float(np.nan_to_num(self.number(node, name, groups))), 0.0), 1.0)

    def color(self, node: Any, name: str, groups: tuple[Any, ...] = ()) -> RGB:
        """Value of the input `name` as linear RGB, never negative; numbers count as grey."""
        value = self._value(node, node.inputs[name], groups)
        rgb = np.full(3, value) if isinstance(value, float) else value
        return np.maximum(np.nan_to_num(rgb), 0.0)

    def _value(self, node: Any, socket: Any, groups: tuple[Any, ...]) -> float | RGB:
        source = origin(socket, groups)
        if source.node is None:
            return _own_value(source.socket)
        constant = CONSTANT_NODES.get(source.node.type)
        if constant is not None:
            return constant(self, source)
        fallback = _own_value(source.socket)
        shown = np.array2string(np.atleast_1d(fallback), precision=3, separator=", ")
        self.report.add(
            self.at(source.node),
            f"varying values are not supported; '{socket.name}' of '{node_name(node)}' uses its constant {shown}",
        )
        return fallback


def _blackbody(reader: ConstantReader, source: Origin) -> float | RGB:
    return blackbody_rgb(reader.number(source.node, "Temperature", source.groups))


def _output_value(reader: ConstantReader, source: Origin) -> float | RGB:
    return _own_value(source.output)


CONSTANT_NODES: dict[str, Callable[[ConstantReader, Origin], float | RGB]] = {
    "VALUE": _output_value,
    "RGB": _output_value,
    "BLACKBODY": _blackbody,
}
