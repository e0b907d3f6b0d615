# SPDX-License-Identifier: MIT
"""Disney's diffuse reflection and first sheen, which Blender's Principled BSDF had before version 4."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from shlight.nodes.shader import Lobe, Shader
from shlight.nodes.subsurface import subsurface
from shlight.nodes.values import Number, Varying, Vector, clamp, color, number, reflectance, vector


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
