# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of a scene, which follow those of a depsgraph: one for all instances of the same mesh and materials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import shlight

from ..catchers import is_catcher
from ..compat import (
    DICES_OTHERWISE,
    Dicing,
    cage_of,
    curve_settings,
    dicing_of,
    is_preview,
    slot_materials,
    terminator_offsets,
)
from ..names import name_of
from ..passes import SURFACES
from ..report import Effect, ExportReport
from .changes import Changes
from .dicing import diced
from .displacement import displace
from .linking import Links
from .materials import Surface, read_material
from .mesh_arrays import MeshArrays, complete, flattened, object_arrays
from .mesh_attributes import UV
from .nodes import Surroundings
from .strands import CURVES, HAIR, strands_of
from .textured_meshes import shines_by_place, with_even_emission

Matrix = NDArray[np.float64]

# Instances of a mesh, at most, of which each shines as its own place and object have it.
MOST_SHINING_PLACES = 256

# Kinds of rays by the flags of objects that show them to these.
RAY_KINDS = {
    "visible_camera": "camera",
    "visible_diffuse": "diffuse",
    "visible_glossy": "glossy",
    "visible_transmission": "transmission",
    "visible_shadow": "shadow",
}


class Visibility(NamedTuple):
    """The rays that see an object, as arguments of Scene.add_mesh, and its links."""

    visible_to: tuple[str, ...]
    holdout: bool
    links: Links

    @staticmethod
    def of(instance: Any, surroundings: Surroundings) -> Visibility:
        """Reads the flags of an instance and of its collections in a view layer."""
        view_layer = surroundings.depsgraph.view_layer
        shown, instancer = instance.object, instance.parent if instance.is_instance else None
        original = shown.original
        hidden = {"camera"} if original.indirect_only_get(view_layer=view_layer) else set()
        part, catches = surroundings.part, is_catcher(instance)
        hidden |= part.hidden_from(catches)
        for flag, kind in RAY_KINDS.items():
            if not getattr(shown, flag) or not (instancer is None or getattr(instancer, flag)):
                hidden.add(kind)
        kinds = tuple(kind for kind in RAY_KINDS.values() if kind not in hidden)
        links = surroundings.linking.links(shown, instancer)
        holdout = original.holdout_get(view_layer=view_layer) or part.holds_out(catches)
        return Visibility(kinds, holdout, links)


class Label(NamedTuple):
    """The names and numbers of an object in passes."""

    name: str
    asset: str
    pass_index: int


def _label(shown: Any) -> Label:
    """An asset is all that hangs on one object without a parent."""
    root = shown
    while root.parent is not None:
        root = root.parent
    return Label(name_of(shown), name_of(root), int(shown.pass_index))


@dataclass
class KeptMesh:
    """A mesh in the scene, with a surface for each material slot (at least one), and all places where it stands."""

    mesh: shlight.SceneMesh | None  # None: nothing of it is seen
    owner: str | None  # the object that it is the mesh of; None: of none, a modifier has made it
    place: str  # how the report names it
    attributes: frozenset[str]  # that were asked for
    surfaces: list[Surface]
    faces: NDArray[np.int64]  # how many of each surface
    is_of_place: bool  # it is cut into pieces, or displaced, for its first place
    is_of_strands: bool  # see strands.py
    group: str | None  # see PassWishes.light_part
    report: ExportReport
    transforms: list[Matrix] = field(default_factory=list)
    object_values: list[list[float]] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    stands: tuple[Any, ...] | None = None  # all three, as the scene has them

    def emits(self) -> bool:
        """True if something of it gives light."""
        return any(bool(own.emission.any()) for own, faces in zip(self.surfaces, self.faces, strict=True) if faces)


class SceneMeshes:
    """Keeps the meshes of a scene like those of a depsgraph: `begin`, `add` for each instance, then `finish`."""

    def __init__(self, scene: shlight.Scene) -> None:
        self._scene = scene
        self._kept: dict[tuple[Any, ...], KeptMesh] = {}
        self._surfaces: dict[Any, tuple[Surface, ExportReport]] = {}  # by materials
        self._override: Any = None
        self._is_anything_lit = True
        self.report = ExportReport()

    def begin(self, changes: Changes, surroundings: Surroundings, material_override: Any = None) -> None:
        """Starts a walk over all instances."""
        self._changes = changes
        self._surroundings = surroundings
        self._override = material_override
        self._seen: dict[tuple[Any, ...], KeptMesh] = {}
        self._shining_places: Counter[tuple[Any, ...]] = Counter()
        self._told: set[int] = set()  # the reports of materials that this one has, by id
        self._shines_alone = False  # something shines where nothing is lit
        self.report = ExportReport()
        if changes.materials:
            self._surfaces.clear()

    def find_lit(self, shown: Iterable[Any]) -> None:
        """Looks for a surface that is lit, after `begin`, among the objects that are to be drawn: where there is none,
        what shines is seen and lights nothing, so that its light is neither cut into pieces nor sorted."""
        materials = (material for own in shown for material in slot_materials(own) or [None])
        is_anything_lit = any(self._read(material)[0].is_lit() for material in materials)
        if is_anything_lit != self._is_anything_lit:
            self._is_anything_lit = is_anything_lit
            self._changes = replace(self._changes, materials=True)

    def add(self, instance: Any, to_world: Matrix, kind: str = "") -> None:
        """Notes one instance of the depsgraph that shows a mesh, or a kind of strands, at `to_world`."""
        mesh_object = instance.object
        if not np.isfinite(to_world).all():
            self.report.add(_place_of(mesh_object), "its transform is not finite; left out", Effect.THING)
            return
        materials = slot_materials(mesh_object)
        own = (material and material.as_pointer() for material in materials)
        curves = curve_settings(self._surroundings.depsgraph.scene_eval) if kind in (HAIR, CURVES) else {}
        visibility = Visibility.of(instance, self._surroundings)
        dicing = None if kind else dicing_of(mesh_object, self._surroundings.depsgraph)
        settings = (terminator_offsets(mesh_object), visibility, kind, dicing, *curves.values())
        key = (mesh_object.data.as_pointer(), self._group(mesh_object), *settings, *own)
        flat = _is_flat(to_world)
        if flat and kind:
            self.report.add(_place_of(mesh_object), "it has no extent in a direction; left out", Effect.THING)
            return
        surfaces = [self._surface(material) for material in materials or [None]]
        if not self._is_anything_lit:
            self._shines_alone |= any(surface.emits() for surface in surfaces)
            surfaces = [surface.lighting_nothing() for surface in surfaces]
        if flat:  # a mesh of its own, which stands where it is
            key = (*key, len(self._seen))
        elif any(shines_by_place(surface) for surface in surfaces):
            key = (*key, self._shining_place(key, mesh_object))
        if key not in self._seen:
            kept = self._kept_mesh(key, instance, to_world, surfaces)
            self._seen[key] = kept or (
                self._convert_strands(instance, kind, curves, surfaces, visibility)
                if kind
                else self._convert(instance, to_world, surfaces, flat, visibility, dicing)
            )
        use = self._seen[key]
        use.transforms.append(np.eye(4) if flat else to_world)
        use.object_values.append(self._surroundings.object_values.of(instance))
        use.labels.append(_label(mesh_object))

    def _shining_place(self, key: tuple[Any, ...], shown: Any) -> int:
        """The number of the mesh, among those of this key, that the next instance is an instance of."""
        self._shining_places[key] += 1
        if self._shining_places[key] == MOST_SHINING_PLACES + 1:
            text = f"only {MOST_SHINING_PLACES} of its instances shine as their place has it; the others as the last"
            self.report.add(_place_of(shown), text, Effect.LIGHT)
        return min(self._shining_places[key], MOST_SHINING_PLACES)

    def _kept_mesh(
        self, key: tuple[Any, ...], instance: Any, to_world: Matrix, surfaces: list[Surface]
    ) -> KeptMesh | None:
        """The kept mesh, if it need not be converted again."""
        kept = self._kept.get(key)
        if kept is None or self._changes.all_shapes:
            return None
        shapes = self._changes.shapes
        if name_of(instance.object, "name_full") in shapes or (kept.owner in shapes if kept.owner else bool(shapes)):
            return None
        first_place, first_values = kept.transforms[0], kept.object_values[0]
        kept.transforms, kept.object_values, kept.labels = [], [], []
        if not self._changes.materials:
            # Displacement is that of one time of the picture, as in Cycles.
            stays = not kept.is_of_place or (self._changes.motion and not _is_cut(surfaces))
            is_same = first_values == self._surroundings.object_values.of(instance)
            return kept if stays or (is_same and np.array_equal(first_place, to_world)) else None
        if kept.is_of_place or (not kept.is_of_strands and (_is_cut(surfaces) or _is_displaced(surfaces))):
            return None
        if not self._attributes(surfaces) <= kept.attributes:
            return None
        kept.surfaces = surfaces
        if kept.mesh is not None:
            kept.mesh.set_bsdf(**_materials(kept))
        return kept

    def _attributes(self, surfaces: Sequence[Surface]) -> frozenset[str]:
        """The attributes that a mesh needs for its materials and the passes."""
        needs_uvs = self._surroundings.passes.uvs or any(surface.follows_uvs for surface in surfaces)
        return _attribute_names(surfaces) | ({UV} if needs_uvs else set())

    def _group(self, mesh_object: Any) -> str | None:
        return self._surroundings.passes.light_part(SURFACES, name_of(mesh_object, "lightgroup"))

    def _displaced(
        self, instance: Any, to_world: Matrix, surfaces: list[Surface], dicing: Dicing | None, report: ExportReport
    ) -> MeshArrays | None:
        """The mesh of an instance as its materials leave it."""
        shown, place, surroundings = instance.object, _place_of(instance.object), self._surroundings
        names, moves = sorted(self._attributes(surfaces)), _is_displaced(surfaces)
        if dicing is not None and any(own.emission.any() or own.varying for own in surfaces):
            text = "adaptive subdivision of what shines is not supported; its mesh is as its modifiers leave it"
            report.add(place, text, Effect.SLIGHT)
            dicing = None
        source = shown if dicing is None or dicing.curved else cage_of(shown)
        is_diced = dicing is not None
        arrays = object_arrays(source, place, names, report, displaced=moves or is_diced, whole=is_diced)
        if arrays is not None and dicing is not None and (moves or dicing.curved or arrays.normals is not None):
            # In a viewport the view that it is divided for stays until something else of it changes.
            view = surroundings.camera_view if is_preview(surroundings.depsgraph) else surroundings.view
            arrays, text = diced(arrays, dicing, to_world, view if dicing.in_pixels else None)
            if text:
                report.add(place, text, Effect.SLIGHT)
            if DICES_OTHERWISE and (dicing.curved or not moves):
                report.add(place, "adaptive subdivision of smooth meshes is that of Blender 4.5")
        if arrays is None or not moves:
            return arrays
        displacements = [surface.displacement for surface in surfaces]
        return displace(arrays, displacements, to_world, surroundings.object_values.of(instance))

    def _convert(
        self,
        instance: Any,
        to_world: Matrix,
        surfaces: list[Surface],
        flat: bool,
        visibility: Visibility,
        dicing: Dicing | None,
    ) -> KeptMesh:
        """The mesh of an instance, added to the scene where nothing shows it yet; flat: as it stands at to_world."""
        shown, place, report = instance.object, _place_of(instance.object), ExportReport()
        attributes = self._attributes(surfaces)
        is_cut = _is_cut(surfaces)
        arrays = self._displaced(instance, to_world, surfaces, dicing, report)
        if arrays is not None:
            names = sorted(_attribute_names(surfaces))
            complete(arrays.attributes, arrays.triangles.shape, shown, names, report)
        if arrays is not None and flat:
            arrays = flattened(arrays, to_world)
        if arrays is not None and is_cut:
            at = np.eye(4) if flat else to_world
            values = self._surroundings.object_values.of(instance)
            arrays, surfaces = with_even_emission(arrays, surfaces, at, values, partial(report.add, place))
        owner = _owner(instance, self._surroundings.depsgraph)
        none = np.zeros(len(surfaces), dtype=np.int64)
        of_place, group = is_cut or _is_displaced(surfaces) or dicing is not None, self._group(shown)
        made = KeptMesh(None, owner, place, attributes, surfaces, none, of_place, False, group, report)
        if arrays is not None:
            slots = np.clip(arrays.material_indices, 0, len(surfaces) - 1)
            geometry_offset, shading_offset = terminator_offsets(shown)
            made.faces = np.bincount(slots, minlength=len(surfaces))
            casts_shadows = "shadow" in visibility.visible_to
            if made.emits() and not casts_shadows:
                text = "it shines and is hidden from shadow rays; its far sides light what is before it"
                report.add(place, text, Effect.LIGHT)
            if not casts_shadows and any(own.refracts() for own in surfaces):
                text = "it refracts and is hidden from shadow rays; Cycles counts a part of the light through it twice"
                report.add(place, text, Effect.LIGHT)
            links = visibility.links
            if made.emits() and links.shadow_set not in (links.blockers or (links.shadow_set,)) and len(slots) > 2:
                report.add(place, "shadow linking lets its light through itself; here it does not", Effect.LIGHT)
            made.mesh = self._scene.add_mesh(
                arrays.vertices,
                arrays.triangles,
                normals=arrays.normals,
                uvs={UV: arrays.attributes[UV]} if UV in arrays.attributes else None,
                attributes=arrays.attributes,
                material_indices=slots,
                transforms=np.empty((0, 4, 4)),
                turn_normals=False,
                terminator_geometry_offset=geometry_offset,
                terminator_shading_offset=shading_offset,
                visible_to=visibility.visible_to,
                holdout=visibility.holdout,
                **visibility.links._asdict(),
                **_materials(made),
            )
        return made

    def _convert_strands(
        self, instance: Any, kind: str, curves: dict[str, Any], surfaces: list[Surface], visibility: Visibility
    ) -> KeptMesh:
        """The same of strands of a kind."""
        shown, place, report = instance.object, _place_of(instance.object), ExportReport()
        attributes, depsgraph = self._attributes(surfaces), self._surroundings.depsgraph
        strands = strands_of(kind, shown, place, sorted(attributes), depsgraph, report)
        owner, group = _owner(instance, depsgraph), self._group(shown)
        none = np.zeros(len(surfaces), dtype=np.int64)
        made = KeptMesh(None, owner, place, attributes, surfaces, none, False, True, group, report)
        if strands is None:
            return made
        names = sorted(_attribute_names(surfaces))
        complete(strands.attributes, strands.radii.shape, shown, names, report)
        slots = np.clip(strands.materials, 0, len(surfaces) - 1)
        if any(surfaces[slot].emission.any() for slot in np.unique(slots)):
            report.add(place, "its hair or points shine, and light nothing but by bounces", Effect.LIGHT)
        shape, add = (strands.points, strands.radii), self._scene.add_point_cloud
        if strands.first is not None:
            add = partial(self._scene.add_curves, first=strands.first, **curves)
        made.mesh = add(
            *shape,
            uvs={UV: strands.attributes[UV]} if UV in strands.attributes else None,
            attributes=strands.attributes,
            material_indices=slots,
            transforms=np.empty((0, 4, 4)),
            terminator_shading_offset=terminator_offsets(shown)[1],
            visible_to=visibility.visible_to,
            holdout=visibility.holdout,
            light_set=visibility.links.light_set,
            shadow_set=visibility.links.shadow_set,
            **_materials(made),
        )
        return made

    def _read(self, material: Any) -> tuple[Surface, ExportReport]:
        material = self._override or material
        key = material and material.as_pointer()
        if key not in self._surfaces:
            report = ExportReport()
            self._surfaces[key] = read_material(material, report, self._surroundings), report
        return self._surfaces[key]

    def _surface(self, material: Any) -> Surface:
        surface, report = self._read(material)
        if id(report) not in self._told:
            self._told.add(id(report))
            self.report.extend(report)
        return surface

    def operations(self) -> dict[str, int]:
        """How many operations a hit takes, by the name of each material whose values vary."""
        return {own.name: own.operation_count for own, _ in self._surfaces.values() if own.operation_count > 0}

    def names(self) -> dict[str, set[str]]:
        """The names of all drawn objects, materials and assets."""
        labels = [label for use in self._kept.values() for label in use.labels]
        return {
            "object": {label.name for label in labels},
            "material": {own.name for own, _ in self._surfaces.values()},
            "asset": {label.asset for label in labels},
        }

    def finish(self, ask: Callable[[], None]) -> bool:
        """Ends the walk: the scene has all meshes that were seen where they stand, and no others; `ask` is called for
        each. True if some of it emits light."""
        for key, kept in self._kept.items():
            if kept.mesh is not None and self._seen.get(key) is not kept:
                kept.mesh.remove()
        self._kept = self._seen
        emits = self._shines_alone
        for use in self._seen.values():
            ask()
            self.report.extend(use.report)
            emits |= use.emits()
            _place(use)
        return emits

    def remark_doubled(self, doubled: Iterable[tuple[int, int]], report: ExportReport) -> None:
        """Names the objects of `shlight.RenderReport.doubled`."""
        labels = {use.mesh.index: use.labels for use in self._kept.values() if use.mesh is not None}
        for mesh, instance in doubled:
            place = f"Object '{labels[mesh][instance].name}'"
            report.add(place, "some of its faces lie on others; they are black or have dark patches, as in Cycles")


def _place_of(shown: Any) -> str:
    """An object as the report names it."""
    return f"Object '{name_of(shown)}'"


def _place(use: KeptMesh) -> None:
    """Moves a mesh of the scene to where it stands, if it does not stand there."""
    most = max(len(values) for values in use.object_values)
    values = [[*own, *[0.0] * (most - len(own))] for own in use.object_values] if most else None
    transforms = np.array(use.transforms)
    stands = (transforms.tobytes(), values, use.labels)
    if use.mesh is not None and stands != use.stands:
        use.mesh.set_transforms(
            transforms,
            object_values=values,
            object_names=[label.name for label in use.labels],
            asset_names=[label.asset for label in use.labels],
            object_indices=[label.pass_index for label in use.labels],
        )
    use.stands = stands


def _attribute_names(surfaces: Sequence[Surface]) -> frozenset[str]:
    return frozenset(name for surface in surfaces for name in surface.attribute_names)


def _is_cut(surfaces: Sequence[Surface]) -> bool:
    return any(surface.varying is not None for surface in surfaces)


def _is_displaced(surfaces: Sequence[Surface]) -> bool:
    return any(surface.displacement is not None for surface in surfaces)


def _materials(use: KeptMesh) -> dict[str, Any]:
    """The arguments of `shlight.Scene.add_mesh` about materials."""
    return {
        "bsdf": [own.shader for own in use.surfaces],
        "emission": np.array([np.broadcast_to(own.emission, (2, 3)) for own in use.surfaces]) if use.emits() else None,
        "group": use.group,
        "material_names": [own.name for own in use.surfaces],
        "material_pass_indices": [own.pass_index for own in use.surfaces],
    }


def _owner(instance: Any, depsgraph: Any) -> str | None:
    """The object whose own mesh an instance shows; None: a modifier has made it."""
    shown = instance.object
    if instance.is_instance:
        own = shown.original.evaluated_get(depsgraph).data
        if own is None or own.as_pointer() != shown.data.as_pointer():
            return None
    return name_of(shown, "name_full")


def _is_flat(to_world: Matrix) -> bool:
    """True for a transform without inverse."""
    # Ten times as fast as numpy, which counts where there are many thousands of instances.
    (a, b, c), (d, e, f), (g, h, i) = to_world[:3, :3].tolist()
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    largest = max(a * a + d * d + g * g, b * b + e * e + h * h, c * c + f * f + i * i)
    return abs(determinant) <= 1e-9 * largest**1.5
