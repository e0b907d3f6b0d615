# SPDX-License-Identifier: MIT
"""Walls without thickness, such as panes and leaves: the Principled BSDF's Thin Wall."""

from __future__ import annotations

from shlight.nodes.fresnel import fresnel_of, head_on
from shlight.nodes.inputs import towards_viewer
from shlight.nodes.shader import Lobe, Shader, translucent, transparent
from shlight.nodes.values import Color, Value, Vector, clamp, color, dot, maximum, operation, sqrt


def thin_glass(weight: Color, base: Color, f0: Color, index: Value, alpha: Value, at: Vector) -> Shader:
    """A pane, which light passes on a straight way, after any number of reflections between its sides.

    base: what is left of light that passes once at a right angle, and at others by its way. f0: the reflectance at a
    right angle of each side, from which it rises as Fresnel's law has it for the index. alpha: the width of the
    reflection; light that passes is not scattered.
    """
    cosine = clamp(dot(towards_viewer(), at), 1e-4)
    inside = sqrt(1.0 - (1.0 - cosine * cosine) / (index * index))
    rise = clamp((fresnel_of(cosine, index) - head_on(index)) / (1.0 - head_on(index)))
    reflected = color(f0 + (1.0 - f0) * rise)
    left = Color(*(operation("power", clamp(component), 1.0 / inside) for component in base))
    entered = 1.0 - reflected
    again = color(reflected * left)
    leaves = Color(*(maximum(1.0 - component * component, 1e-9) for component in again))
    passes = color(left * entered * entered / leaves)
    returns = color(reflected + passes * again)
    return transparent(weight * passes) + Shader((Lobe("ggx", color(weight * returns), alpha, at),))


def leaf(diffuse: Shader, base: Color, share: Value, anisotropy: Value, at: Vector | None) -> Shader:
    """A sheet of dense, scattering matter: more of its light comes through the higher the anisotropy, -1 … 1, is.

    diffuse: what it would reflect if nothing came through; share: of it, what is scattered.
    """
    through = share * clamp(0.5 * (1.0 + anisotropy))
    return diffuse * (1.0 - through) + translucent(base, at) * through
