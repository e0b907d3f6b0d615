# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: what a surface reflects and emits, read as Cycles reads it."""

from __future__ import annotations

from typing import Any

import numpy as np

import shlight

from ..compat import MATERIALS, uses_nodes
from ..report import Effect, ExportReport
from .nodes import origin
from .principled import untouched_principled
from .shaders import SHADERS
from .surface import Surface, SurfaceReader, lambert

# What Cycles draws where an object has no material.
DEFAULT_ALBEDO = 0.8


def default_surface() -> Surface:
    """The surface of an object without material."""
    if MATERIALS.default_is_principled:
        return Surface(untouched_principled(np.full(3, DEFAULT_ALBEDO)))
    return Surface(shlight.Bsdf.lambert(DEFAULT_ALBEDO))


def read_material(material: Any, report: ExportReport) -> Surface:
    """The surface of a material (None: the default); `report` receives whatever of it is not supported."""
    if material is None:
        return default_surface()
    if not uses_nodes(material):
        return Surface(lambert(np.maximum(np.array(material.diffuse_color[:3], dtype=np.float64), 0.0)))
    place = f"Material '{material.name}'"
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        report.add(place, "there is no Material Output node; drawn black", Effect.THING)
        return Surface()
    for name in ("Volume", "Displacement"):
        socket = output.inputs.get(name)
        if socket is not None and origin(socket).node is not None:
            report.add(place, f"{name.lower()} is not supported; left out")
    surface = SurfaceReader(place, report, SHADERS, uvs_of="mesh").surface(output.inputs["Surface"])
    factors = [surface.emission, *(glow.factor for glow in surface.textured)]
    if not np.isfinite(factors).all():
        report.add(place, "the emitted light is not finite; nothing is emitted", Effect.LIGHT)
        surface.emission, surface.textured = np.zeros(3), ()
    return surface
