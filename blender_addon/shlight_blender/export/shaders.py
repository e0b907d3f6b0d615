# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that shlight reads, by node type."""

from __future__ import annotations

from shlight import nodes
from shlight.nodes import Shader
from shlight.nodes.values import Color, Value, color, maximum, number, vector

from .principled import read_principled
from .surface import ReadShader, ShaderInputs


def positive(c: nodes.Vector) -> Color:
    """A colour without what is negative of it."""
    return Color(*(maximum(component, 0.0) for component in c))


def _diffuse(inputs: ShaderInputs) -> Shader:
    return nodes.oren_nayar(
        positive(inputs.color("Color")), inputs.number("Roughness"), at=inputs.linked_vector("Normal")
    )


def _roughness(inputs: ShaderInputs) -> Value:
    """The roughness of a node with a distribution of microfacets."""
    distribution = inputs.node.distribution
    roughness = number(0.0) if distribution == "SHARP" else inputs.number("Roughness")
    if distribution not in {"GGX", "MULTI_GGX", "SHARP"} and roughness.constant != 0.0:
        # All distributions end in the same mirror.
        inputs.remark(f"distribution {distribution} is not supported; GGX is used")
    return roughness


def _glossy(inputs: ShaderInputs) -> Shader:
    inputs.ignore_unless("Anisotropy", 0.0)
    several = inputs.node.distribution == "MULTI_GGX"
    at = inputs.linked_vector("Normal")
    return nodes.glossy(inputs.color("Color"), _roughness(inputs), several_bounces=several, at=at)


def _glass(inputs: ShaderInputs) -> Shader:
    inputs.remark_hidden_behind(inputs.node.bl_label)
    tint, ior, at = inputs.color("Color"), inputs.number("IOR"), inputs.linked_vector("Normal")
    roughness = _roughness(inputs)
    if inputs.node.type == "BSDF_REFRACTION":
        return nodes.refraction(tint, roughness, ior, at=at)
    return nodes.glass(tint, roughness, ior, several_bounces=inputs.node.distribution == "MULTI_GGX", at=at)


def _translucent(inputs: ShaderInputs) -> Shader:
    return nodes.translucent(positive(inputs.color("Color")), inputs.linked_vector("Normal"))


def _emission(inputs: ShaderInputs) -> Shader:
    return nodes.emission(inputs.color("Color") * inputs.number("Strength"))


def _transparent(inputs: ShaderInputs) -> Shader:
    return nodes.transparent(inputs.color("Color"))


def _mix(inputs: ShaderInputs) -> Shader:
    factor = inputs.number(0)
    # The two shader inputs share their name; a branch of weight 0 does not show and is not even looked at.
    if factor.constant is not None and factor.constant <= 0.0:
        return inputs.shader(1)
    if factor.constant is not None and factor.constant >= 1.0:
        return inputs.shader(2)
    return nodes.mix(inputs.shader(1), inputs.shader(2), factor)


def _add(inputs: ShaderInputs) -> Shader:
    return inputs.shader(0) + inputs.shader(1)


SHADERS: dict[str, ReadShader] = {
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_GLASS": _glass,
    "BSDF_GLOSSY": _glossy,
    "BSDF_PRINCIPLED": read_principled,
    "BSDF_REFRACTION": _glass,
    "BSDF_TRANSLUCENT": _translucent,
    "BSDF_TRANSPARENT": _transparent,
    "EMISSION": _emission,
    "MIX_SHADER": _mix,
    "ADD_SHADER": _add,
}
__all__ = ["SHADERS", "color", "positive", "vector"]
