# SPDX-License-Identifier: GPL-3.0-or-later
"""The walk over the shader nodes of a tree, which makes one shader of `shlight.nodes` of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from shlight import nodes
from shlight.nodes import Shader

from ..report import Effect, ExportReport
from .expressions import ExpressionReader, NodeInputs, ReadNode, Surroundings, own_value
from .frame_nodes import FRAME_NODES
from .image_nodes import environment_texture, image_texture
from .input_nodes import INPUT_NODES
from .nodes import Origin, origin
from .value_nodes import VALUE_NODES

NODES: dict[str, ReadNode] = {
    "VALUE": lambda inputs: own_value(inputs.output),
    "RGB": lambda inputs: own_value(inputs.output),
    "TEX_IMAGE": image_texture,
    "TEX_ENVIRONMENT": environment_texture,
    **FRAME_NODES,
    **INPUT_NODES,
    **VALUE_NODES,
}


@dataclass(frozen=True)
class ShaderInputs(NodeInputs):
    """A shader node, as the functions of `SHADERS` see it."""

    reader: ShaderReader

    def shader(self, name: str | int) -> Shader:
        """The shader that an input receives."""
        return self.reader.shader(self.node.inputs[name], self.groups)

    def remark_hidden_behind(self, what: str) -> None:
        """Reports glass in a picture of direct light."""
        if not self.reader.surroundings.light_bounces:
            self.remark(f"{what} shows nothing behind it while Max Bounces is 0", Effect.THING)

    def ignore_unless(self, name: str, neutral: float) -> None:
        """Reports an input that is not supported, unless it has the value at which it does nothing."""
        if name in self.node.inputs and self.number(name).constant != neutral:
            self.remark(f"'{name}' is not supported; {neutral:g} is used")


class ShaderReader(ExpressionReader):
    """Reads a tree's shaders; `shaders` and `values` say how a node of each type is read."""

    def __init__(
        self,
        owner: Any,
        place: str,
        report: ExportReport,
        surroundings: Surroundings,
        shaders: dict[str, ReadShader],
        values: Mapping[str, ReadNode] = NODES,
    ) -> None:
        super().__init__(owner, place, report, surroundings, values)
        self._shaders = shaders
        self._made: dict[tuple[Any, ...], Shader] = {}

    def shader(self, socket: Any, groups: tuple[Any, ...] = ()) -> Shader:
        """The shader that a socket receives; black where nothing is linked."""
        source = origin(socket, groups)
        if source.node is None:
            return Shader()
        made: Shader = self.once(self._made, source, lambda: self._read_shader(source), Shader)
        return made

    def _read_shader(self, source: Origin) -> Shader:
        inputs = ShaderInputs(self, source.node, source.output, source.groups)
        read = self._shaders.get(source.node.type)
        if read is not None:
            return read(inputs)
        kind = source.node.bl_label or source.node.bl_idname
        if "Color" not in source.node.inputs:
            if source.output.type != "SHADER":
                # A value where a shader is asked for is light of that colour.
                return nodes.emission(nodes.values.color(self.output(source)))
            inputs.remark(f"{kind} is not supported; drawn black", Effect.THING)
            return Shader()
        inputs.remark(f"{kind} is not supported; drawn as Diffuse BSDF of its colour")
        return nodes.lambert(inputs.color("Color"))


ReadShader = Callable[[ShaderInputs], Shader]
