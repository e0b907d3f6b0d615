# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain part of Principled BSDF: diffuse base, dielectric reflection, metal and emission.

Blender 4: metal mixed with a dielectric layer over Lambert's reflection. Blender 3.4: one lobe for metal and
dielectric together plus the diffuse reflection, nothing layered.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import shlight

from ..compat import PRINCIPLED
from ..report import Effect
from .microfacets import Remark, metal_lobe
from .nodes import RGB, rgb
from .surface import Surface, SurfaceReader, lambert

# Luminance with which Blender 3.4 takes the brightness out of the base colour for Specular Tint.
TINT_LUMINANCE = np.array([0.3, 0.6, 0.1])


def read_principled(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> Surface:
    """Surface of a Principled BSDF node."""
    reader.ignore_linked(node, groups, "Normal")
    for name, neutral in PRINCIPLED.unsupported.items():
        reader.ignore_unless(node, groups, name, neutral)
    glow = reader.emitter(node, PRINCIPLED.emission, "Emission Strength", groups)
    read = _read_layered if PRINCIPLED.layered else _read_sum
    return Surface(read(reader, node, groups)).plus(glow)


def untouched_principled(base: RGB) -> shlight.Bsdf | None:
    """What a node of Blender 4 does whose inputs but the base colour are as it was made."""
    return _dielectric_over(base, 0.5, 1.5, 0.5, np.ones(3), lambda text: None)


def _read_layered(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> shlight.Bsdf | None:
    base = reader.color(node, "Base Color", groups)
    metallic = reader.share(node, "Metallic", groups)
    roughness = reader.share(node, "Roughness", groups)
    tint = reader.color(node, "Specular Tint", groups)
    remark, slight = reader.remarks(node), reader.remarks(node, Effect.SLIGHT)
    surface = Surface()
    if metallic > 0.0:
        if (tint != 1.0).any():
            remark("'Specular Tint' of metal is not supported; white is used")
        multiple_bounces = node.distribution == "MULTI_GGX"
        surface = Surface(metal_lobe(np.minimum(base, 1.0), roughness, multiple_bounces, slight)).scaled(metallic)
    if metallic < 1.0:
        level = max(reader.number(node, "Specular IOR Level", groups), 0.0)
        ior = reader.number(node, "IOR", groups)
        dielectric = _dielectric_over(base, roughness, ior, level, tint, remark)
        surface = surface.plus(Surface(dielectric).scaled(1.0 - metallic))
    return surface.bsdf


def _dielectric_over(
    base: RGB, roughness: float, ior: float, level: float, tint: RGB, remark: Remark
) -> shlight.Bsdf | None:
    """Diffuse `base` under a dielectric interface, whose energy of further bounces is too small to matter."""
    diffuse = lambert(base)
    if ior < 1.0:
        remark("an IOR below 1 is not supported; its inverse is used")
        ior = 1.0 / max(ior, 1e-5)
    reflectance = ((ior - 1.0) / (ior + 1.0)) ** 2
    if level != 0.5:
        reflectance = min(2.0 * level * reflectance, 0.99)
        ior = (1.0 + math.sqrt(reflectance)) / (1.0 - math.sqrt(reflectance))
    if ior == 1.0:
        return diffuse
    f0 = rgb(np.clip(reflectance * tint, 0.0, 1.0))
    specular = shlight.Bsdf.ggx(roughness, f0, ior=ior)
    return specular if diffuse is None else shlight.Bsdf.layer(specular, diffuse)


def _read_sum(reader: SurfaceReader, node: Any, groups: tuple[Any, ...]) -> shlight.Bsdf | None:
    base = reader.color(node, "Base Color", groups)
    metallic = reader.share(node, "Metallic", groups)
    remark = reader.remarks(node, Effect.SLIGHT)
    roughness = reader.share(node, "Roughness", groups)
    specular = max(reader.number(node, "Specular", groups), 0.0)
    tint = reader.number(node, "Specular Tint", groups)
    if node.distribution == "MULTI_GGX":
        remark("distribution MULTI_GGX is not supported in this version of Blender; GGX is used")
    surface = Surface()
    if metallic < 1.0 and base.any():
        remark("the diffuse part is drawn as Diffuse BSDF, without Principled BSDF's darker and brighter edges")
        surface = Surface(lambert(base)).scaled(1.0 - metallic)
    if specular == 0.0 and metallic == 0.0:
        return surface.bsdf
    luminance = float(base @ TINT_LUMINANCE)
    hue = base / luminance if luminance > 0.0 else np.ones(3)
    f0 = 0.08 * specular * (1.0 - tint + tint * hue) * (1.0 - metallic) + base * metallic
    f0 = np.clip(f0, 0.0, 1.0)
    root = math.sqrt(min(0.08 * specular, 0.99))
    ior = 2.0 / (1.0 - root) - 1.0
    if ior == 1.0:  # without an interface there is no rise towards grazing angles
        return surface.plus(Surface(rgb(f0) * shlight.Bsdf.ggx(roughness, 1.0))).bsdf
    return surface.plus(Surface(shlight.Bsdf.ggx(roughness, rgb(f0), ior=ior))).bsdf
