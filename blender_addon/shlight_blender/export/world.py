# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: light from all around, and what the camera sees behind the scene."""

from __future__ import annotations

from typing import Any

import numpy as np

import shlight

from ..compat import uses_nodes
from ..report import ExportReport
from .nodes import RGB, ConstantReader, origin, rgb

# Kinds of rays that Cycles can hide the world from.
RAY_KINDS = ("camera", "diffuse", "glossy")


def add_world(scene: shlight.Scene, blender_scene: Any, report: ExportReport) -> bool:
    """Sets the environment of `scene`; True if it gives light.

    Blender's film is opaque: without a world the camera sees black behind the scene, unless the film is transparent.
    """
    world = blender_scene.world
    color = np.zeros(3) if world is None else _world_color(world, f"World '{world.name}'", report)
    scene.set_environment(rgb(color), visible=not blender_scene.render.film_transparent)
    return bool(color.any())


def _world_color(world: Any, place: str, report: ExportReport) -> RGB:
    _report_visibility(world, place, report)
    if not uses_nodes(world):
        return np.array(world.color, dtype=np.float64)
    output = world.node_tree.get_output_node("CYCLES")
    if output is None:
        return np.zeros(3)
    if origin(output.inputs["Volume"]).node is not None:
        report.add(place, "volume is not supported; left out")
    source = origin(output.inputs["Surface"])
    if source.node is None:
        return np.zeros(3)
    reader = ConstantReader(place, report)
    if source.node.type != "BACKGROUND":
        report.add(reader.at(source.node), f"{source.node.bl_label} is not supported; black is used")
        return np.zeros(3)
    strength = reader.number(source.node, "Strength", source.groups)
    return max(strength, 0.0) * reader.color(source.node, "Color", source.groups)


def _report_visibility(world: Any, place: str, report: ExportReport) -> None:
    visibility = getattr(world, "cycles_visibility", None)
    hidden = [kind for kind in RAY_KINDS if not getattr(visibility, kind, True)]
    if hidden:
        report.add(place, f"hiding it from {' and '.join(hidden)} rays is not supported; it lights and is seen")
