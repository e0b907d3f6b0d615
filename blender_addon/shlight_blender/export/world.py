# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: light from all around, and what the camera sees behind the scene."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

import shlight
from shlight.nodes import Shader
from shlight.nodes.rays import Ray, color_on_ray
from shlight.nodes.values import Varying, number, vector

from ..compat import uses_nodes
from ..names import name_of
from ..passes import WORLD, PassWishes
from ..report import Effect, ExportReport
from .bake import Baked, BakeError, Sun
from .emission import Input, VaryingEmission
from .images import BRIGHTEST, linear_pixels
from .mesh_attributes import GENERATED
from .nodes import NodeInputs, Origin, ReadNode, Surroundings, TreeReader, all_nodes, node_name, origin
from .shaders import NODES, SHADERS, emission

TEXELS_AT_ONCE = 2**16
# Outputs of a Light Path node for a diffuse ray, which sees the world as it lights a surface; others are 0.
DIFFUSE_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Depth": 1.0, "Diffuse Depth": 1.0}


def _geometry(inputs: NodeInputs) -> Varying | Shader:
    if inputs.output.identifier == "Tangent":
        inputs.remark("'Tangent' is not supported in a world; 0 is used", Effect.LIGHT)
        return number(0.0)
    return NODES["NEW_GEOMETRY"](inputs)


# Shaders of surfaces give no light in a world, and its attributes are those of the scene, which no program has.
LEFT_OUT = {"ATTRIBUTE", *SHADERS} - {"ADD_SHADER", "EMISSION", "MIX_SHADER"}
WORLD_NODES: dict[str, ReadNode] = {name: read for name, read in NODES.items() if name not in LEFT_OUT} | {
    "BACKGROUND": emission,
    "LIGHT_PATH": lambda inputs: number(DIFFUSE_RAY.get(inputs.output.identifier, 0.0)),
    "NEW_GEOMETRY": _geometry,
}


def radiance_of(surface: Any, world: Any, place: str, width: int, report: ExportReport) -> NDArray[Any]:
    """The radiance that the socket `surface` of a world receives: RGB, or a picture `width` texels wide, as
    `shlight.Scene.set_environment` takes them.

    `report` receives what of its nodes is not supported.
    """
    reader = TreeReader(world, place, report, Surroundings(), WORLD_NODES)
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


# Bakes a world in its scene; None while the bake goes on.
Bake = Callable[[Any, Any], "Baked | None"]

MOST_NEGATIVE = 1e-3  # of a world's light, beyond which the report says that it is left out; skies have a little

# Kinds of images whose pixels are those of one picture.
PLAIN_IMAGES = {"FILE", "GENERATED"}
# Kinds of rays that Cycles can hide the world from.
RAY_KINDS = ("camera", "diffuse", "glossy")


@dataclass
class World:
    """Arguments of `Scene.set_environment`, and suns beside it."""

    radiance: NDArray[Any]  # RGB, or a lat-long picture (height, width, 3); what is negative gives no light
    to_world: NDArray[np.float64] | None = None  # a rotation of the picture
    suns: list[Sun] = field(default_factory=list)


class SceneWorld:
    """The world of a shlight.Scene."""

    def __init__(self, scene: shlight.Scene) -> None:
        self._scene = scene
        self._suns: list[Sun] = []
        self._visible = True
        self._group: str | None = None

    def read(self, blender_scene: Any, view_layer: Any, passes: PassWishes, report: ExportReport, bake: Bake) -> bool:
        """Sets the environment to the view layer's; True if it gives light.

        bake: see `ExportedScene.update`.
        Blender's film is opaque: without a world the camera sees black behind the scene, unless the film is
        transparent. `add_suns` is to follow.
        """
        self._visible = not blender_scene.render.film_transparent
        world = world_of(blender_scene, view_layer)
        read = World(np.zeros(3)) if world is None else _read_world(world, blender_scene, report, bake)
        self._group = None if world is None else passes.light_part(WORLD, name_of(world, "lightgroup"))
        radiance = read.radiance
        if radiance.min() < 0.0:
            radiance = np.maximum(radiance, 0.0)
            if np.sum(radiance - read.radiance) > MOST_NEGATIVE * np.sum(radiance):
                text = "where it is negative, it takes light away in Cycles; it is black there"
                report.add(f"World '{name_of(world)}'", text, Effect.LIGHT)
        self._scene.set_environment(radiance, to_world=read.to_world, visible=self._visible, group=self._group)
        self._suns = read.suns
        return bool(radiance.any() or read.suns)

    def add_suns(self) -> None:
        """Adds the discs of the world's sky to the scene's lights."""
        for sun in self._suns:
            self._scene.add_sun_light(sun.direction, sun.angle, sun.irradiance, camera=self._visible, group=self._group)


def world_of(scene: Any, view_layer: Any) -> Any:
    """The world of a view layer, which may override the scene's or have none."""
    world = getattr(view_layer, "world_override", None) or scene.world
    return world if view_layer.use_sky else None


def _read_world(world: Any, blender_scene: Any, report: ExportReport, bake: Bake) -> World:
    place = f"World '{name_of(world)}'"
    _report_visibility(world, place, report)
    if not uses_nodes(world):
        return World(np.array(world.color, dtype=np.float64))
    output = world.node_tree.get_output_node("CYCLES")
    if output is None:
        return World(np.zeros(3))
    if origin(output.inputs["Volume"]).node is not None:
        report.add(place, "volume is not supported; left out", Effect.THING)
    source = origin(output.inputs["Surface"])
    if source.node is None:
        return World(np.zeros(3))
    picture = _plain_picture(source, TreeReader(world, place, ExportReport(), Surroundings(), NODES))
    if picture is not None:
        return picture
    _report_rays(world, place, report)
    findings = ExportReport()
    read = World(radiance_of(output.inputs["Surface"], world, place, blender_scene.shlight.world_width, findings))
    if not len(findings):
        return read
    try:
        baked = bake(world, blender_scene)
    except BakeError as error:
        report.add(place, f"it could not be baked to a picture ({error}); it is simplified", Effect.LIGHT)
        report.extend(findings)
        return read
    if baked is None:
        report.add(place, "it is simplified until it is baked to a picture", Effect.LIGHT)
        return read
    return World(baked.picture, suns=baked.suns)


def _plain_picture(source: Origin, reader: TreeReader) -> World | None:
    """A world that is an Environment Texture, times a strength and turned, with the texels of its image; else None."""
    if source.node.type != "BACKGROUND":
        return None
    strength = number(reader.expression(source.node.inputs["Strength"], source.groups)).constant
    color = origin(source.node.inputs["Color"], source.groups)
    node = color.node
    if node is None or node.type != "TEX_ENVIRONMENT" or node.image is None or strength is None:
        return None
    if (node.projection, node.interpolation) != ("EQUIRECTANGULAR", "Linear") or node.image.source not in PLAIN_IMAGES:
        return None
    turn = _rotation(reader, origin(node.inputs["Vector"], color.groups))
    pixels = None if turn is None else linear_pixels(node.image)
    return None if pixels is None else World((strength * pixels).astype(pixels.dtype), turn)


def _rotation(reader: TreeReader, source: Origin) -> NDArray[np.float64] | None:
    """Rotation of the picture whose directions come from `source`: Mapping nodes, or the world's own directions."""
    node = source.node
    if node is None or (node.type == "TEX_COORD" and source.output.name == "Generated"):
        return np.eye(3)
    if node.type != "MAPPING":
        return None
    before = _rotation(reader, origin(node.inputs["Vector"], source.groups))
    names = ("Rotation", "Scale", *(("Location",) if node.vector_type in {"POINT", "TEXTURE"} else ()))
    constants = [vector(reader.expression(node.inputs[name], source.groups)).constant for name in names]
    if before is None or any(constant is None for constant in constants):
        return None
    angles, scale, *shift = np.array(constants, dtype=np.float64)
    if np.any(shift) or np.ptp(scale) > 1e-6 * np.abs(scale).max() or scale[0] <= 0.0:
        return None
    turn = np.array(Euler(angles, "XYZ").to_matrix(), dtype=np.float64)
    # The node turns the directions that look the picture up, so that the picture turns the other way.
    return before @ (turn if node.vector_type == "TEXTURE" else turn.T)


def _report_visibility(world: Any, place: str, report: ExportReport) -> None:
    visibility = getattr(world, "cycles_visibility", None)
    hidden = [kind for kind in RAY_KINDS if not getattr(visibility, kind, True)]
    if hidden:
        text = f"hiding it from {' and '.join(hidden)} rays is not supported; it lights and is seen"
        report.add(place, text, Effect.LIGHT)


def _report_rays(world: Any, place: str, report: ExportReport) -> None:
    """Names nodes whose values one picture cannot hold."""
    for node in all_nodes(world.node_tree):
        linked = {output.name for output in node.outputs if output.is_linked}
        at = f"{place}, node '{node_name(node)}'"
        if node.type == "LIGHT_PATH" and linked:
            report.add(at, "kinds of rays are not told apart; all see what diffuse rays see")
        if (node.type == "TEX_COORD" and linked & {"Camera", "Window"}) or (node.type == "CAMERA" and linked):
            report.add(at, "coordinates of the camera are not supported; baked without them")
