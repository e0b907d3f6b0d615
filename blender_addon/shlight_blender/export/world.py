# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: light from all around, and what the camera sees behind the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

import shlight

from ..compat import uses_nodes
from ..names import name_of
from ..passes import WORLD, PassWishes
from ..report import Effect, ExportReport
from .bake import Baked, BakeError, Sun
from .nodes import ConstantReader, Origin, all_nodes, origin
from .pictures import linear_pixels

# Bakes a world in its scene; None while the bake goes on.
Bake = Callable[[Any, Any], "Baked | None"]

MOST_NEGATIVE = 1e-3  # of a world's light, beyond which the report says that it is left out; skies have a little

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
        read = _black() if world is None else _read_world(world, blender_scene, report, bake)
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


def _black() -> World:
    return World(np.zeros(3))


def _read_world(world: Any, blender_scene: Any, report: ExportReport, bake: Bake) -> World:
    place = f"World '{name_of(world)}'"
    _report_visibility(world, place, report)
    if not uses_nodes(world):
        return World(np.array(world.color, dtype=np.float64))
    output = world.node_tree.get_output_node("CYCLES")
    if output is None:
        return _black()
    if origin(output.inputs["Volume"]).node is not None:
        report.add(place, "volume is not supported; left out", Effect.THING)
    source = origin(output.inputs["Surface"])
    if source.node is None:
        return _black()
    findings = ExportReport()
    read = _read_surface(source, ConstantReader(place, findings))
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
    _report_rays(world, ConstantReader(place, report))
    return World(baked.picture, suns=baked.suns)


def _read_surface(source: Origin, reader: ConstantReader) -> World:
    """A world without baking; what of it is otherwise than this is in the reader's report."""
    if source.node.type != "BACKGROUND":
        reader.report.add(
            reader.at(source.node), f"{source.node.bl_label} is not supported; black is used", Effect.LIGHT
        )
        return _black()
    strength = reader.number(source.node, "Strength", source.groups)
    color = origin(source.node.inputs["Color"], source.groups)
    if color.node is None or color.node.type != "TEX_ENVIRONMENT":
        return World(strength * reader.color(source.node, "Color", source.groups))
    read = _read_picture(reader, color)
    return World((strength * read.radiance).astype(read.radiance.dtype), read.to_world)


def _read_picture(reader: ConstantReader, source: Origin) -> World:
    """An Environment Texture."""
    node = source.node
    place = reader.at(node)
    if node.projection != "EQUIRECTANGULAR":
        reader.report.add(place, f"projection {node.projection} is not supported; black is used", Effect.LIGHT)
        return _black()
    if node.interpolation != "Linear":
        reader.report.add(place, f"interpolation {node.interpolation} is not supported; Linear is used")
    if node.image is not None and node.image.source not in {"FILE", "GENERATED"}:
        reader.report.add(place, f"images of the kind {node.image.source} are not supported; one picture is used")
    pixels = None if node.image is None else linear_pixels(node.image)
    if pixels is None:
        reader.report.add(place, "it has no image, or its file is missing; black is used", Effect.LIGHT)
        return _black()
    return World(pixels, _rotation(reader, origin(node.inputs["Vector"], source.groups)))


def _rotation(reader: ConstantReader, source: Origin) -> NDArray[np.float64]:
    """Rotation of the picture whose directions come from `source`: a Mapping node, or the world's own directions."""
    node = source.node
    if node is None or (node.type == "TEX_COORD" and source.output.name == "Generated"):
        return np.eye(3)
    if node.type != "MAPPING":
        reader.report.add(reader.at(node), f"{node.bl_label} as a Vector is not supported; left out")
        return np.eye(3)
    before = _rotation(reader, origin(node.inputs["Vector"], source.groups))
    angles = _constant_vector(reader, node, "Rotation", source)
    scale = _constant_vector(reader, node, "Scale", source)
    if np.ptp(scale) > 1e-6 * np.abs(scale).max() or scale[0] <= 0.0:
        reader.report.add(reader.at(node), "'Scale' is not supported; the picture is only turned")
    if node.vector_type in {"POINT", "TEXTURE"} and _constant_vector(reader, node, "Location", source).any():
        reader.report.add(reader.at(node), "'Location' is not supported; the picture is only turned")
    turn = np.array(Euler(angles, "XYZ").to_matrix(), dtype=np.float64)
    # The node turns the directions that look the picture up, so that the picture turns the other way.
    return before @ (turn if node.vector_type == "TEXTURE" else turn.T)


def _constant_vector(reader: ConstantReader, node: Any, name: str, source: Origin) -> NDArray[np.float64]:
    socket = node.inputs[name]
    if origin(socket, source.groups).node is not None:
        reader.report.add(reader.at(node), f"a linked '{name}' is not supported; its constant is used")
    return np.array(socket.default_value, dtype=np.float64)


def _report_visibility(world: Any, place: str, report: ExportReport) -> None:
    visibility = getattr(world, "cycles_visibility", None)
    hidden = [kind for kind in RAY_KINDS if not getattr(visibility, kind, True)]
    if hidden:
        text = f"hiding it from {' and '.join(hidden)} rays is not supported; it lights and is seen"
        report.add(place, text, Effect.LIGHT)


def _report_rays(world: Any, reader: ConstantReader) -> None:
    """Names nodes whose values one picture cannot hold."""
    for node in all_nodes(world.node_tree):
        linked = {output.name for output in node.outputs if output.is_linked}
        if node.type == "LIGHT_PATH" and linked:
            reader.report.add(reader.at(node), "kinds of rays are not told apart; all see what diffuse rays see")
        if (node.type == "TEX_COORD" and linked & {"Camera", "Window"}) or (node.type == "CAMERA" and linked):
            reader.report.add(reader.at(node), "coordinates of the camera are not supported; baked without them")
