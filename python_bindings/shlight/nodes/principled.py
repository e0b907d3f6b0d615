# SPDX-License-Identifier: MIT
"""The Principled BSDF of Blender 4: sheets of lobes, each of which the lower ones see through."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple, get_args

from shlight._arrays import checked_flag, checked_name
from shlight.nodes import energy
from shlight.nodes.fabrics import microfibre, microfibre_albedo
from shlight.nodes.films import FACTORS, Film, FilmModel, film, film_factors, film_passes, unless_thin
from shlight.nodes.fresnel import head_on
from shlight.nodes.inputs import backfacing, geometric_normal, normal, towards_viewer
from shlight.nodes.shader import Lobe, Refraction, Shader, emission, lambert, transparent
from shlight.nodes.subsurface import SubsurfaceMethod, checked_method, subsurface
from shlight.nodes.thin_walls import leaf, thin_glass
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
    normalize,
    number,
    operation,
    reflectance,
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


def _largest(c: Vector) -> Value:
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


def _dielectric(
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
    return lobes, color(clamp(1.0 - _largest(reflected * dimmed)))


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


def _oren_nayar_rise(cosine: Value) -> Value:
    """Fujii's G of the improved Oren–Nayar model."""
    sine = sqrt(1.0 - cosine * cosine)
    angle = operation("arccosine", cosine)
    whole = sine * (angle - 2.0 / 3.0 - sine * cosine) + 2.0 / 3.0 * (sine / cosine) * (1.0 - sine * sine * sine)
    return select(cosine < 1e-6, (math.pi / 2 - 2.0 / 3.0) - cosine, whole)


DiffuseModel = Literal["dimmed", "openpbr"]


def oren_nayar(
    albedo: Varying,
    sigma: Number,
    *,
    several_bounces: bool = True,
    diffuse_model: DiffuseModel = "dimmed",
    at: Vector | None = None,
) -> Shader:
    """A rough diffuse surface: the improved Oren–Nayar model of Fujii with the light of several bounces (OpenPBR).

    It is a sum of three shapes without parameters: Lambert's, the same times 1 + t, where t is what light and view have
    in common along the surface, and what the model's first bounce loses. sigma: 0 … 1, clamped.
    several_bounces: the last is there, as in Cycles since Blender 4.3. diffuse_model: "dimmed" multiplies it by the
        albedo once more than light bounces, as before Blender 5.3; "openpbr" does not.
    """
    checked_name("diffuse_model", diffuse_model, get_args(DiffuseModel))
    rho = reflectance(albedo, "albedo")
    rough = clamp(number(sigma, "sigma"))
    if rough.constant == 0.0:
        return lambert(rho, at)
    edge = math.pi / 2 - 2.0 / 3.0
    a = 1.0 / (math.pi + rough * edge)
    b = rough * a
    first = Shader(
        (
            Lobe("lambert", color(rho * (a * (1.0 - rough) * math.pi)), normal=at),
            Lobe("oren_nayar", color(rho * b), normal=at),
        )
    )
    if not checked_flag("several_bounces", several_bounces):
        return first
    n = normal() if at is None else at
    own = a * math.pi + b * _oren_nayar_rise(maximum(dot(towards_viewer(), n), 0.0))
    mean = a * math.pi + b * ((2.0 * math.pi - 5.6) / 3.0)
    saturated = clamped(rho)
    dimmed = saturated * saturated if diffuse_model == "dimmed" else saturated
    again = dimmed * ((mean / (1.0 - mean)) / math.pi) / (1.0 - saturated * (1.0 - mean))
    varies = select(rough > 0.0, 1.0, 0.0)
    return first + Shader((Lobe("oren_nayar_loss", color(rho * again * (1.0 - own) * b * varies), normal=at),))


def _interface(
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
    lobes, _ = _dielectric(front, f0, index, roughness, at, several_bounces=False, distribution=distribution, thin=thin)
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

    What goes through is bent by GGX's microfacets, whatever the distribution. thin_film_thickness: [nm], of a film
    outside of the body.
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
    front, passed = _interface(c, color(head_on(index)), index, r, n, tint=c, thin=thin, **several)
    return front + Shader(refractions=(Refraction(color(c * passed), r * r, index, at),))


def refraction(tint: Varying, roughness: Number, ior: Number = 1.5, *, at: Vector | None = None) -> Shader:
    """The light that goes through an interface alone: Blender's Refraction BSDF."""
    r = clamp(number(roughness, "roughness"))
    index = maximum(number(ior, "ior"), 1e-5)
    return Shader(refractions=(Refraction(clamped(color(tint, "tint")), r * r, index, at, reflects=False),))


def principled(
    base_color: Varying = (0.8, 0.8, 0.8),
    *,
    metallic: Number = 0.0,
    roughness: Number = 0.5,
    ior: Number = 1.5,
    alpha: Number = 1.0,
    diffuse_roughness: Number = 0.0,
    specular_ior_level: Number = 0.5,
    specular_tint: Varying = (1.0, 1.0, 1.0),
    coat_weight: Number = 0.0,
    coat_roughness: Number = 0.03,
    coat_ior: Number = 1.5,
    coat_tint: Varying = (1.0, 1.0, 1.0),
    coat_normal: Vector | None = None,
    sheen_weight: Number = 0.0,
    sheen_roughness: Number = 0.5,
    sheen_tint: Varying = (1.0, 1.0, 1.0),
    transmission_weight: Number = 0.0,
    emission_color: Varying = (1.0, 1.0, 1.0),
    emission_strength: Number = 0.0,
    anisotropic: Number = 0.0,
    anisotropic_rotation: Number = 0.0,
    tangent: Vector | None = None,
    subsurface_weight: Number = 0.0,
    subsurface_radius: Varying = (1.0, 0.2, 0.1),
    subsurface_scale: Number = 0.05,
    subsurface_ior: Number = 1.4,
    subsurface_anisotropy: Number = 0.0,
    subsurface_method: SubsurfaceMethod = "random_walk",
    thin_wall: bool = False,
    thin_film_thickness: Number = 0.0,
    thin_film_ior: Number = 1.33,
    thin_film_model: FilmModel = "spectral",
    diffuse_model: DiffuseModel = "dimmed",
    several_bounces: bool = False,
    at: Vector | None = None,
) -> Shader:
    """Blender's Principled BSDF.

    Arguments are the node's inputs, clamped as it clamps them; several_bounces: its distribution Multiscatter GGX; at:
    its normal; tangent: a world vector, needed where `anisotropic` is not 0; thin_film_thickness: [nm];
    thin_film_model: "spectral", as since Blender 5.0, or before that "gaussians", which approximates colours and has no
    films on metals; diffuse_model: see oren_nayar; thin_wall: the surface is a wall without thickness, which light
    passes on a straight way and unscattered, and which subsurface scattering makes a leaf. Raises ValueError naming an
    argument that is not finite.

    >>> paint = nodes.principled((0.6, 0.05, 0.02), roughness=0.4, coat_weight=1.0)
    >>> ball = shlight.Scene().add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], bsdf=paint)
    """
    base = Color(*(maximum(component, 0.0) for component in color(base_color, "base_color")))
    f0_of_metal = clamped(base)
    metal = clamp(number(metallic, "metallic"))
    rough = clamp(number(roughness, "roughness"))
    index = maximum(number(ior, "ior"), 1e-5)
    tint = Color(*(maximum(component, 0.0) for component in color(specular_tint, "specular_tint")))
    opaque = clamp(number(alpha, "alpha"))
    several = checked_flag("several_bounces", several_bounces)
    diffuse_width = number(diffuse_roughness, "diffuse_roughness")
    coat_width, coat_color = number(coat_roughness, "coat_roughness"), color(coat_tint, "coat_tint")
    below = clamp(number(subsurface_weight, "subsurface_weight"))
    far = color(subsurface_radius, "subsurface_radius") * number(subsurface_scale, "subsurface_scale")
    method, skin_index = (
        checked_method("subsurface_method", subsurface_method),
        number(subsurface_ior, "subsurface_ior"),
    )
    forward = number(subsurface_anisotropy, "subsurface_anisotropy")
    at = None if at is None else vector(at, "at")
    n = normal() if at is None else at
    glossy_normal = reflecting_normal(n)
    share, turns = number(anisotropic, "anisotropic"), number(anisotropic_rotation, "anisotropic_rotation")
    stretch = aspect_stretch(rough, share, turns, tangent, n, "anisotropic")
    glossy_width = mean_roughness(rough, stretch)

    thin = film(thin_film_thickness, thin_film_ior, thin_film_model)

    result = transparent(1.0 - opaque)
    weight = color(opaque)
    coat = maximum(number(coat_weight, "coat_weight"), 0.0)
    sheen = maximum(number(sheen_weight, "sheen_weight"), 0.0)
    sheen_color = Color(*(maximum(c, 0.0) for c in color(sheen_tint, "sheen_tint")))
    sheen_width = clamp(number(sheen_roughness, "sheen_roughness"))
    coat_smooth = normal() if coat_normal is None else vector(coat_normal, "coat_normal")
    if sheen.constant != 0.0:
        sheen_at = None if at is None and coat_normal is None else normalize(n + (coat_smooth - n) * clamp(coat))
        result += microfibre(sheen_color * sheen, sheen_width, at=sheen_at) * weight
        reflected = microfibre_albedo(sheen_width, normal() if sheen_at is None else sheen_at)
        weight = color(weight * clamp(1.0 - _largest(sheen_color) * sheen * reflected))
    if coat.constant != 0.0:
        coat_index = maximum(number(coat_ior, "coat_ior"), 1.0)
        coat_at = reflecting_normal(coat_smooth)
        lobes, passed = _dielectric(
            weight * coat, color(head_on(coat_index)), coat_index, clamp(coat_width), coat_at, several_bounces=True
        )
        result += Shader(lobes)
        # Weights of several lobes above 1 hide all that is below, as the sum of their shares does.
        weight = color(weight * clamp(1.0 - coat * (1.0 - passed.x)))
        weight = color(weight * _coat_color(coat_color, coat, coat_index, coat_at))
    result += (
        emission(color(emission_color, "emission_color") * number(emission_strength, "emission_strength")) * weight
    )

    if metal.constant != 0.0:
        edge = Color(*(minimum(component, 1.0) for component in tint))
        on_metal = thin if thin_film_model == "spectral" else None
        own_lobes = metal_lobes(
            weight * metal, f0_of_metal, edge, glossy_width, glossy_normal, several_bounces=several, thin=on_metal
        )
        result += Shader(stretched(own_lobes, stretch))
        weight = color(weight * (1.0 - metal))
    through = clamp(number(transmission_weight, "transmission_weight"))
    is_thin = checked_flag("thin_wall", thin_wall)
    if through.constant != 0.0 and is_thin:
        f0, bent = clamped(tint * head_on(index)), maximum(index, 1.0 / index)
        result += thin_glass(color(weight * through), base, f0, bent, rough * rough, glossy_normal)
        weight = color(weight * (1.0 - through))
    elif through.constant != 0.0:
        f0 = clamped(tint * head_on(index))
        own = color(weight * through)
        on_glass = None if thin is None else thin._replace(below=index)
        through_tint = Color(*(sqrt(clamp(component)) for component in base))
        inner: dict[str, Any] = {"tint": through_tint, "several_bounces": several, "thin": on_glass}
        front, passed = _interface(own, f0, index, rough, glossy_normal, **inner)
        result += front + Shader(
            refractions=(Refraction(color(own * through_tint * passed), rough * rough, index, at),)
        )
        weight = color(weight * (1.0 - through))
    if weight.constant == (0.0, 0.0, 0.0):
        return result
    level = maximum(number(specular_ior_level, "specular_ior_level"), 0.0)
    facing = head_on(index)
    if level.constant != 0.5:
        facing = facing * (2.0 * level)
        root = sqrt(clamp(facing, 0.0, 0.99))
        index = (1.0 + root) / (1.0 - root)
    index = maximum(index, 1.0 / index)
    if index.constant != 1.0 or thin is not None:
        f0 = clamped(tint * facing)
        if thin is not None:
            thin = thin._replace(below=select(number(ior) < 1.0, 1.0 / index, index))
        lobes, passed = _dielectric(weight, f0, index, glossy_width, glossy_normal, several_bounces=several, thin=thin)
        result += Shader(stretched(lobes, stretch))
        weight = color(weight * passed)
    diffuse = oren_nayar(base, diffuse_width, diffuse_model=diffuse_model, at=at)
    if below.constant != 0.0 and is_thin:
        return result + leaf(diffuse, f0_of_metal, below, forward, at) * weight
    if below.constant != 0.0:
        bent = skin_index if method == "random_walk_skin" else index
        body = subsurface(f0_of_metal, far, method=method, roughness=rough, ior=bent, anisotropy=forward, at=at)
        result += body * (weight * below)
        weight = color(weight * (1.0 - below))
    return result + diffuse * weight


def _coat_color(tint: Color, coat: Value, index: Value, at: Vector) -> Color:
    """The coat's transmittance: its tint, along the refracted path through it."""
    if tint.constant == (1.0, 1.0, 1.0):
        return color(1.0)
    cosine = dot(towards_viewer(), at)
    inside = sqrt(1.0 - (1.0 - cosine * cosine) / (index * index))
    passed = Color(*(operation("power", component, 1.0 / inside) for component in tint))
    return mixed(color(1.0), passed, coat)
