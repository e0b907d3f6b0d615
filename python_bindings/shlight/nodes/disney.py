# SPDX-License-Identifier: MIT
"""Disney's diffuse reflection, first sheen and clear coat, which Blender's Principled BSDF had before version 4."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from shlight.nodes.inputs import normal, towards_viewer
from shlight.nodes.microfacets import reflecting_normal
from shlight.nodes.shader import Lobe, Shader, ggx
from shlight.nodes.subsurface import subsurface
from shlight.nodes.values import (
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    dot,
    maximum,
    number,
    reflectance,
    sqrt,
    vector,
)

COAT_F0 = 0.04
COAT_ALPHA = 0.0178**2  # the least
COAT_LIGHT = 0.5  # the cosine of light that its lobes reflect as bright as the model does


def disney_diffuse(albedo: Varying, roughness: Number, *, at: Vector | None = None) -> Shader:
    """Diffuse reflection that is darker or, with roughness, brighter towards grazing angles.

    Burley 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", Eq. 4: with F = (1-cosθ)⁵
    of light and view and R = 2 roughness cos²θ_d, f is (1 - F_i/2)(1 - F_o/2)/π + R (F_i + F_o + F_i F_o (R - 1))/π, of
    which each power of the roughness is a lobe. roughness: clamped to 0 … 1. Raises ValueError naming an argument.
    """
    rho = reflectance(albedo, "albedo")
    r = clamp(number(roughness, "roughness"))
    n = None if at is None else vector(at, "at")
    powers = {"disney": number(1.0), "disney_retro": r, "disney_retro_square": r * r}
    return Shader(tuple(Lobe(kind, color(rho * share), normal=n) for kind, share in powers.items()))


def disney_subsurface(
    albedo: Varying, roughness: Number, radius: Varying, *, at: Vector | None = None, **below: Any
) -> Shader:
    """The same with its first part scattered below the surface, which the other two lie above.

    Of Fresnel's factors that part has the light's where it enters, as in Blender 3.4. radius, below: as of
    `nodes.subsurface`. Raises ValueError naming an argument.
    """
    body = subsurface(albedo, radius, at=at, **below).lobes
    entry = tuple(replace(lobe, kind="disney_entry") for lobe in body if lobe.below is not None)
    if not entry:
        return disney_diffuse(albedo, roughness, at=at)
    return Shader(entry + disney_diffuse(albedo, roughness, at=at).lobes[1:])


def disney_sheen(tint: Varying, *, at: Vector | None = None) -> Shader:
    """f = tint (1-cosθ_d)⁵ (Burley 2012, "Physically-Based Shading at Disney").

    Raises ValueError naming an argument.
    """
    n = None if at is None else vector(at, "at")
    return Shader((Lobe("disney_sheen", reflectance(tint, "tint"), normal=n),))


def disney_clearcoat(weight: Number, roughness: Number, *, at: Vector | None = None) -> Shader:
    """A clear coat of index 1.5, whose highlight has long tails (Burley 2012, "Physically-Based Shading at Disney").

    Its distribution of normals, GTR1 of alpha = roughness², is the mean of GGX's over the logarithm of alpha from that
    on to 1. Four lobes make it up, by the rule of Gauss and Legendre. Each masks itself by its own alpha, and is as
    bright as with the model's masking, of alpha 0.25, for light of one angle. weight: 1 reflects a quarter of what the
    index says, as in Blender 3.4. roughness: clamped to 0.0178 … 1. Raises ValueError naming an argument.
    """
    n = reflecting_normal(normal() if at is None else vector(at, "at"))
    alpha = clamp(number(roughness, "roughness"))
    alpha = maximum(alpha * alpha, COAT_ALPHA)
    share = reflectance(weight, "weight") * 0.25
    cosine = clamp(dot(towards_viewer(), n), 0.01)
    coat = Shader()
    for node, part in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        width = alpha ** (0.5 - 0.5 * float(node))
        own = share * (_masked(width, cosine) / _masked(number(0.25), cosine) * (0.5 * float(part)))
        coat += ggx(sqrt(width), COAT_F0, ior=1.5, normal=n) * own
    return coat


def _masked(alpha: Value, cosine: Value) -> Value:
    """1 over the share of GGX's microfacets that view and light see, this at COAT_LIGHT."""
    tangents = (1.0 / (cosine * cosine) - 1.0, number(1.0 / COAT_LIGHT**2 - 1.0))
    return sum((0.5 * sqrt(1.0 + alpha * alpha * tangent) for tangent in tangents), start=number(0.0))
