# SPDX-License-Identifier: MIT
"""Rough diffuse surfaces: the improved Oren–Nayar model of Fujii."""

from __future__ import annotations

import math
from typing import Literal, get_args

from shlight._arrays import checked_flag, checked_name
from shlight.nodes.inputs import normal, towards_viewer
from shlight.nodes.microfacets import clamped
from shlight.nodes.shader import Lobe, Shader, lambert
from shlight.nodes.values import (
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    dot,
    maximum,
    number,
    operation,
    reflectance,
    select,
    sqrt,
)

DiffuseModel = Literal["dimmed", "openpbr"]


def _oren_nayar_rise(cosine: Value) -> Value:
    """Fujii's G of the improved Oren–Nayar model."""
    sine = sqrt(1.0 - cosine * cosine)
    angle = operation("arccosine", cosine)
    whole = sine * (angle - 2.0 / 3.0 - sine * cosine) + 2.0 / 3.0 * (sine / cosine) * (1.0 - sine * sine * sine)
    return select(cosine < 1e-6, (math.pi / 2 - 2.0 / 3.0) - cosine, whole)


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
