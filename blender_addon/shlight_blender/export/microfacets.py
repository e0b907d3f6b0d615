# SPDX-License-Identifier: GPL-3.0-or-later
"""GGX lobes as Cycles weighs them: without Fresnel, and with the energy that a single bounce loses put back."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import shlight

from .nodes import RGB, rgb

Remark = Callable[[str], None]  # takes a text for the export's report
NEGLIGIBLE = 4e-3  # smallest share of a lobe's energy worth a second lobe
ROUGHEST_COMPENSATED = 0.75  # up to here 1 + c (1 - E) is within 3 % of what it stands for


@lru_cache(maxsize=256)
def ggx_albedo(roughness: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Directional albedo of a GGX lobe of reflectance 1 at Gauss points of (0, 1): (cosines, albedos, weights).

    Integrated over the visible normals: there the weight of a reflected direction is G2 / G1 alone.
    """
    alpha = roughness * roughness
    nodes, weights = np.polynomial.legendre.leggauss(32)
    cosines = 0.5 * (nodes + 1.0)
    radius_squared = (np.arange(48) + 0.5) / 48.0
    angle = 2.0 * np.pi * (np.arange(96) + 0.5) / 96.0
    radius = np.sqrt(radius_squared)[:, None]
    disk_x, disk_y = radius * np.cos(angle), radius * np.sin(angle)
    albedos = np.empty_like(cosines)
    for i, cosine in enumerate(cosines):
        view = np.array([np.sqrt(1.0 - cosine * cosine), 0.0, cosine])
        normal_x, normal_z = _visible_normals(view, alpha, disk_x, disk_y)
        along = view[0] * normal_x + view[2] * normal_z
        reflected_z = 2.0 * along * normal_z - view[2]
        above = reflected_z > 0.0
        lambda_view = _smith_lambda(alpha, cosine)
        lambda_light = _smith_lambda(alpha, np.where(above, reflected_z, 1.0))
        weight = np.where(above, (1.0 + lambda_view) / (1.0 + lambda_view + lambda_light), 0.0)
        albedos[i] = weight.mean()
    return cosines, albedos, 0.5 * weights


def _smith_lambda(alpha: float, cosine: float | NDArray[np.float64]) -> NDArray[np.float64]:
    tangent_squared = np.maximum(1.0 / np.square(cosine) - 1.0, 0.0)
    return 0.5 * (np.sqrt(1.0 + alpha * alpha * tangent_squared) - 1.0)


def _visible_normals(
    view: NDArray[np.float64], alpha: float, disk_x: NDArray[np.float64], disk_y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Components x and z of the normals seen from `view` (in the xz-plane), by points of the unit disk (Heitz 2018)."""
    stretched = np.array([alpha * view[0], 0.0, view[2]])
    stretched /= np.linalg.norm(stretched)
    mix = 0.5 * (1.0 + stretched[2])
    across = (1.0 - mix) * np.sqrt(np.maximum(1.0 - disk_x * disk_x, 0.0)) + mix * disk_y
    up = np.sqrt(np.maximum(1.0 - disk_x * disk_x - across * across, 0.0))
    # First tangent y, second tangent = stretched × first.
    normal_x = -stretched[2] * across + stretched[0] * up
    normal_y = disk_x
    normal_z = stretched[0] * across + stretched[2] * up
    normal = np.stack([alpha * normal_x, alpha * normal_y, np.maximum(normal_z, 0.0)])
    normal /= np.linalg.norm(normal, axis=0)
    return normal[0], normal[2]


def _bounce_weights(roughness: float, mean_fresnel: RGB) -> RGB | None:
    """RGB c such that 1 + c (1 - E) puts the lost energy back; None where too little is lost to matter.

    Cycles' factor ("Multiscatter GGX") is 1 + F (1 - E) / E, with E(μ) the single-bounce albedo and F the reflectance
    of all further bounces together (Kulla and Conty 2017). c = F k, with k the mean of 1 / E weighted by what is lost.
    """
    cosines, albedo, weights = ggx_albedo(round(roughness, 3))
    mean_albedo = float((2.0 * weights * cosines * albedo).sum())
    bounced = mean_fresnel * mean_albedo / (1.0 - mean_fresnel * (1.0 - mean_albedo))
    if float(bounced.max()) * (1.0 - mean_albedo) < NEGLIGIBLE:
        return None
    lost = weights * cosines * np.square(1.0 - albedo)
    return np.asarray(bounced * ((lost / albedo).sum() / lost.sum()))


def _remark_on_bounces(roughness: float, remark: Remark) -> None:
    if roughness > ROUGHEST_COMPENSATED:
        remark(f"light bouncing within the surface is approximate for a roughness above {ROUGHEST_COMPENSATED:g}")


def glossy_lobe(color: RGB, roughness: float, multiple_bounces: bool, remark: Remark) -> shlight.Bsdf:
    """GGX lobe whose reflectance is `color` at every angle, as Cycles' Glossy BSDF; roughness 0 is a mirror."""
    whole = shlight.Bsdf.ggx(roughness, 1.0)
    again = _bounce_weights(roughness, color) if multiple_bounces else None
    if again is not None:
        # The layer below gets what the upper one leaves, 1 - E: exactly the energy to put back.
        whole = shlight.Bsdf.layer(whole, rgb(again) * whole)
        _remark_on_bounces(roughness, remark)
    return rgb(color) * whole


def metal_lobe(f0: RGB, roughness: float, multiple_bounces: bool, remark: Remark) -> shlight.Bsdf:
    """GGX lobe with Schlick's Fresnel term from `f0`, as the metallic part of Principled BSDF.

    The light of further bounces is that of the part with constant Fresnel; Schlick's rise towards grazing angles,
    one 21st of the hemisphere, gets none.
    """
    again = _bounce_weights(roughness, f0 + (1.0 - f0) / 21.0) if multiple_bounces else None
    if again is None:
        return shlight.Bsdf.ggx(roughness, rgb(f0))
    _remark_on_bounces(roughness, remark)
    whole = shlight.Bsdf.ggx(roughness, 1.0)
    constant = rgb(f0) * shlight.Bsdf.layer(whole, rgb(again) * whole)
    return constant + rgb(1.0 - f0) * shlight.Bsdf.ggx(roughness, 0.0)
