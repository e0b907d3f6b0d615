# SPDX-License-Identifier: MIT
"""The Principled BSDF of Blender 4: sheets of lobes, each of which the lower ones see through."""

from __future__ import annotations

from typing import Any

from shlight._arrays import checked_flag
from shlight.nodes.fabrics import microfibre, microfibre_albedo
from shlight.nodes.films import FilmModel, film
from shlight.nodes.fresnel import head_on
from shlight.nodes.inputs import normal, towards_viewer
from shlight.nodes.microfacets import (
    aspect_stretch,
    clamped,
    dielectric_lobes,
    interface_lobes,
    largest,
    mean_roughness,
    metal_lobes,
    mixed,
    reflecting_normal,
    stretched,
)
from shlight.nodes.rough_diffuse import DiffuseModel, oren_nayar
from shlight.nodes.shader import Refraction, Shader, emission, transparent
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
    dot,
    maximum,
    minimum,
    normalize,
    number,
    operation,
    select,
    sqrt,
    vector,
)


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
        weight = color(weight * clamp(1.0 - largest(sheen_color) * sheen * reflected))
    if coat.constant != 0.0:
        coat_index = maximum(number(coat_ior, "coat_ior"), 1.0)
        coat_at = reflecting_normal(coat_smooth)
        lobes, passed = dielectric_lobes(
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
        front, passed = interface_lobes(own, f0, index, rough, glossy_normal, **inner)
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
        lobes, passed = dielectric_lobes(
            weight, f0, index, glossy_width, glossy_normal, several_bounces=several, thin=thin
        )
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
