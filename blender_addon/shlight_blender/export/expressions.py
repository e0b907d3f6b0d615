# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of node trees as expressions of `shlight.nodes`: constant ones are computed here, varying ones at each hit.

A table says what each type of node makes of its inputs. A node of another type is reported, and the constant that its
socket holds is used in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from shlight.nodes import Color, Value, Vector
from shlight.nodes.values import Varying, color, number, vector

from ..report import Effect, ExportReport
from .camera import View
from .nodes import Origin, node_name, origin
from .object_values import ObjectValues

Expression = Value | Vector  # a Color is a Vector that counts with its luminance


@dataclass(frozen=True)
class Surroundings:
    """What nodes may ask for beside the surface: the camera, the depsgraph, and numbers of objects."""

    view: View | None = None
    depsgraph: Any = None
    object_values: ObjectValues = field(default_factory=ObjectValues)


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
        """What an input socket receives."""
        source = origin(socket, groups)
        return own_value(source.socket) if source.node is None else self.output(source, socket)

    def output(self, source: Origin, socket: Any = None) -> Expression:
        """What a node makes; socket: the input that asks for it."""
        key = (source.node.as_pointer(), source.output.identifier, tuple(g.as_pointer() for g in source.groups))
        if key not in self._known:
            if key in self._open:
                self.report.add(self.at(source.node), "its links run in a circle; 0 is used")
                return number(0.0)
            self._open.add(key)
            self._known[key] = self._read(source, source.socket if socket is None else socket)
            self._open.discard(key)
        return self._known[key]

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
