# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes: evaluated objects as arrays, one set of arrays for all instances of the same mesh and materials."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import shlight

from ..compat import mesh_triangles, slot_materials, smooth_corner_normals
from ..passes import SURFACES
from ..report import Effect, ExportReport
from .expressions import Surroundings
from .materials import Surface, read_material
from .mesh_attributes import COLOR, UV, mesh_attributes
from .textured_meshes import MeshArrays, with_even_emission

FloatArray = NDArray[np.float32]

# Of one material in one place, more emissive triangles than these are one light to the core.
MOST_SINGLE_FACES = 16
# From this number of lights on the user is told why the render takes long.
MANY_EMITTERS = 200


class Label(NamedTuple):
    """What passes know an object by."""

    name: str
    asset: str
    pass_index: int


def _label(shown: Any) -> Label:
    """An asset is all that hangs on one object without a parent."""
    root = shown
    while root.parent is not None:
        root = root.parent
    return Label(shown.name, root.name, int(shown.pass_index))


@dataclass
class MeshUse:
    """A mesh with its surfaces (one per material slot, at least one), and all places where it stands."""

    place: str
    arrays: MeshArrays
    surfaces: list[Surface]
    transforms: list[NDArray[np.float64]] = field(default_factory=list)
    object_values: list[list[float]] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    group: str | None = None  # see PassWishes.light_part


def mesh_arrays(mesh: Any, attribute_names: Iterable[str]) -> MeshArrays | None:
    """Triangles of an evaluated mesh with those of the attributes that it has, None if it has no triangles."""
    triangles = mesh_triangles(mesh)
    if not len(triangles.corners):
        return None
    vertices, corner_vertices = triangles.vertices, triangles.corner_vertices
    corner_normals = smooth_corner_normals(mesh)
    normals = None
    if corner_normals is not None:
        normals = _repaired(corner_normals[triangles.corners], vertices, corner_vertices)
    attributes = mesh_attributes(mesh, triangles, attribute_names)
    return MeshArrays(vertices, corner_vertices, normals, triangles.materials, attributes)


def _repaired(normals: FloatArray, vertices: FloatArray, triangles: NDArray[np.int32]) -> FloatArray:
    """Normals of length 1; where Blender has none (degenerate faces) the face's own, else +Z."""
    good = np.einsum("ijk,ijk->ij", normals, normals)[:, :, None] > 1e-12
    if good.all():
        return normals
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    face = np.cross(b - a, c - a)
    face_length = np.linalg.norm(face, axis=1, keepdims=True)
    face = np.where(face_length > 0.0, face / np.where(face_length > 0.0, face_length, 1.0), (0.0, 0.0, 1.0))
    repaired: FloatArray = np.where(good, normals, face[:, None, :]).astype(np.float32)
    return repaired


class MeshCollector:
    """Gathers the meshes of a depsgraph and hands them to a scene."""

    def __init__(self, report: ExportReport, surroundings: Surroundings, material_override: Any = None) -> None:
        self._report = report
        self.surroundings = surroundings
        self._override = material_override
        self._uses: dict[tuple[Any, ...], MeshUse | None] = {}
        self._surfaces: dict[Any, Surface] = {}
        self._names: dict[Any, str] = {}  # of the materials of these

    def add(self, instance: Any, to_world: NDArray[np.float64]) -> None:
        """Notes one instance of the depsgraph that shows a mesh, at `to_world`."""
        mesh_object = instance.object
        place = f"Object '{mesh_object.name}'"
        if not np.isfinite(to_world).all():
            self._report.add(place, "its transform is not finite; left out", Effect.THING)
            return
        materials = slot_materials(mesh_object)
        group = self.surroundings.passes.light_part(SURFACES, mesh_object.lightgroup)
        key = (mesh_object.data.as_pointer(), group, *(material and material.as_pointer() for material in materials))
        if key not in self._uses:
            self._uses[key] = self._convert(instance, to_world, place, materials, group)
        use = self._uses[key]
        if use is not None:
            use.transforms.append(to_world)
            use.object_values.append(self.surroundings.object_values.of(instance))
            use.labels.append(_label(mesh_object))

    def _convert(
        self, instance: Any, to_world: NDArray[np.float64], place: str, materials: Sequence[Any], group: str | None
    ) -> MeshUse | None:
        mesh_object = instance.object
        surfaces = [self._surface(material) for material in materials or [None]]
        mesh = mesh_object.to_mesh()
        try:
            names = dict.fromkeys(name for surface in surfaces for name in surface.attribute_names)
            arrays = mesh_arrays(mesh, [*names, UV] if self.surroundings.passes.uvs else names)
            if arrays is not None:
                missing = [name for name in names if name not in arrays.attributes]
                self._report_missing(mesh_object, missing)
                # A missing colour is transparent black, other missing attributes have an alpha of 1.
                black = np.zeros((len(arrays.triangles), 3, 4), dtype=np.float32)
                arrays.attributes |= {name: black for name in missing if name.startswith(COLOR)}
        finally:
            mesh_object.to_mesh_clear()
        if arrays is None:
            return None
        if not np.isfinite(arrays.vertices).all():
            self._report.add(place, "some of its vertices are not finite; left out", Effect.THING)
            return None
        if arrays.normals is not None and not np.isfinite(arrays.normals).all():
            arrays.normals = None
        if any(surface.varying is not None for surface in surfaces):
            remark = partial(self._report.add, place)
            arrays, surfaces = with_even_emission(
                arrays, surfaces, to_world, self.surroundings.object_values.of(instance), remark
            )
        return MeshUse(place, arrays, surfaces, group=group)

    def _report_missing(self, mesh_object: Any, names: Sequence[str]) -> None:
        for name in names:
            what = f"attribute or UV map '{name}'" if name else "UV map"
            text = f"it has no {what}, which its material reads; 0 is used, as in Cycles"
            self._report.add(f"Object '{mesh_object.name}'", text, Effect.SLIGHT)

    def _surface(self, material: Any) -> Surface:
        material = self._override or material
        key = material and material.as_pointer()
        if key not in self._surfaces:
            self._surfaces[key] = read_material(material, self._report, self.surroundings)
            self._names[key] = "" if material is None else material.name
        return self._surfaces[key]

    def operations(self) -> dict[str, int]:
        """How many operations a hit takes, by the name of each material whose values vary."""
        counts = {self._names[key]: surface.shader.operation_count for key, surface in self._surfaces.items()}
        return {name: count for name, count in counts.items() if name and count > 0}

    def names(self) -> dict[str, set[str]]:
        """Of all that is drawn: of objects, materials and assets."""
        labels = [label for use in self._uses.values() if use is not None for label in use.labels]
        return {
            "object": {label.name for label in labels},
            "material": {surface.name for surface in self._surfaces.values()},
            "asset": {label.asset for label in labels},
        }

    def hand_over(self, scene: shlight.Scene, ask: Callable[[], None]) -> bool:
        """Adds everything to `scene`, and calls `ask` before each mesh; True if some of it emits light."""
        emits = False
        for use in self._uses.values():
            ask()
            if use is not None:
                emits |= self._add_mesh(scene, use)
        return emits

    def _add_mesh(self, scene: shlight.Scene, use: MeshUse) -> bool:
        surfaces = use.surfaces
        indices = np.clip(use.arrays.material_indices, 0, len(surfaces) - 1)
        used = np.unique(indices)
        emission = np.array([surface.emission for surface in surfaces])
        emits = bool(emission[used].any())
        faces = np.bincount(indices, minlength=len(surfaces))[emission.any(axis=1)]
        lights = int(np.where(faces > MOST_SINGLE_FACES, 1, faces).sum()) * len(use.transforms)
        if lights >= MANY_EMITTERS:
            text = f"its emissive faces are up to {lights} lights, which take long to render"
            self._report.add(use.place, text, Effect.SLIGHT)
        for arrays, transforms, values, labels in standing(use):
            scene.add_mesh(
                arrays.vertices,
                arrays.triangles,
                normals=arrays.normals,
                uvs={UV: arrays.attributes[UV]} if UV in arrays.attributes else None,
                attributes=arrays.attributes,
                bsdf=[surface.shader for surface in surfaces],
                emission=emission if emits else None,
                material_indices=indices,
                transforms=transforms,
                object_values=values,
                group=use.group,
                object_names=[label.name for label in labels],
                asset_names=[label.asset for label in labels],
                object_indices=[label.pass_index for label in labels],
                material_names=[surface.name for surface in surfaces],
                material_pass_indices=[surface.pass_index for surface in surfaces],
            )
        return emits


Standing = tuple[MeshArrays, NDArray[np.float64] | None, NDArray[np.float64] | None, list[Label]]


def standing(use: MeshUse) -> list[Standing]:
    """A mesh with its transforms, their object values and labels, and a flattened copy for each without inverse."""
    most = max(len(values) for values in use.object_values)
    values = np.array([[*own, *[0.0] * (most - len(own))] for own in use.object_values]) if most else None
    transforms = np.array(use.transforms)
    linear = transforms[:, :3, :3]
    volume = np.abs(np.linalg.det(linear))
    size = np.linalg.norm(linear, axis=1).max(axis=1)
    regular = volume > 1e-9 * size**3
    parts: list[Standing] = []
    if regular.any():
        labels = [label for label, stands in zip(use.labels, regular, strict=True) if stands]
        parts.append((use.arrays, transforms[regular], None if values is None else values[regular], labels))
    for i in np.flatnonzero(~regular):
        transform = transforms[i]
        vertices = use.arrays.vertices @ transform[:3, :3].T + transform[:3, 3]
        if np.linalg.matrix_rank(vertices - vertices[0]) < 2:
            continue  # a line or a point shows nothing
        flat = replace(use.arrays, vertices=vertices.astype(np.float32), normals=None)
        parts.append((flat, None, None if values is None else values[i : i + 1], [use.labels[i]]))
    return parts
