# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: what each type is in terms of `shlight.nodes`; and the table of all nodes."""

from __future__ import annotations

from typing import TypedDict

from shlight import nodes
from shlight.nodes import Shader, Vector
from shlight.nodes.films import LEAST_THICKNESS
from shlight.nodes.fresnel import fresnel_of
from shlight.nodes.inputs import towards_viewer
from shlight.nodes.microfacets import Distribution, aspect_stretch, dielectric_bounces, mean_roughness, stretched
from shlight.nodes.shader import Lobe, Refraction
from shlight.nodes.values import Color, Value, clamp, color, dot, maximum, number, sqrt

from ..compat import (
    BOUNCES_ARE_DIMMED,
    DIFFUSE_KEEPS_ENERGY,
    DIFFUSE_MODEL,
    FRESNEL_MODEL,
    LEAST_ANISOTROPY,
    PRINCIPLED_IS_LAYERED,
    SUBSURFACE_ENTRY_IS_DIFFUSE,
    SUBSURFACE_METHODS,
    THIN_FILM_MODEL,
)
from ..report import Effect
from .displacement import DISPLACEMENT_NODES
from .input_nodes import INPUT_NODES, around
from .nodes import NodeInputs, ReadNode, own_value, positive
from .noise_nodes import NOISE_NODES
from .script_nodes import SCRIPT_NODES
from .texture_nodes import TEXTURE_NODES
from .value_nodes import VALUE_NODES
from .volume_nodes import VOLUME_NODES

# Luminance with which Blender 3.4 takes the brightness out of the base colour for Specular Tint.
TINT_LUMINANCE = (0.3, 0.6, 0.1)
# Distributions of microfacets by Blender's names; the rest are GGX.
DISTRIBUTIONS: dict[str, Distribution] = {"BECKMANN": "beckmann", "ASHIKHMIN_SHIRLEY": "ashikhmin_shirley"}


# Inputs of the layered Principled BSDF, which are arguments of `nodes.principled`.
PRINCIPLED_NUMBERS = (
    "Metallic", "Roughness", "IOR", "Alpha", "Diffuse Roughness", "Specular IOR Level", "Coat Weight",
    "Coat Roughness", "Coat IOR", "Sheen Weight", "Sheen Roughness", "Transmission Weight", "Emission Strength",
    "Anisotropic", "Anisotropic Rotation",
    "Subsurface Weight", "Subsurface Scale", "Subsurface IOR",
)  # fmt: skip
PRINCIPLED_COLORS = ("Specular Tint", "Coat Tint", "Sheen Tint", "Emission Color")


def read_principled(inputs: NodeInputs) -> Shader:
    """Shader of a Principled BSDF node."""
    return _read_layered(inputs) if PRINCIPLED_IS_LAYERED else _read_sum(inputs)


def _tangent(inputs: NodeInputs) -> Vector:
    return inputs.vector_or("Tangent", around("Z"))


class _ThinFilm(TypedDict, total=False):
    """Arguments of `shlight.nodes` for a thin film."""

    thin_film_thickness: Value
    thin_film_ior: Value


def _thin_film(inputs: NodeInputs) -> _ThinFilm:
    """None of nodes that have no such inputs, which differ between versions."""
    if "Thin Film Thickness" not in inputs.node.inputs:
        return {}
    return {
        "thin_film_thickness": inputs.number("Thin Film Thickness"),
        "thin_film_ior": inputs.number("Thin Film IOR"),
    }


def _remark_film_inside(inputs: NodeInputs, thin: _ThinFilm) -> None:
    """Reports a film on a transparent body."""
    thickness = thin["thin_film_thickness"].constant if thin else 0.0
    if thickness is None or thickness > LEAST_THICKNESS:
        inputs.remark("its thin film is not seen from inside of the body", Effect.SLIGHT)


# Inputs that some versions have, and what is drawn whatever they say.
UNREAD = {
    "Transmission Dispersion Scale": "dispersion is not supported; light of all colours is bent alike",
    "Anisotropy": "anisotropic glass is not supported; it is drawn as if Anisotropy were 0",
}


def _remark_unread(inputs: NodeInputs, name: str) -> None:
    if name in inputs.node.inputs and inputs.number(name).constant != 0.0:
        inputs.remark(UNREAD[name])


def _is_thin_wall(inputs: NodeInputs, film: _ThinFilm) -> bool:
    """Whether the node is a wall without thickness; reports what of it is drawn otherwise."""
    thin = inputs.number("Thin Wall").constant if "Thin Wall" in inputs.node.inputs else 0.0
    if thin is None:
        inputs.remark("a 'Thin Wall' that varies is not supported; it is drawn as off")
    through = inputs.number("Transmission Weight").constant
    if thin and through != 0.0 and inputs.number("Roughness").constant != 0.0:
        inputs.remark("what passes through a rough thin wall is sharp")
    if thin and through != 0.0 and film and film["thin_film_thickness"].constant != 0.0:
        inputs.remark("the film on a thin wall is left out")
    if thin and 0.0 not in (inputs.number(name).constant for name in ("Subsurface Weight", "Diffuse Roughness")):
        inputs.remark("light passes a rough thin wall as it passes a smooth one", Effect.SLIGHT)
    return bool(thin)


def _scattered_cosine(inputs: NodeInputs, name: str) -> Value:
    """The mean cosine of directions that are scattered below the surface, as far back as this version lets them go."""
    return maximum(inputs.number(name), LEAST_ANISOTROPY)


def _read_layered(inputs: NodeInputs) -> Shader:
    metallic = inputs.number("Metallic").constant
    if metallic != 0.0:
        inputs.remark_nothing_reflected()
    thin = _thin_film(inputs)
    is_thin_wall = _is_thin_wall(inputs, thin)
    if inputs.number("Transmission Weight").constant != 0.0 and not is_thin_wall:
        inputs.remark_glass("'Transmission Weight'")
        _remark_film_inside(inputs, thin)
        _remark_unread(inputs, "Transmission Dispersion Scale")
    index = inputs.number("IOR").constant
    if index is not None and index < 1.0 and metallic != 1.0:
        inputs.remark("an 'IOR' below 1 reflects as its reciprocal does")
    given: dict[str, Value | Color] = {name: inputs.number(name) for name in PRINCIPLED_NUMBERS}
    if inputs.is_linked("Normal") and given["Diffuse Roughness"].constant != 0.0:
        inputs.remark_rough_bumps()
    given |= {name: inputs.color(name) for name in PRINCIPLED_COLORS}
    return nodes.principled(
        inputs.color("Base Color"),
        coat_normal=inputs.linked_vector("Coat Normal"),
        subsurface_radius=inputs.vector("Subsurface Radius"),
        subsurface_method=SUBSURFACE_METHODS[inputs.node.subsurface_method],
        subsurface_anisotropy=_scattered_cosine(inputs, "Subsurface Anisotropy"),
        thin_wall=is_thin_wall,
        several_bounces=inputs.node.distribution == "MULTI_GGX",
        tangent=_tangent(inputs),
        at=inputs.linked_vector("Normal"),
        thin_film_model=THIN_FILM_MODEL,
        diffuse_model=DIFFUSE_MODEL,
        **thin,
        **{name.lower().replace(" ", "_"): value for name, value in given.items()},
    )


def _read_sum(inputs: NodeInputs) -> Shader:
    base = positive(inputs.color("Base Color"))
    metallic = clamp(inputs.number("Metallic"))
    if metallic.constant != 0.0:
        inputs.remark_nothing_reflected()
    roughness = clamp(inputs.number("Roughness"))
    specular = maximum(inputs.number("Specular"), 0.0)
    tint = inputs.number("Specular Tint")
    alpha = clamp(inputs.number("Alpha"))
    at = inputs.diffuse_normal()
    glow = nodes.emission(inputs.color("Emission") * inputs.number("Emission Strength"))
    transmission = clamp(inputs.number("Transmission"))
    if transmission.constant != 0.0:
        inputs.remark_glass("'Transmission'")
    coat = maximum(inputs.number("Clearcoat"), 0.0)
    through = transmission * (1.0 - metallic)
    diffuse = (1.0 - metallic) * (1.0 - transmission)
    surface = _diffuse_of_sum(inputs, base, roughness, at) * diffuse
    luminance = sum((c * w for c, w in zip(base, TINT_LUMINANCE, strict=True)), start=number(0.0))
    hue = Color(*(nodes.values.select(luminance > 0.0, c / luminance, 1.0) for c in base))
    sheen, sheen_tint = maximum(inputs.number("Sheen"), 0.0), clamp(inputs.number("Sheen Tint"))
    if sheen.constant != 0.0:
        surface += nodes.disney_sheen((hue * sheen_tint + (1.0 - sheen_tint)) * sheen * diffuse, at=at)
    f0 = (hue * tint + (1.0 - tint)) * (0.08 * specular) * (1.0 - metallic) + base * metallic
    f0 = Color(*(clamp(c) for c in f0))
    ior = 2.0 / (1.0 - sqrt(nodes.values.minimum(0.08 * specular, 0.99))) - 1.0
    n = nodes.reflecting_normal(nodes.normal()) if at is None else at
    width = roughness * roughness
    if not (specular.constant == 0.0 and metallic.constant == 0.0):
        share, turns = inputs.number("Anisotropic"), inputs.number("Anisotropic Rotation")
        stretch = aspect_stretch(roughness, share, turns, _tangent(inputs), n)
        several = inputs.node.distribution == "MULTI_GGX"
        own = color(1.0)
        if several:
            _remark_several_bounces(inputs)
            cosine = clamp(dot(towards_viewer(), n), 1e-4)
            own = dielectric_bounces(mean_roughness(roughness, stretch), cosine, f0, ior)
        lobes = (
            Lobe("ggx", color(own * f0), width, n, several_bounces=several),
            *nodes.rising_lobes(own * (1.0 - f0), ior, width, n, several_bounces=several),
        )
        surface += Shader(stretched(lobes, stretch)) * (1.0 - through)
    if coat.constant != 0.0:
        coat_at = inputs.linked_vector("Clearcoat Normal")
        surface += nodes.disney_clearcoat(coat, inputs.number("Clearcoat Roughness"), at=coat_at)
    if through.constant != 0.0:
        surface += _glass_of_sum(inputs, base, hue=color(base * tint + (1.0 - tint)), roughness=roughness) * through
    return nodes.transparent(1.0 - alpha) + (surface + glow) * alpha


def _diffuse_of_sum(inputs: NodeInputs, base: Color, roughness: Value, at: Vector | None) -> Shader:
    """The diffuse part of Blender 3.4's node, of which all comes from below the surface where 'Subsurface' is not 0."""
    share = inputs.number("Subsurface")
    if share.constant == 0.0:
        return nodes.disney_diffuse(base, roughness, at=at)
    return nodes.disney_subsurface(
        positive(base * (1.0 - share) + inputs.color("Subsurface Color") * share),
        roughness,
        inputs.vector("Subsurface Radius") * share,
        method=SUBSURFACE_METHODS[inputs.node.subsurface_method],
        ior=inputs.number("Subsurface IOR"),
        anisotropy=_scattered_cosine(inputs, "Subsurface Anisotropy"),
        diffuse_entry=SUBSURFACE_ENTRY_IS_DIFFUSE,
        at=at,
    )


def _glass_of_sum(inputs: NodeInputs, base: Color, *, hue: Color, roughness: Value) -> Shader:
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


def _subsurface(inputs: NodeInputs) -> Shader:
    tint, own = positive(inputs.color("Color")), inputs.node.falloff
    return nodes.subsurface(
        tint,
        inputs.vector("Radius") * inputs.number("Scale"),
        method=SUBSURFACE_METHODS[own],
        roughness=sqrt(inputs.number("Roughness")),
        ior=inputs.number("IOR"),
        anisotropy=_scattered_cosine(inputs, "Anisotropy"),
        diffuse_entry=SUBSURFACE_ENTRY_IS_DIFFUSE,
        at=inputs.linked_vector("Normal"),
    )


def _sheen(inputs: NodeInputs) -> Shader:
    """Shader of a Sheen BSDF, or of a Velvet BSDF, which has no distribution and another name for its roughness."""
    made = nodes.microfibre if getattr(inputs.node, "distribution", "") == "MICROFIBER" else nodes.velvet
    width = inputs.number("Sigma" if inputs.node.type == "BSDF_VELVET" else "Roughness")
    return made(inputs.color("Color"), width, at=inputs.linked_vector("Normal"))


def _toon(inputs: NodeInputs) -> Shader:
    size, smooth = inputs.number("Size"), inputs.number("Smooth")
    is_glossy, at = inputs.node.component == "GLOSSY", inputs.linked_vector("Normal")
    return nodes.toon(positive(inputs.color("Color")), size, smooth, glossy=is_glossy, at=at)


def _diffuse(inputs: NodeInputs) -> Shader:
    roughness, at = inputs.number("Roughness"), inputs.diffuse_normal()
    if at is not None and roughness.constant != 0.0:
        inputs.remark_rough_bumps()
    return nodes.oren_nayar(
        positive(inputs.color("Color")),
        roughness,
        several_bounces=DIFFUSE_KEEPS_ENERGY,
        diffuse_model=DIFFUSE_MODEL,
        at=at,
    )


class _Microfacets(TypedDict):
    """Arguments of `shlight.nodes` that a node's distribution of microfacets decides."""

    distribution: Distribution
    several_bounces: bool
    at: Vector | None


class _Anisotropy(TypedDict, total=False):
    """Arguments of `shlight.nodes` by which microfacets have two widths."""

    anisotropy: Value
    rotation: Value
    tangent: Vector


def _remark_several_bounces(inputs: NodeInputs) -> None:
    """Reports what Blender 3.4 found by following light from microfacet to microfacet."""
    inputs.remark("Multiscatter GGX spreads light as since Blender 4", Effect.SLIGHT)


def _microfacets(inputs: NodeInputs) -> _Microfacets:
    own = inputs.node.distribution
    distribution: Distribution = DISTRIBUTIONS.get(own, "ggx")
    return {
        "distribution": distribution,
        "several_bounces": own == "MULTI_GGX",
        "at": inputs.linked_vector("Normal"),
    }


def _anisotropy(inputs: NodeInputs) -> _Anisotropy:
    """None of Blender 3.4's Glossy BSDF, which has no such inputs."""
    if "Anisotropy" not in inputs.node.inputs:
        return {}
    share, turns = inputs.number("Anisotropy"), inputs.number("Rotation")
    return {"anisotropy": share, "rotation": turns, "tangent": _tangent(inputs)}


def _roughness(inputs: NodeInputs) -> Value:
    """The roughness of a node with a distribution of microfacets."""
    return number(0.0) if inputs.node.distribution == "SHARP" else inputs.number("Roughness")


def _glossy(inputs: NodeInputs) -> Shader:
    inputs.remark_nothing_reflected()
    tint, roughness = inputs.color("Color"), _roughness(inputs)
    rest, stretch = _microfacets(inputs), _anisotropy(inputs)
    whole = nodes.glossy(tint, roughness, **rest, **stretch)
    if not (BOUNCES_ARE_DIMMED and rest["several_bounces"]):
        return whole
    _remark_several_bounces(inputs)
    rest["several_bounces"] = False
    share = Color(*(clamp(c) for c in tint))
    return whole * share + nodes.glossy(tint, roughness, **rest, **stretch) * (1.0 - share)


def _metallic(inputs: NodeInputs) -> Shader:
    inputs.remark_nothing_reflected()
    roughness, rest, stretch = inputs.number("Roughness"), _microfacets(inputs), _anisotropy(inputs)
    thin = _thin_film(inputs)
    if inputs.node.fresnel_type == "F82":
        return nodes.metallic(
            inputs.color("Base Color"), inputs.color("Edge Tint"), roughness, **rest, **stretch, **thin
        )
    n, k = inputs.color("IOR"), inputs.color("Extinction")
    return nodes.conductor(n, k, roughness, fresnel_model=FRESNEL_MODEL, **rest, **stretch, **thin)


def _glass(inputs: NodeInputs) -> Shader:
    inputs.remark_glass(inputs.node.bl_label)
    tint, ior, roughness = inputs.color("Color"), inputs.number("IOR"), _roughness(inputs)
    if inputs.node.type == "BSDF_REFRACTION":
        kind = DISTRIBUTIONS.get(inputs.node.distribution, "ggx")
        return nodes.refraction(tint, roughness, ior, distribution=kind, at=inputs.linked_vector("Normal"))
    _remark_unread(inputs, "Anisotropy")
    thin = _thin_film(inputs)
    _remark_film_inside(inputs, thin)
    return nodes.glass(tint, roughness, ior, **thin, **_microfacets(inputs))


def emission(inputs: NodeInputs) -> Shader:
    """Shader of an Emission node, or of a world's Background."""
    return nodes.emission(inputs.color("Color") * inputs.number("Strength"))


def _mix(inputs: NodeInputs) -> Shader:
    factor = inputs.number(0)
    # The two shader inputs share their name; a branch of weight 0 does not show and is not even looked at.
    if factor.constant is not None and factor.constant <= 0.0:
        return inputs.shader(1)
    if factor.constant is not None and factor.constant >= 1.0:
        return inputs.shader(2)
    return nodes.mix(inputs.shader(1), inputs.shader(2), factor)


SHADERS: dict[str, ReadNode] = {
    "BSDF_ANISOTROPIC": _glossy,
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_GLASS": _glass,
    "BSDF_GLOSSY": _glossy,
    "BSDF_METALLIC": _metallic,
    "BSDF_PRINCIPLED": read_principled,
    "BSDF_REFRACTION": _glass,
    "BSDF_SHEEN": _sheen,
    "BSDF_TOON": _toon,
    "BSDF_VELVET": _sheen,
    "SUBSURFACE_SCATTERING": _subsurface,
    "BSDF_TRANSLUCENT": lambda i: nodes.translucent(positive(i.color("Color")), i.linked_vector("Normal")),
    "BSDF_TRANSPARENT": lambda inputs: nodes.transparent(inputs.color("Color")),
    "EMISSION": emission,
    "MIX_SHADER": _mix,
    "ADD_SHADER": lambda inputs: inputs.shader(0) + inputs.shader(1),
}
NODES: dict[str, ReadNode] = {
    "VALUE": lambda inputs: own_value(inputs.output),
    "RGB": lambda inputs: own_value(inputs.output),
    **TEXTURE_NODES,
    **NOISE_NODES,
    **SCRIPT_NODES,
    **INPUT_NODES,
    **VALUE_NODES,
    **DISPLACEMENT_NODES,
    **SHADERS,
    **VOLUME_NODES,
}
