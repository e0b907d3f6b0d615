# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of noise and of waves."""

from __future__ import annotations

from typing import Any

from shlight import nodes
from shlight.nodes import Color, Value
from shlight.nodes.values import clamp

from ..compat import Noise
from .mesh_attributes import GENERATED
from .nodes import Expression, NodeInputs, ReadNode


def _place(inputs: NodeInputs, dimensions: str) -> dict[str, Any]:
    """The place at which noise is looked up, and how many coordinates count: the number in front of "3D"."""
    return {
        "place": inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        "w": inputs.number("W"),
        "dimensions": int(dimensions[0]),
        "scale": inputs.number("Scale"),
    }


def _numbers(inputs: NodeInputs, *names: str) -> dict[str, Any]:
    """Inputs that this version of Blender has, as arguments of a function of `shlight.nodes`."""
    return {name.lower().replace(" ", "_"): inputs.number(name) for name in names if inputs.socket(name) is not None}


def _roughness(inputs: NodeInputs, name: str) -> Value:
    found = inputs.number(name)
    return clamp(found) if Noise.roughness_is_clamped else found


def _noise(inputs: NodeInputs) -> Expression:
    node = inputs.node
    found = nodes.noise(
        **_place(inputs, node.noise_dimensions),
        kind=getattr(node, "noise_type", "FBM").lower(),
        normalize=getattr(node, "normalize", True),
        roughness=_roughness(inputs, "Roughness"),
        repeats=Noise.repeats,
        **_numbers(inputs, "Detail", "Lacunarity", "Offset", "Gain", "Distortion"),
    )
    return found if inputs.output.type == "RGBA" else found.x


def _musgrave(inputs: NodeInputs) -> Expression:
    node = inputs.node
    return nodes.musgrave(
        **_place(inputs, node.musgrave_dimensions),
        kind=node.musgrave_type.lower(),
        repeats=Noise.repeats,
        **_numbers(inputs, "Detail", "Dimension", "Lacunarity", "Offset", "Gain"),
    )


def _wave(inputs: NodeInputs) -> Expression:
    node, kind = inputs.node, inputs.node.wave_type.lower()
    found = nodes.wave(
        inputs.vector_or("Vector", nodes.attribute(GENERATED)),
        kind=kind,
        direction=getattr(node, f"{kind}_direction").lower(),
        profile={"SIN": "sine", "SAW": "saw", "TRI": "triangle"}[node.wave_profile],
        scale=inputs.number("Scale"),
        phase=inputs.number("Phase Offset"),
        detail_roughness=_roughness(inputs, "Detail Roughness"),
        repeats=Noise.repeats,
        **_numbers(inputs, "Distortion", "Detail", "Detail Scale"),
    )
    return Color(found, found, found) if inputs.output.type == "RGBA" else found


NOISE_NODES: dict[str, ReadNode] = {"TEX_NOISE": _noise, "TEX_MUSGRAVE": _musgrave, "TEX_WAVE": _wave}
