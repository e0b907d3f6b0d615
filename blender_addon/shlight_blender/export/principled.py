# SPDX-License-Identifier: GPL-3.0-or-later
"""Principled BSDF: that of Blender 4 is `shlight.nodes.principled`; that of Blender 3.4 is a plain sum of lobes."""

from __future__ import annotations

from shlight import nodes
from shlight.nodes import Shader
from shlight.nodes.shader import Lobe, Refraction
from shlight.nodes.values import Color, Value, clamp, color, dot, maximum, number, sqrt

from ..compat import PRINCIPLED
from ..report import Effect
from .input_nodes import fresnel_of
from .surface import ShaderInputs

# Luminance with which Blender 3.4 takes the brightness out of the base colour for Specular Tint.
TINT_LUMINANCE = (0.3, 0.6, 0.1)


def read_principled(inputs: ShaderInputs) -> Shader:
    """Shader of a Principled BSDF node."""
    for name, neutral in PRINCIPLED.unsupported.items():
        inputs.ignore_unless(name, neutral)
    return _read_layered(inputs) if PRINCIPLED.layered else _read_sum(inputs)


def _read_layered(inputs: ShaderInputs) -> Shader:
    if inputs.number("Transmission Weight").constant != 0.0:
        inputs.remark_hidden_behind("'Transmission Weight'")
    if inputs.number("Subsurface Weight").constant != 0.0:
        inputs.remark("'Subsurface Weight' is not supported; drawn as diffuse reflection")
    return nodes.principled(
        inputs.color("Base Color"),
        metallic=inputs.number("Metallic"),
        roughness=inputs.number("Roughness"),
        ior=inputs.number("IOR"),
        alpha=inputs.number("Alpha"),
        diffuse_roughness=inputs.number("Diffuse Roughness"),
        specular_ior_level=inputs.number("Specular IOR Level"),
        specular_tint=inputs.color("Specular Tint"),
        coat_weight=inputs.number("Coat Weight"),
        coat_roughness=inputs.number("Coat Roughness"),
        coat_ior=inputs.number("Coat IOR"),
        coat_tint=inputs.color("Coat Tint"),
        coat_normal=inputs.linked_vector("Coat Normal"),
        transmission_weight=inputs.number("Transmission Weight"),
        emission_color=inputs.color("Emission Color"),
        emission_strength=inputs.number("Emission Strength"),
        several_bounces=inputs.node.distribution == "MULTI_GGX",
        at=inputs.linked_vector("Normal"),
    )


def _read_sum(inputs: ShaderInputs) -> Shader:
    if inputs.node.distribution == "MULTI_GGX":
        text = "distribution MULTI_GGX is not supported in this version of Blender; GGX is used"
        inputs.remark(text, Effect.SLIGHT)
    base = Color(*(maximum(c, 0.0) for c in inputs.color("Base Color")))
    metallic = clamp(inputs.number("Metallic"))
    roughness = clamp(inputs.number("Roughness"))
    specular = maximum(inputs.number("Specular"), 0.0)
    tint = inputs.number("Specular Tint")
    alpha = clamp(inputs.number("Alpha"))
    at = inputs.linked_vector("Normal")
    glow = nodes.emission(inputs.color("Emission") * inputs.number("Emission Strength"))
    transmission = clamp(inputs.number("Transmission"))
    if transmission.constant != 0.0:
        inputs.remark_hidden_behind("'Transmission'")
    through = transmission * (1.0 - metallic)
    if metallic.constant != 1.0 and base.constant != (0.0, 0.0, 0.0) and transmission.constant != 1.0:
        text = "the diffuse part is drawn as Diffuse BSDF, without Principled BSDF's darker and brighter edges"
        inputs.remark(text, Effect.SLIGHT)
    surface = nodes.lambert(base * (1.0 - metallic) * (1.0 - transmission), normal=at)
    luminance = sum((c * w for c, w in zip(base, TINT_LUMINANCE, strict=True)), start=number(0.0))
    hue = Color(*(nodes.values.select(luminance > 0.0, c / luminance, 1.0) for c in base))
    f0 = (hue * tint + (1.0 - tint)) * (0.08 * specular) * (1.0 - metallic) + base * metallic
    f0 = Color(*(clamp(c) for c in f0))
    ior = 2.0 / (1.0 - sqrt(nodes.values.minimum(0.08 * specular, 0.99))) - 1.0
    n = nodes.reflecting_normal(nodes.normal() if at is None else at)
    width = roughness * roughness
    if not (specular.constant == 0.0 and metallic.constant == 0.0):
        surface += Shader((Lobe("ggx", f0, width, n), *nodes.rising_lobes(1.0 - f0, ior, width, n))) * (1.0 - through)
    if through.constant != 0.0:
        surface += _glass(inputs, base, hue=color(base * tint + (1.0 - tint)), roughness=roughness) * through
    return nodes.transparent(1.0 - alpha) + (surface + glow) * alpha


def _glass(inputs: ShaderInputs, base: Color, *, hue: Color, roughness: Value) -> Shader:
    """The part of Blender 3.4's node that light goes through: its front reflects as Fresnel's law has it at the normal.

    base, hue: the colours of what goes through, and of what is reflected at a right angle.
    """
    ior, at = maximum(inputs.number("IOR"), 1e-5), inputs.linked_vector("Normal")
    n = nodes.reflecting_normal(nodes.normal() if at is None else at)
    inner = roughness
    if inputs.node.distribution == "GGX":
        inner = 1.0 - (1.0 - roughness) * (1.0 - clamp(inputs.number("Transmission Roughness")))
    front = fresnel_of(dot(nodes.towards_viewer(), n), ior) * (1.0 - nodes.backfacing())
    width = roughness * roughness
    lobes = (Lobe("ggx", hue, width, n), *nodes.rising_lobes(1.0 - hue, maximum(ior, 1.0 / ior), width, n))
    return Shader(lobes) * front + Shader(refractions=(Refraction(color(base), inner * inner, ior, at),))
