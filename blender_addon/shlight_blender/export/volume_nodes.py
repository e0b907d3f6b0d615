# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of what fills a body: what absorbs light evenly is drawn, what scatters it or glows is not."""

from __future__ import annotations

from typing import Any

from shlight import nodes
from shlight.nodes import Shader, Value, Vector
from shlight.nodes.shader import BLACK
from shlight.nodes.values import maximum, number, sqrt, vector

from ..report import Effect
from .nodes import NodeInputs, ReadNode, TreeReader, origin, positive


def _remark_rest(inputs: NodeInputs, scattered: Vector, glow: Vector) -> None:
    """Reports what is not drawn, unless it is black."""
    if scattered.constant != BLACK:
        inputs.remark("its scattering is not supported; what it scatters is neither taken away nor added")
    if glow.constant != BLACK:
        inputs.remark("its emission is not supported; left out", Effect.LIGHT)


def _absorbing(absorption: Vector, density: Value) -> Shader:
    return nodes.absorbing(positive(absorption) * maximum(density, 0.0))


def _scatter(inputs: NodeInputs) -> Shader:
    _remark_rest(inputs, inputs.color("Color"), vector(0.0))
    return Shader()


def _principled(inputs: NodeInputs) -> Shader:
    scattered = inputs.color("Color")
    _remark_rest(
        inputs, scattered, Vector(inputs.number("Emission Strength"), inputs.number("Blackbody Intensity"), 0.0)
    )
    kept = Vector(*(sqrt(c) for c in inputs.color("Absorption Color")))
    return _absorbing(positive(1.0 - scattered) * positive(1.0 - kept), inputs.number("Density"))


def _coefficients(inputs: NodeInputs) -> Shader:
    _remark_rest(inputs, inputs.vector("Scatter Coefficients"), inputs.vector("Emission Coefficients"))
    return _absorbing(inputs.vector("Absorption Coefficients"), number(1.0))


VOLUME_NODES: dict[str, ReadNode] = {
    "VOLUME_ABSORPTION": lambda inputs: _absorbing(1.0 - inputs.color("Color"), inputs.number("Density")),
    "VOLUME_SCATTER": _scatter,
    "PRINCIPLED_VOLUME": _principled,
    "VOLUME_COEFFICIENTS": _coefficients,
}


def filled(surface: Shader, output: Any, reader: TreeReader) -> Shader:
    """The shader of a material's surface with what absorbs light behind it, which `output` receives."""
    if origin(output.inputs["Volume"]).node is None:
        return surface
    volume = reader.shader(output.inputs["Volume"])
    if volume.emission.constant != BLACK:
        reader.report.add(reader.place, "volume that emits light is not supported; left out", Effect.LIGHT)
    if volume.absorption.constant is None:
        text = "volume that absorbs more in one place than in another is not supported; left out"
        reader.report.add(reader.place, text)
        return surface
    # Without a surface, light passes where the body begins.
    around = surface if origin(output.inputs["Surface"]).node is not None else nodes.transparent()
    return around + Shader(absorption=volume.absorption)
