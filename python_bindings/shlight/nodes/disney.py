# SPDX-License-Identifier: MIT
"""Disney's diffuse reflection and first sheen, which Blender's Principled BSDF had before version 4."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import _core, _tables
from shlight.nodes.shader import Lobe, Shader
from shlight.nodes.subsurface import subsurface
from shlight.nodes.values import Number, Varying, Vector, clamp, color, number, reflectance, vector

Doubles = NDArray[np.float64]

STEPS, AZIMUTHS = 64, 33  # of the tables: of a right angle, and of half a turn


def disney_diffuse(albedo: Varying, roughness: Number, *, at: Vector | None = None) -> Shader:
    """Diffuse reflection that is darker or, with roughness, brighter towards grazing angles.

    Burley 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", Eq. 4: with F = (1-cosθ)⁵
    of light and view and R = 2 roughness cos²θ_d, f is (1 - F_i/2)(1 - F_o/2)/π + R (F_i + F_o + F_i F_o (R - 1))/π, of
    which each power of the roughness is a lobe. roughness: clamped to 0 … 1. Raises ValueError naming an argument.
    """
    rho = reflectance(albedo, "albedo")
    r = clamp(number(roughness, "roughness"))
    n = None if at is None else vector(at, "at")
    return Shader(
        tuple(Lobe(_diffuse_lobe(i), color(rho * share), normal=n) for i, share in enumerate((number(1.0), r, r * r)))
    )


def disney_subsurface(
    albedo: Varying, roughness: Number, radius: Varying, *, at: Vector | None = None, **below: Any
) -> Shader:
    """The same with its first part scattered below the surface, which the other two lie above.

    Of Fresnel's factors that part has the light's where it enters, as in Blender 3.4. radius, below: as of
    `nodes.subsurface`. Raises ValueError naming an argument.
    """
    body = subsurface(albedo, radius, at=at, **below).lobes
    entry = tuple(replace(lobe, kind=_entry_lobe()) for lobe in body if lobe.below is not None)
    if not entry:
        return disney_diffuse(albedo, roughness, at=at)
    return Shader(entry + disney_diffuse(albedo, roughness, at=at).lobes[1:])


def disney_sheen(tint: Varying, *, at: Vector | None = None) -> Shader:
    """f = tint (1-cosθ_d)⁵ (Burley 2012, "Physically-Based Shading at Disney").

    Raises ValueError naming an argument.
    """
    n = None if at is None else vector(at, "at")
    return Shader((Lobe(_sheen_lobe(), reflectance(tint, "tint"), normal=n),))


def _axes() -> tuple[Doubles, Doubles, Doubles, Doubles]:
    """Angles of the light and the view and azimuths between them; and 1 + ω_i·ω_o over all of them."""
    theta = np.linspace(0.0, math.pi / 2, STEPS + 1)
    phi = np.linspace(0.0, math.pi, AZIMUTHS)
    light, view = theta[:, None, None], theta[None, :, None]
    return theta, theta, phi, 1.0 + np.cos(light) * np.cos(view) + np.sin(light) * np.sin(view) * np.cos(phi)


@lru_cache(maxsize=3)
def _diffuse_lobe(power: int) -> _core.Bsdf:
    """The lobe that a power of the roughness is multiplied with."""
    theta_i, theta_o, phi, across = _axes()
    light, view = ((1.0 - np.cos(theta)) ** 5 for theta in (theta_i[:, None, None], theta_o[None, :, None]))
    f = (
        (1.0 - 0.5 * light) * (1.0 - 0.5 * view) * np.ones_like(across),
        across * (light + view - light * view),
        across**2 * light * view,
    )[power]
    return _tables.from_table(f[:, None] / math.pi, theta_i, [0.0], theta_o, phi)


@lru_cache(maxsize=1)
def _entry_lobe() -> _core.Bsdf:
    theta_i, theta_o, phi, across = _axes()
    f = (1.0 - 0.5 * (1.0 - np.cos(theta_i[:, None, None])) ** 5) * np.ones_like(across)
    return _tables.from_table(f[:, None] / math.pi, theta_i, [0.0], theta_o, phi)


@lru_cache(maxsize=1)
def _sheen_lobe() -> _core.Bsdf:
    theta_i, theta_o, phi, across = _axes()
    cosine = np.sqrt(np.clip(across / 2.0, 0.0, 1.0))
    return _tables.from_table((1.0 - cosine[:, None]) ** 5, theta_i, [0.0], theta_o, phi)
