# SPDX-License-Identifier: MIT
"""Numbers and colours that vary over a surface, and materials made of them.

What these functions return stands where a constant stood: `Bsdf.lambert(nodes.image(pixels))`.
"""

from shlight.nodes import colors, inputs, mathematics, rays, values
from shlight.nodes.cells import Gabor, Voronoi, gabor, voronoi
from shlight.nodes.colors import mix_color
from shlight.nodes.disney import disney_clearcoat, disney_diffuse, disney_sheen, disney_subsurface
from shlight.nodes.fabrics import microfibre, velvet
from shlight.nodes.inputs import (
    attribute,
    backfacing,
    barycentric,
    edge_distance,
    geometric_normal,
    normal,
    object_value,
    position,
    towards_viewer,
    uv,
)
from shlight.nodes.mathematics import map_range, mapping
from shlight.nodes.metals import conductor, metallic
from shlight.nodes.microfacets import glass, glossy, reflecting_normal, refraction, rising_lobes
from shlight.nodes.noises import musgrave, noise, wave
from shlight.nodes.normals import bump, normal_map
from shlight.nodes.osl import osl
from shlight.nodes.patterns import Bricks, bricks, magic
from shlight.nodes.photometric import ies
from shlight.nodes.principled import principled
from shlight.nodes.rough_diffuse import oren_nayar
from shlight.nodes.shader import Shader, absorbing, emission, ggx, lambert, mix, scaled, toon, translucent, transparent
from shlight.nodes.skies import Sky, hosek_wilkie, preetham
from shlight.nodes.spectra import blackbody, wavelength
from shlight.nodes.subsurface import subsurface
from shlight.nodes.textures import image
from shlight.nodes.values import Color, Value, Vector, clamp, equal, maximum, minimum, select, sqrt

__all__ = [
    "Bricks",
    "Color",
    "Gabor",
    "Shader",
    "Sky",
    "Value",
    "Vector",
    "Voronoi",
    "absorbing",
    "attribute",
    "backfacing",
    "barycentric",
    "blackbody",
    "bricks",
    "bump",
    "clamp",
    "colors",
    "conductor",
    "disney_clearcoat",
    "disney_diffuse",
    "disney_sheen",
    "disney_subsurface",
    "edge_distance",
    "emission",
    "equal",
    "gabor",
    "geometric_normal",
    "ggx",
    "glass",
    "glossy",
    "hosek_wilkie",
    "ies",
    "image",
    "inputs",
    "lambert",
    "magic",
    "map_range",
    "mapping",
    "mathematics",
    "maximum",
    "metallic",
    "microfibre",
    "minimum",
    "mix",
    "mix_color",
    "musgrave",
    "noise",
    "normal",
    "normal_map",
    "object_value",
    "oren_nayar",
    "osl",
    "position",
    "preetham",
    "principled",
    "rays",
    "reflecting_normal",
    "refraction",
    "rising_lobes",
    "scaled",
    "select",
    "sqrt",
    "subsurface",
    "toon",
    "towards_viewer",
    "translucent",
    "transparent",
    "uv",
    "values",
    "velvet",
    "voronoi",
    "wave",
    "wavelength",
]
