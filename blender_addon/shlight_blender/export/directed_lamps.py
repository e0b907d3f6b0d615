# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps whose light differs by direction, as luminaires do: one colour, and a table of factors by direction."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.photometry import LUMINANCE

from ..compat import point_is_disk
from .emission import Input, VaryingEmission
from .textured_lamps import EvenLamp, Remark

Array = NDArray[np.float64]

HEIGHT, WIDTH = 256, 512  # of a table
ONE_COLOR = 1e-3  # deviation of a lamp's light from one colour times its factor ÷ the largest
# Inputs of programs that are the direction in which a lamp without a surface shines.
DIRECTIONS = ("towards_viewer", "normal", "geometric_normal")


def _directions() -> Array:
    """Unit vectors (HEIGHT * WIDTH, 3) of a table's places."""
    down, around = np.meshgrid(_steps(HEIGHT), np.pi - 2.0 * _steps(WIDTH), indexing="ij")
    ways = [np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)]
    return np.stack(ways, axis=-1).reshape(-1, 3)


def _steps(count: int) -> Array:
    return np.pi * (np.arange(count) + 0.5) / count


def varies_by_direction(emission: VaryingEmission) -> bool:
    """Whether a flat lamp's light differs by direction."""
    return any(source == DIRECTIONS[0] for source, _, _ in emission.inputs)


def directed_lamp(emission: VaryingEmission, lamp: Any, to_world: Array, remark: Remark) -> EvenLamp:
    """A lamp that shines as `emission`; `remark` is told what is not as in Cycles."""
    read = {source for source, _, _ in emission.inputs}
    inputs = _inputs(to_world, lamp.type)
    if not all(entry in inputs for entry in emission.inputs):
        remark("light that varies over the lamp is not supported; that of one place is used")
    if lamp.type == "SUN" or not read.intersection(DIRECTIONS):
        return EvenLamp(emission.radiance({entry: own[:1] for entry, own in inputs.items()}, 1)[0], [])
    if read.intersection(DIRECTIONS[1:]) and has_surface(lamp):
        remark("its light follows the normal of its surface; it is drawn as if that were the direction")
    values = emission.radiance(inputs, HEIGHT * WIDTH)
    grey = values @ np.asarray(LUMINANCE)
    largest = float(grey.max())
    if not 0.0 < largest < math.inf:
        return EvenLamp(values[0], [])
    solid_angles = np.repeat(np.sin(_steps(HEIGHT)), WIDTH)
    color = solid_angles @ values / (solid_angles @ grey)
    if np.abs(values - grey[:, None] * color).max() > ONE_COLOR * largest:
        remark("the colour of its light varies with the direction; its mean colour is used")
    return EvenLamp(largest * color, [], (grey / largest).reshape(HEIGHT, WIDTH))


def has_surface(lamp: Any) -> bool:
    """Whether the normal of a point or spot lamp is that of a sphere and not the direction in which it shines."""
    return lamp.type in ("POINT", "SPOT") and lamp.shadow_soft_size > 0.0 and not point_is_disk(lamp)


def _inputs(to_world: Array, kind: str) -> dict[Input, Array]:
    """Finds what programs read at the places of a table."""
    ahead = -to_world[:3, 2] / max(float(np.linalg.norm(to_world[:3, 2])), 1e-30)
    ways = ahead[None] if kind == "SUN" else _directions()
    even = {
        ("object_to_world", 0): to_world[:3].ravel(),
        ("world_to_object", 0): np.linalg.pinv(to_world)[:3].ravel(),
        ("position", 0): to_world[:3, 3],
    }
    normals = np.broadcast_to(ahead, ways.shape) if kind == "AREA" else ways
    found = {("towards_viewer", 0, i): ways[:, i] for i in range(3)}
    found |= {(source, 0, i): normals[:, i] for source in DIRECTIONS[1:] for i in range(3)}
    return found | {(*key, i): np.full(len(ways), own) for key, values in even.items() for i, own in enumerate(values)}
