# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading node trees: following links, and values as expressions of `shlight.nodes`.

Constant values are computed here, varying ones at each hit. A table says what each type of node makes of its inputs. A
node of another type is reported, and the constant that its socket holds is used in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.nodes import Color, Value, Vector
from shlight.nodes.values import Varying, color, number, vector

from ..names import name_of
from ..passes import PassWishes
from ..report import Effect, ExportReport
from .camera import View
from .object_values import ObjectValues

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


Expression = Value | Vector  # a Color is a Vector that counts with its luminance


@dataclass
class Surroundings:
    """Inputs of nodes other than the surface: the camera, the depsgraph, numbers of objects, and settings."""

    camera_view: View | None = None
    depsgraph: Any = None
    object_values: ObjectValues = field(default_factory=ObjectValues)
    passes: PassWishes = field(default_factory=PassWishes)
    light_bounces: bool = False
    view_is_used: bool = field(default=False, init=False)

    @property
    def view(self) -> View | None:
        """How the camera sees the world; what asks for it is of this camera alone."""
        self.view_is_used = True
        return self.camera_view


@dataclass(frozen=True)
class NodeInputs:
    """A node whose output is asked for, as the functions of `NODES` see it."""

    reader: ExpressionReader
    node: Any
    output: Any
    groups: tuple[Any, ...]

    def socket(self, name: str | int) -> Any:
        """An input by number, identifier or name, also if the node's mode hides it; None if there is none."""
        sockets = self.node.inputs
        if isinstance(name, int):
            return sockets[name] if name < len(sockets) else None
        return next((own for own in sockets if own.identifier == name), None) or next(
            (own for own in sockets if own.name == name), None
        )

    def is_linked(self, name: str | int) -> bool:
        """True if another node makes the value of an input."""
        socket = self.socket(name)
        return socket is not None and origin(socket, self.groups).node is not None

    def expression(self, name: str | int) -> Expression:
        """An input as its link or socket has it; 0 if this version of Blender has no such input."""
        socket = self.socket(name)
        return number(0.0) if socket is None else self.reader.expression(socket, self.groups)

    def linked_vector(self, name: str | int) -> Vector | None:
        """An input as a vector if another node makes it, else None: what the node itself takes in its place."""
        return self.vector(name) if self.is_linked(name) else None

    def vector_or(self, name: str | int, default: Vector) -> Vector:
        """An input as a vector if another node makes it, else the default."""
        return self.vector(name) if self.is_linked(name) else default

    def number(self, name: str | int) -> Value:
        """An input as a number."""
        return number(self.expression(name))

    def vector(self, name: str | int) -> Vector:
        """An input as a vector."""
        return vector(self.expression(name))

    def color(self, name: str | int) -> Color:
        """An input as a colour."""
        return color(self.expression(name))

    def remark(self, text: str, effect: Effect = Effect.LOOK) -> None:
        """Adds a line about this node to the report."""
        self.reader.report.add(self.reader.at(self.node), text, effect)


ReadNode = Callable[[NodeInputs], Varying]


# Nodes that are read inside each other, at most.
DEEPEST = 50


@dataclass(frozen=True)
class Asked:
    """Something of a tree that is to be found, and kept in `known` by `key`."""

    known: dict[Any, Any]
    key: Any
    read: Callable[[], Any]
    in_circle: Callable[[], Any]

    @property
    def mark(self) -> tuple[int, Any]:
        """Its name among all that is asked for."""
        return id(self.known), self.key


class TooDeepError(Exception):
    """Another node has to be read first."""

    def __init__(self, asked: Asked) -> None:
        super().__init__("nodes lie too deep")
        self.asked = asked


class ExpressionReader:
    """Follows the links of the tree of `owner`; `place` names it in the report, for instance "Material 'Wood'"."""

    def __init__(
        self,
        owner: Any,
        place: str,
        report: ExportReport,
        surroundings: Surroundings,
        read_nodes: Mapping[str, ReadNode],
    ) -> None:
        self._nodes = read_nodes
        self.owner = owner
        self.surroundings = surroundings
        self.place = place
        self.report = report
        self._known: dict[tuple[Any, ...], Expression] = {}
        self._open: set[tuple[Any, ...]] = set()

    def at(self, node: Any) -> str:
        """The place of one node in the report."""
        return f"{self.place}, node '{node_name(node)}'"

    def expression(self, socket: Any, groups: tuple[Any, ...] = ()) -> Expression:
        """The value that an input socket receives."""
        source = origin(socket, groups)
        return own_value(source.socket) if source.node is None else self.output(source, socket)

    def output(self, source: Origin, socket: Any = None) -> Expression:
        """The value of a node's output; socket: the input that reads it."""

        def in_circle() -> Expression:
            self.report.add(self.at(source.node), "its links run in a circle; 0 is used")
            return number(0.0)

        asking = source.socket if socket is None else socket
        return self.once(self._known, source, lambda: self._read(source, asking), in_circle)

    def once(self, known: dict[Any, Any], source: Origin, read: Callable[[], Any], in_circle: Callable[[], Any]) -> Any:
        """`known` of a source; `read()` finds it, perhaps by asking for others, and `in_circle()` if it is one of them.

        What lies too deep is read first, from the bottom up, so that trees of any depth fit Python's stack.
        """
        asked = Asked(known, source.key, read, in_circle)
        if asked.key in known:
            return known[asked.key]
        if asked.mark in self._open:
            return in_circle()
        if len(self._open) >= DEEPEST:
            raise TooDeepError(asked)
        if self._open:
            self._find(asked)
            return known[asked.key]
        waiting = [asked]
        while waiting:
            try:
                self._find(waiting[-1])
                waiting.pop()
            except TooDeepError as deep:
                deeper = deep.asked
                if any(own.mark == deeper.mark for own in waiting):
                    deeper.known[deeper.key] = deeper.in_circle()
                else:
                    waiting.append(deeper)
        return known[asked.key]

    def _find(self, asked: Asked) -> None:
        self._open.add(asked.mark)
        try:
            asked.known[asked.key] = asked.read()
        finally:
            self._open.discard(asked.mark)

    def _read(self, source: Origin, socket: Any) -> Expression:
        read = self._nodes.get(source.node.type)
        if read is not None:
            found = read(NodeInputs(self, source.node, source.output, source.groups))
            return found if isinstance(found, Value | Vector) else _constant(found)
        fallback = own_value(source.socket)
        kind = source.node.bl_label or source.node.bl_idname
        constants = [value.constant for value in (fallback if isinstance(fallback, Vector) else (fallback,))]
        shown = np.array2string(np.array(constants), precision=3, separator=", ")
        text = f"{kind} is not supported; '{socket.name}' of '{node_name(socket.node)}' uses its constant {shown}"
        self.report.add(self.at(source.node), text)
        return fallback


def _constant(value: Any) -> Expression:
    return number(value) if np.ndim(value) == 0 else Color(*np.asarray(value, dtype=np.float64)[:3])


def own_value(socket: Any) -> Expression:
    """The constant that a socket holds; 0 for one that holds none."""
    value = getattr(socket, "default_value", None)
    if value is None or isinstance(value, str):
        return number(0.0)
    if np.ndim(value) == 0:
        return number(float(value))
    kind = Color if socket.type == "RGBA" else Vector
    return kind(*(float(component) for component in value[:3]))
