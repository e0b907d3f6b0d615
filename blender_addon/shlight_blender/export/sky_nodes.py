# SPDX-License-Identifier: GPL-3.0-or-later
"""The Sky Texture node."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Color, Vector
from shlight.nodes.skies import Sky, preetham

from ..compat import sky_aerosols
from ..report import Effect
from .mesh_attributes import GENERATED
from .nodes import NodeInputs

NARROWEST_SUN = 5e-4  # [rad], to which Cycles widens narrower ones
# Models of skies with a sun's disc, by the node's types.
MODELS = {"NISHITA": "nishita", "SINGLE_SCATTERING": "single", "MULTIPLE_SCATTERING": "multiple"}
# Logarithms of the irradiance of a floor under Hosek and Wilkie's sky of albedo 0.3 ÷ that under Preetham's, for R, G
# and B: polynomials in the logarithms of the turbidity and of the sine of the sun's angle to the horizon. They are
# fitted to what Cycles draws, to 9 % (root mean square).
HOSEK_SHARE = (
    (-2.341, 0.076, -0.049, 0.313, -0.150, -0.053),
    (-1.912, 0.069, -0.083, -0.079, -0.220, 0.014),
    (-1.589, 0.088, -0.103, -0.575, -0.283, 0.168),
)
LEAST_HAZE, LOWEST_SUN = 2.0, 0.03


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
    found = preetham(towards, sun, node.turbidity)
    if node.sky_type == "PREETHAM":
        return found
    inputs.remark("the model of Hosek and Wilkie is not supported; that of Preetham, dimmed, is used", Effect.LIGHT)
    share = _share_of_hosek(sun[2] / math.hypot(*sun), node.turbidity)
    return Color(*(channel * float(own) for channel, own in zip(found, share, strict=True)))


def _share_of_hosek(sine: float, turbidity: float) -> NDArray[np.float64]:
    """How bright Hosek and Wilkie's sky is, as a part of Preetham's (3,); sine: of the sun's angle to the horizon."""
    u, v = math.log(max(turbidity, LEAST_HAZE)), math.log(max(sine, LOWEST_SUN))
    return np.asarray(np.exp(np.array(HOSEK_SHARE) @ (1.0, v, v * v, u, u * v, u * u)))
