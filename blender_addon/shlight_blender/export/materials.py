# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: what a surface reflects, emits and gives to AOVs, read as Cycles reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight import Bsdf, nodes
from shlight.nodes import Color, Shader
from shlight.nodes.rays import Ray, color_on_ray
from shlight.nodes.shader import BLACK

from ..compat import BUMP_SHADOW, DEFAULT_IS_PRINCIPLED, aov_name, lets_light_through, uses_nodes
from ..names import name_of
from ..report import Effect, ExportReport
from .displacement import Displacement, displaced
from .emission import VaryingEmission, of_both_sides
from .nodes import RGB, NodeInputs, Surroundings, TreeReader, origin, positive
from .settings import world_of
from .shaders import NODES
from .volume_nodes import filled


def with_aovs(shader: Shader, reader: TreeReader, tree: Any) -> Shader:
    """A shader with what the nodes of its tree give to the AOVs that are asked for."""
    wanted = reader.surroundings.passes.aovs
    aovs = {}
    for node, groups in _outputs(tree):
        kind = wanted.get(aov_name(node))
        if kind is not None:
            inputs = NodeInputs(reader, node, None, groups)
            aovs[aov_name(node)] = inputs.number("Value") if kind == "VALUE" else inputs.color("Color")
    return shader.with_aovs(aovs) if aovs else shader


def _outputs(tree: Any, groups: tuple[Any, ...] = ()) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """AOV Output nodes of a tree and its groups, with the groups entered on the way."""
    for node in tree.nodes:
        if node.mute:
            continue
        if node.type == "OUTPUT_AOV":
            yield node, groups
        elif node.type == "GROUP" and node.node_tree is not None:
            yield from _outputs(node.node_tree, (*groups, node))


# Albedo of Cycles' surface for objects without material.
DEFAULT_ALBEDO = 0.8
MOST_MEASURED = 16  # files of measured BRDFs that are kept in memory


@dataclass(frozen=True)
class Surface:
    """A material's shader, or what was measured of it, and the light that it gives.

    That is RGB, or (2, 3) of front and back, or what varies.
    """

    shader: Shader | Bsdf = field(default_factory=Shader)
    emission: RGB = field(default_factory=lambda: np.zeros(3))
    varying: VaryingEmission | None = None
    displacement: Displacement | None = None  # of its vertices
    name: str = "default_surface"  # what Cryptomatte knows it by
    pass_index: int = 0

    @property
    def attribute_names(self) -> list[str]:
        """The mesh attributes that it reads."""
        given = [] if self.varying is None else self.varying.inputs
        given += [] if self.displacement is None else self.displacement.offset.inputs
        others = [str(index) for source, index, _ in given if source == "attribute"]
        own = [] if isinstance(self.shader, Bsdf) else self.shader.attribute_names
        return list(dict.fromkeys([*own, *others]))

    @property
    def follows_uvs(self) -> bool:
        """True if it lies along the UV map for rendering, where the mesh has one."""
        return self.shader.is_anisotropic

    @property
    def operation_count(self) -> int:
        """How many operations a hit takes; 0 if its values do not vary."""
        return 0 if isinstance(self.shader, Bsdf) else self.shader.operation_count

    def emits(self) -> bool:
        """True if it may give light."""
        return bool(self.emission.any()) or self.varying is not None

    def refracts(self) -> bool:
        """True if it bounds a transparent body."""
        return not isinstance(self.shader, Bsdf) and bool(self.shader.refractions)

    def is_lit(self) -> bool:
        """True if light that falls on it may be seen, on it or through it."""
        return isinstance(self.shader, Bsdf) or bool(self.shader.lobes) or self.refracts()

    def lighting_nothing(self) -> Surface:
        """The same surface to who sees it, which lights no other."""
        return replace(self, emission=np.zeros(3), varying=None)


def default_surface() -> Surface:
    """The surface of an object without material."""
    if DEFAULT_IS_PRINCIPLED:
        return Surface(nodes.principled(DEFAULT_ALBEDO, several_bounces=True))
    return Surface(nodes.lambert(DEFAULT_ALBEDO))


def read_material(material: Any, report: ExportReport, surroundings: Surroundings) -> Surface:
    """The surface of a material (None: the default); `report` receives whatever of it is not supported."""
    if material is None:
        return default_surface()
    surface = _read_measured(material, report, surroundings) or _read(material, report, surroundings)
    return replace(surface, name=name_of(material), pass_index=int(material.pass_index))


def measured_path(material: Any) -> Path | None:
    """The file of a material's measured BRDF; None without one."""
    given = material.shlight.measured_file
    return Path(bpy.path.abspath(given, library=material.original.library)) if given else None


@lru_cache(MOST_MEASURED)
def _measured(path: Path, stamp: int) -> Bsdf:
    """The BRDF of a file that was written at `stamp` [ns]."""
    return Bsdf.read(path)


def _read_measured(material: Any, report: ExportReport, surroundings: Surroundings) -> Surface | None:
    """The measured surface; None without one, or where its file cannot be read, which is reported."""
    path, place = measured_path(material), f"Material '{name_of(material)}'"
    if path is None:
        return None
    try:
        bsdf = _measured(path, path.stat().st_mtime_ns)
    except FileNotFoundError:
        report.add(place, f"its measured file '{path}' is missing; its nodes are drawn")
        return None
    except (OSError, ValueError) as error:
        report.add(place, f"its measured file cannot be read ({error}); its nodes are drawn")
        return None
    tint = _base_color(material, place, report, surroundings) if material.shlight.tints_measured else None
    times = "" if tint is None else ", times its base colour"
    report.add(place, f"it reflects as its measured file '{path.name}' has it{times}, which Cycles does not read")
    nodes_surface = _read(material, ExportReport(), surroundings)
    shader = nodes_surface.shader
    if isinstance(shader, Shader) and (nodes_surface.emits() or shader.aovs or shader.transparency.constant != BLACK):
        report.add(place, "emission, transparency and AOVs of its nodes are left out beside its measured file")
    return Surface(bsdf if tint is None else bsdf * tint)


# Inputs that are the colour of a surface, by types of nodes.
BASE_COLORS = {"BSDF_PRINCIPLED": "Base Color", "BSDF_DIFFUSE": "Color"}


def _base_color(material: Any, place: str, report: ExportReport, surroundings: Surroundings) -> Color | None:
    """The colour of the node that is the surface; None, which is reported, if that is of another type."""
    if not uses_nodes(material):
        return Color(*(max(c, 0.0) for c in material.diffuse_color[:3]))
    output = material.node_tree.get_output_node("CYCLES")
    source = None if output is None else origin(output.inputs["Surface"])
    name = BASE_COLORS.get(source.node.type) if source is not None and source.node is not None else None
    if source is None or name is None:
        report.add(place, "its surface is no Principled or Diffuse BSDF; its measured file is not tinted")
        return None
    reader = TreeReader(material, place, report, surroundings, NODES)
    return positive(NodeInputs(reader, source.node, source.output, source.groups).color(name))


def _read(material: Any, report: ExportReport, surroundings: Surroundings) -> Surface:
    if not uses_nodes(material):
        return Surface(nodes.lambert([max(c, 0.0) for c in material.diffuse_color[:3]]))
    place = f"Material '{name_of(material)}'"
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        report.add(place, "there is no Material Output node; drawn black", Effect.THING)
        return Surface()
    reader = TreeReader(material, place, report, surroundings, NODES)
    surface = filled(reader.shader(output.inputs["Surface"]).with_bump_shadow(BUMP_SHADOW), output, reader)
    shader = with_aovs(surface, reader, material.node_tree)
    shader, displacement = displaced(shader, material, output.inputs["Displacement"], reader)
    if not lets_light_through(material):
        graph = surroundings.depsgraph
        world = None if graph is None else world_of(graph.scene, graph.view_layer)
        if shader.transparency.constant != BLACK and not _is_even(world):
            text = "its Transparent Shadows are off; of the world's light another part passes it in Cycles"
            report.add(place, text, Effect.LIGHT)
        shader = replace(shader, blocks_shadow_rays=True)
    return replace(with_light(shader, place, report), displacement=displacement)


def _is_even(world: Any) -> bool:
    """True if a world has the same light in all directions."""
    output = world.node_tree.get_output_node("CYCLES") if world is not None and uses_nodes(world) else None
    source = None if output is None else origin(output.inputs["Surface"]).node
    return source is None or (source.type == "BACKGROUND" and not any(own.is_linked for own in source.inputs))


def with_light(shader: Shader, place: str, report: ExportReport) -> Surface:
    """A shader as a surface, and `report` what of its light is not supported."""
    emitted = color_on_ray(shader.emission, Ray.LIGHT)
    constant = emitted.constant
    if constant is None:
        varying = VaryingEmission(emitted)
        if any(source != "backfacing" for source, _, _ in varying.inputs):
            return Surface(shader, varying=varying)
        return Surface(shader, of_both_sides(varying.of_sides({}, 1)[0]))
    light = np.array(constant)
    if not np.isfinite(light).all():
        report.add(place, "the emitted light is not finite; nothing is emitted", Effect.LIGHT)
    elif (light < 0.0).any():
        report.add(place, "negative emission is not supported; nothing is emitted", Effect.LIGHT)
    else:
        return Surface(shader, light)
    light = np.maximum(light, 0.0) if np.isfinite(light).all() else np.zeros(3)
    return Surface(replace(shader, emission=nodes.values.color(light)), light)
