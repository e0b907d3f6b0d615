# SPDX-License-Identifier: MIT
"""Lobes of microfacets: reflection by metals and by interfaces, and bodies of glass."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple, get_args

from shlight._arrays import checked_name
from shlight.nodes import energy
from shlight.nodes.films import FACTORS, Film, film, film_factors, film_passes, unless_thin
from shlight.nodes.fresnel import head_on
from shlight.nodes.inputs import backfacing, geometric_normal, normal, towards_viewer
from shlight.nodes.shader import Lobe, Refraction, Shader
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    cross,
    dot,
    length,
    maximum,
    minimum,
    number,
    operation,
    select,
    sqrt,
    vector,
)

# Indices of refraction between which a varying one is interpolated.
IOR_NODES = (1.0 + 1e-4, 1.1, 1.25, 1.45, 1.7, 2.1, 2.8, 4.0, 8.0, 20.0)
# The cosine at which a tint of metals' edges is given, and what it is multiplied with there.
EDGE = 6.0 / 7.0

Distribution = Literal["ggx", "beckmann", "ashikhmin_shirley"]  # of microfacets' normals


def checked_distribution(distribution: Distribution) -> Distribution:
    """The distribution. Raises ValueError if there is none of this name."""
    checked_name("distribution", distribution, get_args(Distribution))
    return distribution


def mixed(a: Vector, b: Varying, share: Varying) -> Color:
    return color(a + (color(b) - a) * share)


def largest(c: Vector) -> Value:
    return maximum(maximum(c.x, c.y), c.z)


def clamped(c: Vector) -> Color:
    return Color(*(clamp(component) for component in c))


def reflecting_normal(n: Vector) -> Vector:
    """The normal, turned towards the triangle's own until the mirror image of the viewer is above the triangle.

    As Cycles turns normals of glossy reflections (`ensure_valid_specular_reflection`): the mirror image is lifted to
    a cosine of min(0.01, 0.9 of the view's).
    """
    to_viewer, up = towards_viewer(), geometric_normal()
    view_height = dot(to_viewer, up)
    reflected_height = 2.0 * dot(n, to_viewer) * dot(n, up) - view_height
    least = minimum(0.9 * view_height, 0.01)
    across = n - up * dot(n, up)
    across_length = length(across)
    x = Vector(*(select(across_length > 0.0, a / across_length, b) for a, b in zip(across, n, strict=True)))
    ix = dot(to_viewer, x)
    a = ix * ix + view_height * view_height
    b = 2.0 * (a + view_height * least)
    c = (least + view_height) * (least + view_height)
    root = sqrt(b * b - 4.0 * a * c)
    height_squared = clamp(0.25 * (b + select(ix < 0.0, root, -root)) / a)
    turned = x * sqrt(1.0 - height_squared) + up * sqrt(height_squared)
    return Vector(*(select(reflected_height < least, t, own) for t, own in zip(turned, n, strict=True)))


class Stretch(NamedTuple):
    """Microfacets with two widths: alpha along and across a tangent of the surface, and that vector."""

    along: Value
    across: Value
    tangent: Vector


def turned_about(tangent: Vector | None, n: Vector, rotation: Number, anisotropy: str) -> Vector:
    """A tangent, turned about a normal by so many turns. anisotropy: the argument that a tangent is needed for."""
    if tangent is None:
        raise ValueError(f"tangent must be given where {anisotropy} is not 0")
    turns, t = number(rotation, "rotation"), vector(tangent, "tangent")
    if turns.constant == 0.0:
        return t
    angle = turns * (2.0 * math.pi)
    return t * operation("cosine", angle) + cross(n, t) * operation("sine", angle)


def aspect_stretch(
    roughness: Value,
    share: Value,
    rotation: Number,
    tangent: Vector | None,
    n: Vector,
    anisotropy: str = "anisotropy",
) -> Stretch | None:
    """The widths of Burley 2012: of an anisotropy of 1 they are as 10 to 1, the larger one along the tangent.

    None without anisotropy. anisotropy: the argument that `share` is given by.
    """
    if (own := clamp(share)).constant == 0.0:
        return None
    aspect = sqrt(1.0 - 0.9 * own)
    square = roughness * roughness
    along = turned_about(tangent, n, rotation, anisotropy)
    return Stretch(clamp(square / aspect), clamp(square * aspect), along)


def mean_roughness(roughness: Value, stretch: Stretch | None) -> Value:
    """The roughness of the lobe that loses as much between microfacets."""
    return roughness if stretch is None else sqrt(sqrt(stretch.along * stretch.across))


def stretched(lobes: tuple[Lobe, ...], stretch: Stretch | None) -> tuple[Lobe, ...]:
    """Lobes of microfacets with two widths; as they are if there is no stretch."""
    if stretch is None:
        return lobes
    rest = (stretch.across, *stretch.tangent)
    return tuple(replace(own, kind=f"stretched_{own.kind}", alpha=stretch.along, rest=rest) for own in lobes)


def bounces(roughness: Value, cosine: Value, mean_fresnel: Color) -> Color:
    """The factor by which multiple scattering between microfacets brightens a lobe (Kulla & Conty 2017)."""
    return _brighter(energy.albedo(roughness, cosine), energy.mean_albedo(roughness), mean_fresnel)


def dielectric_bounces(roughness: Value, cosine: Value, f0: Color, ior: Value) -> Color:
    """The same of a lobe that reflects f0 along the normal, and rises to 1 as an interface of this index does."""
    mean = (ior - 1.0) / (4.08567 + 1.00071 * ior)
    base = head_on(ior)
    return bounces(roughness, cosine, mixed(f0, 1.0, clamp((mean - base) / (1.0 - base))))


def _brighter(own: Value, mean: Value, mean_fresnel: Color) -> Color:
    """own, mean: shares of light that are not lost, at the view and on average."""
    again = mean_fresnel * mean / (1.0 - mean_fresnel * (1.0 - mean))
    return color(1.0 + again * ((1.0 - own) / own))


def rising_lobes(
    weight: Vector,
    ior: Value,
    alpha: Value,
    at: Vector | None,
    *,
    several_bounces: bool = False,
    distribution: Distribution = "ggx",
) -> tuple[Lobe, ...]:
    """Lobes of the rise of Fresnel's curve; of a varying index by interpolation."""

    def lobe(own: Color, of_ior: float) -> Lobe:
        return Lobe(f"{distribution}_dielectric", own, alpha, at, of_ior, several_bounces)

    if ior.constant is not None:
        return (lobe(color(weight), max(ior.constant, 1.0 + 1e-6)),)
    lobes = []
    for i, node in enumerate(IOR_NODES):
        share: Value = number(1.0)
        if i > 0:
            share = minimum(share, (ior - IOR_NODES[i - 1]) / (node - IOR_NODES[i - 1]))
        if i + 1 < len(IOR_NODES):
            share = minimum(share, (IOR_NODES[i + 1] - ior) / (IOR_NODES[i + 1] - node))
        lobes.append(lobe(color(weight * maximum(share, 0.0)), node))
    return tuple(lobes)


def sum_of_lobes(
    weight: Vector,
    parts: Mapping[str, Varying],
    alpha: Value,
    at: Vector | None,
    *,
    several_bounces: bool,
    distribution: Distribution,
) -> tuple[Lobe, ...]:
    """Lobes that make up a curve, by how much of each Fresnel factor it has."""
    return tuple(
        Lobe(distribution + factor, color(weight * part), alpha, at, several_bounces=several_bounces)
        for factor, part in parts.items()
    )


def dielectric_lobes(
    weight: Vector,
    f0: Color,
    ior: Value,
    roughness: Value,
    at: Vector,
    *,
    several_bounces: bool,
    distribution: Distribution = "ggx",
    thin: Film | None = None,
) -> tuple[tuple[Lobe, ...], Color]:
    """Lobes of a dielectric interface, and the share of light that it lets through."""
    alpha = roughness * roughness
    cosine = clamp(dot(towards_viewer(), at), 1e-4)
    own = color(weight * 1.0)
    dimmed = color(1.0)
    if several_bounces:
        brighter = dielectric_bounces(roughness, cosine, f0, ior)
        own = color(own * brighter)
        dimmed = color(brighter * energy.albedo(roughness, cosine))
    reflected = mixed(f0, 1.0, energy.rise(roughness, cosine, ior))
    if thin is None:
        lobes = (
            Lobe(distribution, color(own * f0), alpha, at, several_bounces=several_bounces),
            *rising_lobes(own * (1.0 - f0), ior, alpha, at, several_bounces=several_bounces, distribution=distribution),
        )
    else:
        tint = f0 / head_on(thin.below)
        parts = dict(zip(FACTORS, film_factors(thin, cosine, alpha, thin.below, scale=tint), strict=True))
        lobes = sum_of_lobes(own, parts, alpha, at, several_bounces=several_bounces, distribution=distribution)
        reflected = unless_thin(thin, film_factors(thin, cosine, 0.0, thin.below, scale=tint)[0], reflected)
    return lobes, color(clamp(1.0 - largest(reflected * dimmed)))


def metal_lobes(
    weight: Vector,
    f0: Color,
    edge_tint: Color,
    roughness: Value,
    at: Vector,
    *,
    several_bounces: bool,
    distribution: Distribution = "ggx",
    thin: Film | None = None,
) -> tuple[Lobe, ...]:
    """Lobes of a metal: Schlick's curve, less what a tint takes away near 82° (Kutz et al. 2021).

    Under a film it has the index that Gulbrandsen 2014, "Artist Friendly Metallic Fresnel", gives it by its reflectance
    along the normal and that near 82°.
    """
    alpha = roughness * roughness
    schlick = mixed(f0, 1.0, EDGE**5)
    dip = color(schlick * (7.0 / EDGE**6) * (1.0 - edge_tint))
    own = color(weight * 1.0)
    cosine = clamp(dot(towards_viewer(), at), 1e-4)
    if several_bounces:
        own = color(own * bounces(roughness, cosine, color(mixed(f0, 1.0, 1.0 / 21.0) - dip * (1.0 / 126.0))))
    parts: dict[str, Vector]
    if thin is None:
        parts = {"": f0, "_schlick": 1.0 - f0, "_dip": -dip}
        if dip.constant == (0.0, 0.0, 0.0):
            del parts["_dip"]
    else:
        facing, edge = (Color(*(minimum(c, 0.999) for c in f0)), clamped(schlick * edge_tint))
        root = Color(*(sqrt(c) for c in facing))
        n = mixed(color((1.0 + root) / (1.0 - root)), (1.0 - facing) / (1.0 + facing), edge)
        square = (facing * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - facing)
        k = Color(*(sqrt(c) for c in square))
        parts = dict(zip(FACTORS, film_factors(thin, cosine, alpha, n, k, edge), strict=True))
    return sum_of_lobes(own, parts, alpha, at, several_bounces=several_bounces, distribution=distribution)


def glossy(
    tint: Varying,
    roughness: Number,
    *,
    several_bounces: bool = False,
    distribution: Distribution = "ggx",
    anisotropy: Number = 0.0,
    rotation: Number = 0.0,
    tangent: Vector | None = None,
    at: Vector | None = None,
) -> Shader:
    """Microfacets without Fresnel's factor: Blender's Glossy BSDF. several_bounces: of GGX alone.

    anisotropy: clamped to -0.99 … 0.99; roughness² is multiplied with 1 - anisotropy along the tangent, a world vector,
    and divided by it across it; of a negative one 1 + anisotropy the other way round. rotation: turns of the tangent
    about the normal. Raises ValueError naming an argument.
    """
    kind = checked_distribution(distribution)
    share = clamp(number(anisotropy, "anisotropy"), -0.99, 0.99)
    c = Color(*(maximum(component, 0.0) for component in color(tint, "tint")))
    n = reflecting_normal(normal() if at is None else at)
    r = clamp(number(roughness, "roughness"))
    stretch = None
    if share.constant != 0.0:
        less = 1.0 - abs(share)
        ratio = select(share < 0.0, 1.0 / less, less)
        along = turned_about(tangent, n, rotation, "anisotropy")
        stretch = Stretch(clamp(r * r * ratio), clamp(r * r / ratio), along)
    weight = c
    if several_bounces:
        cosine = clamp(dot(towards_viewer(), n), 1e-4)
        weight = color(c * bounces(mean_roughness(r, stretch), cosine, clamped(c)))
    return Shader(stretched((Lobe(kind, weight, r * r, n, several_bounces=several_bounces),), stretch))


def interface_lobes(
    weight: Color,
    f0: Color,
    ior: Value,
    roughness: Value,
    at: Vector,
    *,
    tint: Color,
    several_bounces: bool,
    distribution: Distribution = "ggx",
    thin: Film | None = None,
) -> tuple[Shader, Color]:
    """The reflection of a transparent body's front, and a factor of the light that goes through."""
    front = color(weight * (1.0 - backfacing()))
    index = maximum(ior, 1.0 / ior)
    cosine = clamp(dot(towards_viewer(), at), 1e-4)
    passed = color(1.0)
    if thin is not None:
        passed = mixed(film_passes(thin, cosine), 1.0, backfacing())
    if several_bounces:
        inside = select(ior < 1.0, 1.0 - backfacing(), backfacing())
        kept = energy.interface(roughness, cosine, index, inside)
        brighter = _brighter(kept, energy.mean_interface(roughness, index, inside), tint)
        front, passed = color(front * brighter), color(passed * brighter)
    lobes, _ = dielectric_lobes(
        front, f0, index, roughness, at, several_bounces=False, distribution=distribution, thin=thin
    )
    return Shader(lobes), passed


def glass(
    tint: Varying,
    roughness: Number,
    ior: Number = 1.5,
    *,
    several_bounces: bool = False,
    distribution: Distribution = "ggx",
    thin_film_thickness: Number = 0.0,
    thin_film_ior: Number = 1.33,
    at: Vector | None = None,
) -> Shader:
    """A transparent body: Blender's Glass BSDF. It shows what is behind where light bounces.

    What goes through is bent by Beckmann's microfacets, or else GGX's, whatever the distribution.
    thin_film_thickness: [nm], of a film outside of the body.
    """
    kind = checked_distribution(distribution)
    c = clamped(color(tint, "tint"))
    r = clamp(number(roughness, "roughness"))
    index = maximum(number(ior, "ior"), 1e-5)
    n = reflecting_normal(normal() if at is None else at)
    thin = film(thin_film_thickness, thin_film_ior)
    if thin is not None:
        thin = thin._replace(below=index)
    several: dict[str, Any] = {"several_bounces": several_bounces, "distribution": kind}
    front, passed = interface_lobes(c, color(head_on(index)), index, r, n, tint=c, thin=thin, **several)
    through = Refraction(color(c * passed), r * r, index, at, is_beckmann=kind == "beckmann")
    return front + Shader(refractions=(through,))


def refraction(
    tint: Varying,
    roughness: Number,
    ior: Number = 1.5,
    *,
    distribution: Distribution = "ggx",
    at: Vector | None = None,
) -> Shader:
    """The light that goes through an interface alone: Blender's Refraction BSDF. distribution: see glass()."""
    is_beckmann = checked_distribution(distribution) == "beckmann"
    r = clamp(number(roughness, "roughness"))
    index = maximum(number(ior, "ior"), 1e-5)
    weight = clamped(color(tint, "tint"))
    return Shader(refractions=(Refraction(weight, r * r, index, at, reflects=False, is_beckmann=is_beckmann),))
