# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: light from all around, and what the camera sees behind the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

import shlight
from shlight.nodes import Shader
from shlight.nodes.rays import Ray, color_on_ray
from shlight.nodes.skies import Sky
from shlight.nodes.values import Varying, number, vector

from ..catchers import Part
from ..compat import uses_nodes
from ..names import name_of
from ..passes import WORLD, PassWishes
from ..report import Effect, ExportReport
from .emission import VaryingEmission
from .images import BRIGHTEST, linear_pixels
from .nodes import NodeInputs, Origin, ReadNode, Surroundings, TreeReader, all_nodes, origin
from .settings import world_of
from .shaders import NODES, SHADERS, emission
from .sky_nodes import MODELS, sky_of, sky_texture
from .world_picture import Sun, picture, sun_of

# Outputs of a Light Path node for a diffuse ray, which sees the world as it lights a surface, and for the camera's;
# others are 0.
DIFFUSE_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
CAMERA_RAY = {"Is Camera Ray": 1.0}


def _geometry(inputs: NodeInputs) -> Varying | Shader:
    if inputs.output.identifier == "Tangent":
        inputs.remark("'Tangent' is not supported in a world; 0 is used", Effect.LIGHT)
        return number(0.0)
    return NODES["NEW_GEOMETRY"](inputs)


WIDEST_SUN = math.radians(5.0)  # wider ones stay in the picture
# Shaders of surfaces give no light in a world.
LEFT_OUT = set(SHADERS) - {"ADD_SHADER", "EMISSION", "MIX_SHADER"}
WORLD_NODES: dict[str, ReadNode] = {name: read for name, read in NODES.items() if name not in LEFT_OUT} | {
    "BACKGROUND": emission,
    "NEW_GEOMETRY": _geometry,
}


@dataclass
class World:
    """Arguments of `Scene.set_environment`, and suns beside it."""

    radiance: NDArray[Any]  # RGB, or a lat-long picture (height, width, 3); what is negative gives no light
    to_world: NDArray[np.float64] | None = None  # a rotation of the picture
    suns: list[Sun] = field(default_factory=list)
    background: NDArray[Any] | None = None  # what the camera sees in its place, suns and all


def world_of_nodes(world: Any, place: str, width: int, around: Surroundings, report: ExportReport) -> World:
    """The world that the nodes of one with an output make: RGB, or a picture `width` texels wide, and suns.

    `report` receives what of its nodes is not supported.
    """
    surface = world.node_tree.get_output_node("CYCLES").inputs["Surface"]
    skies: list[Sky] = []

    def sky_without_sun(inputs: NodeInputs) -> Varying:
        node = inputs.node
        if node.sky_type not in MODELS or not node.sun_disc or node.sun_size > WIDEST_SUN:
            return sky_texture(inputs)
        skies.append(sky_of(node))
        return sky_texture(inputs, with_sun=False)

    def light(read: dict[str, ReadNode], told: ExportReport, ray: dict[str, float] = DIFFUSE_RAY) -> VaryingEmission:
        path: dict[str, ReadNode] = {"LIGHT_PATH": lambda inputs: number(ray.get(inputs.output.identifier, 0.0))}
        reader = TreeReader(world, place, told, around, WORLD_NODES | path | read)
        return VaryingEmission(color_on_ray(reader.shader(surface).emission, Ray.LIGHT))

    def shown(own: VaryingEmission) -> NDArray[Any]:
        return picture(own, width) if own.inputs else np.clip(own.values({}, 1)[0], -BRIGHTEST, BRIGHTEST)

    background = shown(light({}, ExportReport(), CAMERA_RAY)) if CAMERA_RAY.keys() & _light_paths(world) else None
    without = light({"TEX_SKY": sky_without_sun}, report)
    suns: list[Sun] = []
    with_suns = light({}, ExportReport()) if skies else without
    for sky in skies:
        sun = sun_of(sky, with_suns, without)
        if sun is not None and not any(_overlap(sun, other) for other in suns):
            suns.append(sun)
    return World(shown(without), suns=suns, background=background)


def _overlap(sun: Sun, other: Sun) -> bool:
    """Whether the light of one is part of what has been measured as the other's."""
    return float(sun.direction @ other.direction) > math.cos(0.5 * max(sun.angle, other.angle))


MOST_NEGATIVE = 1e-3  # of a world's light, beyond which the report says that it is left out; skies have a little

# Kinds of images whose pixels are those of one picture.
PLAIN_IMAGES = {"FILE", "GENERATED"}
# Kinds of rays that Cycles can hide the world from, beside the camera's.
RAY_KINDS = ("diffuse", "glossy")


class SceneWorld:
    """The world of a shlight.Scene."""

    def __init__(self, scene: shlight.Scene, part: Part) -> None:
        self._scene = scene
        self._part = part
        self._suns: list[Sun] = []
        self._visible = self._shows_suns = True
        self._group: str | None = None

    def read(self, depsgraph: Any, passes: PassWishes, report: ExportReport) -> bool:
        """Sets the environment to the view layer's; True if it gives light.

        Blender's film is opaque: without a world the camera sees black behind the scene, unless the film is
        transparent. `add_suns` is to follow.
        """
        scene = depsgraph.scene_eval
        self._visible = self._part.shows_world and not scene.render.film_transparent
        world = world_of(scene, depsgraph.view_layer_eval)
        around = Surroundings(depsgraph=depsgraph)
        read = World(np.zeros(3)) if world is None else _read_world(world, scene.shlight.world_width, around, report)
        self._group = None if world is None else passes.light_part(WORLD, name_of(world, "lightgroup"))
        radiance, background = read.radiance, read.background
        if not getattr(getattr(world, "cycles_visibility", None), "camera", True):
            background = np.zeros(3)
        if radiance.min() < 0.0:
            radiance = np.maximum(radiance, 0.0)
            if np.sum(radiance - read.radiance) > MOST_NEGATIVE * np.sum(radiance):
                text = "where it is negative, it takes light away in Cycles; it is black there"
                report.add(f"World '{name_of(world)}'", text, Effect.LIGHT)
        self._scene.set_environment(
            radiance,
            to_world=read.to_world,
            visible=self._visible,
            group=self._group,
            background=None if background is None else np.maximum(background, 0.0),
        )
        self._suns, self._shows_suns = read.suns, self._visible and background is None
        return bool(radiance.any() or read.suns)

    def add_suns(self) -> None:
        """Adds the discs of the world's sky to the scene's lights."""
        for sun in self._suns:
            self._scene.add_sun_light(
                sun.direction, sun.angle, sun.irradiance, camera=self._shows_suns, group=self._group
            )


def _read_world(world: Any, width: int, around: Surroundings, report: ExportReport) -> World:
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
    plain = _plain_picture(source, TreeReader(world, place, ExportReport(), Surroundings(), NODES))
    if plain is not None:
        return plain
    _report_rays(world, place, report)
    return world_of_nodes(world, place, width, around, report)


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


def _light_paths(world: Any) -> set[str]:
    """The outputs of its Light Path nodes that are linked."""
    nodes = [node for node in all_nodes(world.node_tree) if node.type == "LIGHT_PATH"]
    return {output.identifier for node in nodes for output in node.outputs if output.is_linked}


def _report_rays(world: Any, place: str, report: ExportReport) -> None:
    """Names outputs whose values two pictures cannot hold."""
    if others := _light_paths(world) - CAMERA_RAY.keys():
        text = f"{' and '.join(repr(name) for name in sorted(others))} of Light Path: mirrors see what diffuse rays see"
        report.add(place, text)
