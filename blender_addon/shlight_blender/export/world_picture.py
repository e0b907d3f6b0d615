# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of a world of nodes: a lat-long picture, and the suns of its skies, which are narrower than its texels."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.skies import Sky

from .emission import Input, VaryingEmission
from .images import BRIGHTEST
from .mesh_attributes import GENERATED

Array = NDArray[np.float64]

TEXELS_AT_ONCE = 2**16
RINGS, SPOKES = 64, 64  # places in a sun's disc


def picture(light: VaryingEmission, width: int) -> NDArray[np.float32]:
    """(width / 2, width, 3), as `shlight.Scene.set_environment` takes it."""
    light.values({}, 1)  # which makes its program, before threads ask for it
    height = width // 2
    rows = max(TEXELS_AT_ONCE // width, 1)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = pool.map(lambda top: _rows(light, width, top, min(top + rows, height)), range(0, height, rows))
        return np.concatenate(list(parts))


def _rows(light: VaryingEmission, width: int, top: int, bottom: int) -> NDArray[np.float32]:
    """The middles of texels, over each of which pictures are filtered."""
    # One texel more to the right and one below.
    longitude = math.pi * (1.0 - 2.0 * (np.arange(width + 1) + 0.5) / width)
    latitude = math.pi * (0.5 - (np.arange(top, bottom + 1) + 0.5) / (width // 2))[:, None]
    sines = np.broadcast_to(np.sin(latitude), (len(latitude), width + 1))
    grid = np.stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), sines])
    places = np.stack([grid[:, :-1, :-1], grid[:, :-1, 1:], grid[:, 1:, :-1]], axis=1).reshape(3, 3, -1)
    found = light.values(_inputs_at(places), places.shape[-1]).reshape(bottom - top, width, 3)
    return np.clip(found, -BRIGHTEST, BRIGHTEST).astype(np.float32)


def _inputs_at(directions: Array) -> dict[Input, Array]:
    """A program's inputs in directions (3, …), as Cycles has them: a sphere of radius 1, seen from its middle."""
    inputs: dict[Input, Array] = {}
    for i, along in enumerate(directions):
        inputs |= {(source, 0, i): -along for source in ("normal", "geometric_normal", "towards_viewer")}
        inputs |= {("position", 0, i): along, ("attribute", GENERATED, i): along}
        inputs |= {(matrix, 0, 5 * i): np.ones(1) for matrix in ("object_to_world", "world_to_object")}
    return inputs


@dataclass(frozen=True)
class Sun:
    """Arguments of `shlight.Scene.add_sun_light`."""

    direction: Array  # (3,), the way its light travels
    angle: float  # its diameter [rad]
    irradiance: Array  # RGB [W m^-2], at right angles to its direction


def sun_of(sky: Sky, with_suns: VaryingEmission, without: VaryingEmission) -> Sun | None:
    """The light that the sun of a sky adds to a world; None if it adds nothing.

    The disc is even, and its middle is the mean direction of what is seen of the sky's.
    """
    middle = sky.towards_sun
    u = np.cross(middle, np.eye(3)[np.abs(middle).argmin()])
    u /= np.linalg.norm(u)
    angle = 2.0 * math.pi * np.arange(SPOKES) / SPOKES
    out = u[:, None] * np.cos(angle) + np.cross(middle, u)[:, None] * np.sin(angle)
    # Rings of the same solid angle.
    whole = 1.0 - math.cos(0.5 * sky.sun_size)
    cosine = 1.0 - whole * (np.arange(RINGS)[:, None] + 0.5) / RINGS
    places = (middle[:, None, None] * cosine + out[:, None] * np.sqrt(1.0 - cosine**2)).reshape(3, -1)
    inputs, count = _inputs_at(places), RINGS * SPOKES
    added = with_suns.values(inputs, count) - without.values(inputs, count)
    irradiance = np.maximum(2.0 * math.pi * whole / count * added.sum(axis=0), 0.0)
    towards = places @ np.maximum(added.sum(axis=-1), 0.0)
    if not irradiance.any() or not towards.any():
        return None
    return Sun(-towards / np.linalg.norm(towards), sky.sun_size, irradiance)
