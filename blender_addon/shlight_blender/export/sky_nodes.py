# SPDX-License-Identifier: GPL-3.0-or-later
"""The Sky Texture node."""

from __future__ import annotations

from typing import Any

from shlight import nodes
from shlight.nodes import Color, Vector
from shlight.nodes.skies import Sky, hosek_wilkie, preetham

from ..compat import sky_aerosols
from .mesh_attributes import GENERATED
from .nodes import NodeInputs

NARROWEST_SUN = 5e-4  # [rad], to which Cycles widens narrower ones
# Models of skies with a sun's disc, by the node's types.
MODELS = {"NISHITA": "nishita", "SINGLE_SCATTERING": "single", "MULTIPLE_SCATTERING": "multiple"}


def _direction(inputs: NodeInputs) -> Vector:
    """The direction in which the sky is looked up; of one with a sun it is the place's own, whatever is linked."""
    own = nodes.attribute(GENERATED)
    has_sun = inputs.node.sky_type in MODELS and inputs.node.sun_disc
    return own if has_sun else inputs.vector_or("Vector", own)


def sky_of(node: Any) -> Sky:
    """The sky of a node of one of MODELS."""
    return Sky(
        MODELS[node.sky_type],
        elevation=node.sun_elevation,
        rotation=node.sun_rotation,
        altitude=node.altitude,
        air=node.air_density,
        aerosols=sky_aerosols(node),
        ozone=node.ozone_density,
        sun_size=max(node.sun_size, NARROWEST_SUN),
        sun_intensity=node.sun_intensity,
    )


def sky_texture(inputs: NodeInputs, *, with_sun: bool = True) -> Color:
    """A sky; with_sun: with the sun that is in it, if there is one."""
    node, towards = inputs.node, _direction(inputs)
    if node.sky_type in MODELS:
        sky = sky_of(node)
        return sky.with_sun(towards) if node.sun_disc and with_sun else sky.light(towards)
    sun = node.sun_direction if any(node.sun_direction) else (0.0, 1.0, 0.0)  # as Cycles takes no direction
    if node.sky_type == "PREETHAM":
        return preetham(towards, sun, node.turbidity)
    return hosek_wilkie(towards, sun, node.turbidity, node.ground_albedo)
