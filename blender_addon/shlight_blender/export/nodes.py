# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading node trees: following links, and what they make as values and shaders of `shlight.nodes`.

Constant values are computed here, varying ones at each hit. A table says what each type of node makes of its inputs. A
node of another type is reported. In the place of its value the constant that its socket holds is used, and in that of
its shader a Diffuse BSDF.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Color, Shader, Value, Vector
from shlight.nodes.values import Varying, color, maximum, number, vector

from ..catchers import Part
from ..compat import TURNS_DIFFUSE_NORMALS, corrects_bumps
from ..light_mix import Factors
from ..names import name_of
from ..passes import PassWishes
from ..report import Effect, ExportReport
from .camera import View
from .linking import Linking
from .object_values import ObjectValues

RGB = NDArray[np.float64]


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
    """Inputs other than a thing's own: the camera, the depsgraph, numbers of objects, settings and links of lights."""

    camera_view: View | None = None
    depsgraph: Any = None
    object_values: ObjectValues = field(default_factory=ObjectValues)
    passes: PassWishes = field(default_factory=PassWishes)
    light_bounces: bool = False
    sharp_caustics: bool = False  # Filter Glossy leaves them sharp in Cycles
    linking: Linking = field(default_factory=lambda: Linking({}))
    part: Part = Part.WHOLE  # of the scene that is shown
    factors: Factors = field(default_factory=dict)  # of the light mixer
    view_is_used: bool = field(default=False, init=False)

    @property
    def view(self) -> View | None:
        """How the camera sees the world; what asks for it is of this camera alone."""
        self.view_is_used = True
        return self.camera_view


@dataclass(frozen=True)
class NodeInputs:
    """A node whose output is asked for, as the functions of `shaders.NODES` see it."""

    reader: TreeReader
    node: Any
    output: Any
    groups: tuple[Any, ...]
    asked: Any = None  # the socket that reads the output, behind groups and reroutes

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

    def diffuse_normal(self) -> Vector | None:
        """The normal of a diffuse lobe, None if no node makes it."""
        normal = self.linked_vector("Normal")
        return nodes.reflecting_normal(normal) if normal is not None and TURNS_DIFFUSE_NORMALS else normal

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

    def shader(self, name: str | int) -> Shader:
        """The shader that an input receives."""
        return self.reader.shader(self.node.inputs[name], self.groups)

    def remark(self, text: str, effect: Effect = Effect.LOOK) -> None:
        """Adds a line about this node to the report."""
        self.reader.report.add(f"{self.reader.place}, node '{node_name(self.node)}'", text, effect)

    def remark_glass(self, what: str) -> None:
        """Reports what glass lacks in a picture of direct light, and in one with bounces."""
        around = self.reader.surroundings
        if not around.light_bounces:
            self.remark(f"{what} shows nothing behind it while Max Bounces is 0", Effect.THING)
        elif around.sharp_caustics:
            self.remark("light that it focuses on other surfaces (caustics) is blurred", Effect.LOOK)

    def remark_nothing_reflected(self) -> None:
        """Reports metal in a picture of direct light."""
        if not self.reader.surroundings.light_bounces:
            self.remark("it reflects lamps and the world, and no surface, while Max Bounces is 0", Effect.THING)

    def remark_bumps(self) -> None:
        """Reports normals that are bent where Cycles does not soften the shadows of bumps."""
        if not corrects_bumps(self.reader.owner):
            self.remark("diffuse bumps shadow themselves as with Bump Map Correction")

    def remark_rough_bumps(self) -> None:
        """Reports a rough diffuse surface with bumps."""
        self.remark("its bumps shadow themselves as those of a surface without diffuse roughness", Effect.SLIGHT)


ReadNode = Callable[[NodeInputs], "Varying | Shader"]


# Nodes that are read inside each other, at most.
DEEPEST = 50


class Asked(NamedTuple):
    """The value or the shader of a node's output, which an input socket reads."""

    source: Origin
    socket: Any
    is_shader: bool

    @property
    def key(self) -> tuple[Any, ...]:
        """The same for the same output in the same groups."""
        return self.is_shader, *self.source.key


class TooDeepError(Exception):
    """Another node has to be read first."""

    def __init__(self, asked: Asked) -> None:
        super().__init__("nodes lie too deep")
        self.asked = asked


@dataclass
class TreeReader:
    """Follows the links of the tree of `owner`; `place` names it in the report, for instance "Material 'Wood'"."""

    owner: Any
    place: str
    report: ExportReport
    surroundings: Surroundings
    nodes: Mapping[str, ReadNode]  # by types of nodes
    _known: dict[tuple[Any, ...], Any] = field(default_factory=dict, init=False)
    _open: set[tuple[Any, ...]] = field(default_factory=set, init=False)

    def expression(self, socket: Any, groups: tuple[Any, ...] = ()) -> Expression:
        """The value that an input socket receives."""
        source = origin(socket, groups)
        return own_value(source.socket) if source.node is None else self._find(Asked(source, socket, False))

    def shader(self, socket: Any, groups: tuple[Any, ...] = ()) -> Shader:
        """The shader that a socket receives; black where nothing is linked."""
        source = origin(socket, groups)
        return Shader() if source.node is None else self._find(Asked(source, socket, True))

    def _find(self, asked: Asked) -> Any:
        """What is asked for. What lies too deep is read first, from the bottom up, so that any tree fits the stack."""
        if self._open:
            return self._find_here(asked)
        waiting = [asked]
        while waiting:
            try:
                self._find_here(waiting[-1])
                waiting.pop()
            except TooDeepError as deep:
                if deep.asked.key in {own.key for own in waiting}:
                    self._known[deep.asked.key] = self._in_circle(deep.asked)
                else:
                    waiting.append(deep.asked)
        return self._known[asked.key]

    def _find_here(self, asked: Asked) -> Any:
        if asked.key in self._known:
            return self._known[asked.key]
        if asked.key in self._open:
            return self._in_circle(asked)
        if len(self._open) >= DEEPEST:
            raise TooDeepError(asked)
        self._open.add(asked.key)
        try:
            self._known[asked.key] = self._read_shader(asked) if asked.is_shader else self._read_value(asked)
        finally:
            self._open.discard(asked.key)
        return self._known[asked.key]

    def _inputs(self, source: Origin) -> NodeInputs:
        return NodeInputs(self, source.node, source.output, source.groups, source.socket)

    def _in_circle(self, asked: Asked) -> Expression | Shader:
        if asked.is_shader:
            return Shader()  # Cycles draws none of them either
        self._inputs(asked.source).remark("its links run in a circle; 0 is used")
        return number(0.0)

    def _read(self, source: Origin) -> Varying | Shader | None:
        """The value or the shader of an output; None of a node that is not known."""
        inputs, read = self._inputs(source), self.nodes.get(source.node.type)
        try:
            return None if read is None else read(inputs)
        except KeyError as unknown:
            inputs.remark(f"{unknown} is not known")
            return None

    def _read_value(self, asked: Asked) -> Expression:
        source, socket, _ = asked
        inputs, found = self._inputs(source), self._read(source)
        if found is not None and not isinstance(found, Shader):
            return found if isinstance(found, Value | Vector) else _constant(found)
        fallback = own_value(source.socket)
        constants = [value.constant for value in (fallback if isinstance(fallback, Vector) else (fallback,))]
        shown = np.array2string(np.array(constants), precision=3, separator=", ")
        reads = f"'{socket.name}' of '{node_name(socket.node)}'"
        inputs.remark(f"{_kind(source.node)} is not supported; {reads} uses its constant {shown}")
        return fallback

    def _read_shader(self, asked: Asked) -> Shader:
        source = asked.source
        inputs = self._inputs(source)
        if source.output.type != "SHADER":
            # A value where a shader is asked for is light of that colour.
            return nodes.emission(color(self._find(asked._replace(is_shader=False))))
        if isinstance(found := self._read(source), Shader):
            return found
        if "Color" not in source.node.inputs:
            inputs.remark(f"{_kind(source.node)} is not supported; drawn black", Effect.THING)
            return Shader()
        inputs.remark(f"{_kind(source.node)} is not supported; drawn as Diffuse BSDF of its colour")
        return nodes.lambert(inputs.color("Color"))


def _kind(node: Any) -> str:
    return str(node.bl_label or node.bl_idname)


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


def positive(c: Vector) -> Color:
    """A colour without what is negative of it."""
    return Color(*(maximum(component, 0.0) for component in c))
