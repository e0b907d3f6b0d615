# SPDX-License-Identifier: GPL-3.0-or-later
"""A world's nodes as a lat-long picture, found by the program that a material would have of them."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import Shader, Value
from shlight.nodes.rays import Ray, color_on_ray
from shlight.nodes.values import Varying, number

from ..report import Effect, ExportReport
from .emission import Input, VaryingEmission
from .expressions import NodeInputs, Surroundings
from .mesh_attributes import GENERATED
from .pictures import BRIGHTEST
from .shaders import SHADERS
from .surface import NODES, ShaderInputs, ShaderReader

TEXELS_AT_ONCE = 2**16
# Outputs of a Light Path node for a diffuse ray, which sees the world as it lights a surface; others are 0.
DIFFUSE_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Depth": 1.0, "Diffuse Depth": 1.0}


def _background(inputs: ShaderInputs) -> Shader:
    return nodes.emission(inputs.color("Color") * inputs.number("Strength"))


def _light_path(inputs: NodeInputs) -> Value:
    return number(DIFFUSE_RAY.get(inputs.output.identifier, 0.0))


def _geometry(inputs: NodeInputs) -> Varying:
    if inputs.output.identifier == "Tangent":
        inputs.remark("'Tangent' is not supported in a world; 0 is used", Effect.LIGHT)
        return number(0.0)
    return NODES["NEW_GEOMETRY"](inputs)


WORLD_SHADERS = {name: SHADERS[name] for name in ("ADD_SHADER", "EMISSION", "MIX_SHADER")} | {"BACKGROUND": _background}
# Attributes are those of the scene, which these expressions do not have.
WORLD_VALUES = {name: read for name, read in NODES.items() if name != "ATTRIBUTE"} | {
    "LIGHT_PATH": _light_path,
    "NEW_GEOMETRY": _geometry,
}


def radiance_of(surface: Any, world: Any, place: str, width: int, report: ExportReport) -> NDArray[Any]:
    """The radiance that the socket `surface` of a world receives: RGB, or a picture `width` texels wide, as
    `shlight.Scene.set_environment` takes them.

    `report` receives what of its nodes is not supported.
    """
    reader = ShaderReader(world, place, report, Surroundings(), WORLD_SHADERS, WORLD_VALUES)
    light = VaryingEmission(color_on_ray(reader.shader(surface).emission, Ray.LIGHT))
    if light.inputs:
        light.values({}, 1)  # which makes its program, before threads ask for it
        return _picture(light, width)
    return np.clip(light.values({}, 1)[0], -BRIGHTEST, BRIGHTEST)


def _picture(light: VaryingEmission, width: int) -> NDArray[np.float32]:
    """(width / 2, width, 3)."""
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


def _inputs_at(directions: NDArray[np.float64]) -> dict[Input, NDArray[np.float64]]:
    """A program's inputs in directions (3, …), as Cycles has them: a sphere of radius 1, seen from its middle."""
    inputs: dict[Input, NDArray[np.float64]] = {}
    for i, along in enumerate(directions):
        inputs |= {(source, 0, i): -along for source in ("normal", "geometric_normal", "towards_viewer")}
        inputs |= {("position", 0, i): along, ("attribute", GENERATED, i): along}
        inputs |= {(matrix, 0, 5 * i): np.ones(1) for matrix in ("object_to_world", "world_to_object")}
    return inputs
