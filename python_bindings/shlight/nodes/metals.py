# SPDX-License-Identifier: MIT
"""Metals: Blender's Metallic BSDF, by colours or by a complex index of refraction."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from shlight._arrays import checked_flag, checked_name
from shlight.nodes import films
from shlight.nodes.films import film
from shlight.nodes.inputs import normal, towards_viewer
from shlight.nodes.microfacets import (
    EDGE,
    Distribution,
    aspect_stretch,
    bounces,
    checked_distribution,
    clamped,
    mean_roughness,
    metal_lobes,
    mixed,
    reflecting_normal,
    stretched,
    sum_of_lobes,
)
from shlight.nodes.shader import Shader
from shlight.nodes.values import Color, Number, Value, Varying, Vector, clamp, color, dot, maximum, number, sqrt, vector

FresnelModel: TypeAlias = Literal["exact", "large_index"]

# Cosines at which a metal's Fresnel curve is known, and how much each counts.
COSINES = np.array([1.0, 0.85, 0.65, 0.45, 0.3, 0.2, 0.1, 0.04])
COUNTS = np.array([3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.77, 0.49])
# Shapes of the core whose Fresnel factors these are: 1, (1-c)⁵ and c (1-c)ⁿ with n = 6, 3, 12.
FACTORS = ("", "_schlick", "_dip", "_wide_dip", "_narrow_dip")
TINY = 1e-30  # beside squares of cosines


def metallic(
    base_color: Varying,
    edge_tint: Varying,
    roughness: Number,
    *,
    several_bounces: bool = False,
    distribution: Distribution = "ggx",
    anisotropy: Number = 0.0,
    rotation: Number = 0.0,
    tangent: Vector | None = None,
    thin_film_thickness: Number = 0.0,
    thin_film_ior: Number = 1.33,
    at: Vector | None = None,
) -> Shader:
    """Blender's Metallic BSDF by its colours: head-on, and the tint at 82° (Kutz, Hašan & Edmondson 2021).

    Arguments are clamped to 0 … 1; several_bounces: Multiscatter GGX; tangent: a world vector, needed where anisotropy
    is not 0, which rotation turns about the normal, in turns; thin_film_thickness: [nm]. Raises ValueError naming an
    argument that is not finite.
    """
    several = _only_of_ggx(several_bounces, distribution)
    f0, tint = (clamped(color(c, name)) for c, name in ((base_color, "base_color"), (edge_tint, "edge_tint")))
    r = clamp(number(roughness, "roughness"))
    n = _normal(at)
    stretch = aspect_stretch(r, number(anisotropy, "anisotropy"), rotation, tangent, n)
    r = mean_roughness(r, stretch)
    thin = film(thin_film_thickness, thin_film_ior)
    lobes = metal_lobes(color(1.0), f0, tint, r, n, several_bounces=several, distribution=distribution, thin=thin)
    return Shader(stretched(lobes, stretch))


def conductor(
    ior: Varying,
    extinction: Varying,
    roughness: Number,
    *,
    several_bounces: bool = False,
    distribution: Distribution = "ggx",
    anisotropy: Number = 0.0,
    rotation: Number = 0.0,
    tangent: Vector | None = None,
    thin_film_thickness: Number = 0.0,
    thin_film_ior: Number = 1.33,
    fresnel_model: FresnelModel = "exact",
    at: Vector | None = None,
) -> Shader:
    """Blender's Metallic BSDF by the index of refraction n + ik of each colour: Fresnel's curve for a conductor.

    The curve is a sum of five that have lobes; of common metals it is off by 1e-3, and by 4e-3 of the worst n and k,
    but where n² + k² is below 1: there light is reflected totally beyond an angle, and the curve has a kink.
    ior, extinction: n and k, at least 0; several_bounces: Multiscatter GGX, with the mean of the curve that Cycles
    estimates; fresnel_model: "exact", as since Blender 5.0, or before that "large_index", which holds for n² + k² much
    larger than 1; anisotropy and the rest: as of `metallic`. Raises ValueError naming an argument that is not finite.
    """
    checked_name("fresnel_model", fresnel_model, get_args(FresnelModel))
    reflectance = exact_reflectance if fresnel_model == "exact" else large_index_reflectance
    several = _only_of_ggx(several_bounces, distribution)
    n, k = (
        Color(*(maximum(c, 0.0) for c in color(of, name))) for of, name in ((ior, "ior"), (extinction, "extinction"))
    )
    r = clamp(number(roughness, "roughness"))
    normal_of_lobes = _normal(at)
    stretch = aspect_stretch(r, number(anisotropy, "anisotropy"), rotation, tangent, normal_of_lobes)
    r = mean_roughness(r, stretch)
    own = color(1.0)
    cosine = clamp(dot(towards_viewer(), normal_of_lobes), 1e-4)
    if several:
        f0, edge = reflectance(1.0, n, k), reflectance(1.0 - EDGE, n, k)
        dip = (mixed(f0, 1.0, EDGE**5) - edge) * (7.0 / EDGE**6)
        mean = clamped(mixed(f0, 1.0, 1.0 / 21.0) - dip * (1.0 / 126.0))
        own = bounces(r, cosine, mean)
    thin = film(thin_film_thickness, thin_film_ior)
    if thin is None:
        known = [reflectance(float(c), n, k) for c in COSINES]
        curve: dict[str, Vector] = {
            factor: sum((of * float(share) for of, share in zip(known, shares, strict=True)), start=vector(0.0))
            for factor, shares in zip(FACTORS, shares_of_known(), strict=True)
        }
    else:
        curve = dict(zip(films.FACTORS, films.film_factors(thin, cosine, r * r, n, k), strict=True))
    lobes = sum_of_lobes(own, curve, r * r, normal_of_lobes, several_bounces=several, distribution=distribution)
    return Shader(stretched(lobes, stretch))


def large_index_reflectance(cosine: float, n: Color, k: Color) -> Color:
    """The share of light that a conductor reflects, by Fresnel's equations for n² + k² much larger than 1."""
    square = n * n + k * k

    def part(far: Vector, near: Vector) -> Vector:
        between = n * (2.0 * cosine)
        return (far + near - between) / (far + near + between)

    return color((part(square * (cosine * cosine), vector(1.0)) + part(square, vector(cosine * cosine))) * 0.5)


def exact_reflectance(cosine: float, n: Color, k: Color) -> Color:
    """The same for any n and k (Born & Wolf, "Principles of Optics", 14.4.1); refracted light has the cosine u + iv,
    times n + ik."""
    c2, s2 = cosine * cosine, 1.0 - cosine * cosine

    def of_channel(n: Value, k: Value) -> Value:
        real, imaginary = n * n - k * k - s2, n * k * 2.0
        size = sqrt(real * real + imaginary * imaginary)
        u, v2 = sqrt(maximum((size + real) * 0.5, 0.0)), maximum((size - real) * 0.5, 0.0)

        def quotient(product: Value, rest: Value) -> Value:
            return (rest - product + TINY) / (rest + product + TINY)

        s = quotient(u * (2.0 * cosine), u * u + v2 + c2)
        return s * (1.0 + quotient(u * (2.0 * cosine * s2), (u * u + v2) * c2 + s2 * s2)) * 0.5

    return Color(*(of_channel(*of) for of in zip(n, k, strict=True)))


@lru_cache(maxsize=1)
def shares_of_known() -> NDArray[np.float64]:
    """(5, 8): how much of each Fresnel factor a curve has, as sums of its values at COSINES, by least squares."""
    c = COSINES
    factors = np.stack([np.ones_like(c), (1 - c) ** 5, *(c * (1 - c) ** n for n in (6, 3, 12))], axis=-1)
    return np.linalg.pinv(factors * COUNTS[:, None]) * COUNTS


def _only_of_ggx(several_bounces: bool, distribution: Distribution) -> bool:
    several = checked_flag("several_bounces", several_bounces)
    if checked_distribution(distribution) != "ggx" and several:
        raise ValueError(f"several_bounces is known for distribution 'ggx' alone, not for {distribution!r}")
    return several


def _normal(at: Vector | None) -> Vector:
    return reflecting_normal(normal() if at is None else vector(at, "at"))
