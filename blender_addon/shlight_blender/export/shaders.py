# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that shlight reads, by node type."""

from __future__ import annotations

from typing import Any

from ..report import Effect
from .microfacets import glossy_lobe
from .principled import read_principled
from .surface import ReadShader, Surface, SurfaceReader, lambert


def _diffuse(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    reader.ignore_linked(node, groups, "Normal")
    reader.ignore_unless(node, groups, "Roughness", 0.0)
    return Surface(lambert(reader.color(node, "Color", groups)))


def _glossy(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    reader.ignore_linked(node, groups, "Normal", "Tangent")
    reader.ignore_unless(node, groups, "Anisotropy", 0.0)
    color = reader.color(node, "Color", groups)
    if not color.any():
        return Surface()
    roughness = 0.0 if node.distribution == "SHARP" else reader.share(node, "Roughness", groups)
    if node.distribution not in {"GGX", "MULTI_GGX"} and roughness > 0.0:  # all distributions end in the same mirror
        reader.report.add(reader.at(node), f"distribution {node.distribution} is not supported; GGX is used")
    multiple_bounces = node.distribution == "MULTI_GGX"
    return Surface(glossy_lobe(color, roughness, multiple_bounces, reader.remarks(node, Effect.SLIGHT)))


def _emission(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    return reader.emitter(node, "Color", "Strength", groups)


def _mix(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    factor = reader.share(node, node.inputs[0].name, groups)
    # The two shader inputs share their name; a branch of weight 0 does not show and is not even looked at.
    first = Surface() if factor == 1.0 else reader.surface(node.inputs[1], groups).scaled(1.0 - factor)
    second = Surface() if factor == 0.0 else reader.surface(node.inputs[2], groups).scaled(factor)
    return first.plus(second)


def _add(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    return reader.surface(node.inputs[0], groups).plus(reader.surface(node.inputs[1], groups))


SHADERS: dict[str, ReadShader] = {
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_GLOSSY": _glossy,
    "BSDF_PRINCIPLED": read_principled,
    "EMISSION": _emission,
    "MIX_SHADER": _mix,
    "ADD_SHADER": _add,
}
