# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender scene as a shlight.Scene."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import bpy
import numpy as np

import shlight

from ..catchers import Part, is_catcher
from ..compat import curve_settings, dicing_settings
from ..frame import Frame, frame_of
from ..light_mix import Factors, factors_of
from ..names import name_of
from ..passes import PassWishes, pass_wishes
from ..report import Effect, ExportCancelled, ExportError, ExportReport
from .camera import Eye, View, set_camera
from .changes import Changes, everything
from .images import TEXTURES
from .lights import add_lamp
from .linking import Linking
from .meshes import SceneMeshes
from .nodes import Surroundings
from .seen_objects import Culling, culling_of, shares_of_picture
from .settings import filter_glossy, report_unsupported_settings, world_of
from .strands import CURVES, HAIR, POINT_CLOUD, hair_systems
from .world import SceneWorld

# Called with what is being done while time passes; False: stop it.
Waiting = Callable[[str], bool]
# Filter Glossy from which on light through clear glass is as soft in Cycles as that of records.
WIDE_FILTER = 0.5
ASKING_SECONDS = 0.05  # between questions whether the export is to go on

# Types of objects that are drawn, and the kinds of strands (strands.py) that they are. Of curves, texts, surfaces and
# metaballs the depsgraph gives the meshes as instances of their own.
DRAWN_TYPES = {"MESH": "", CURVES: CURVES, POINT_CLOUD: POINT_CLOUD}
# Types of objects that have a surface or volume which is not exported.
UNSUPPORTED_TYPES = {
    "VOLUME": "volumes",
    "GPENCIL": "grease pencil drawings",
    "GREASEPENCIL": "grease pencil drawings",
}
# Filters of a view layer that leave some of both out of Cycles' picture too.
FILTERS = {"MESH": "use_solid", CURVES: "use_strand", "VOLUME": "use_volumes"}


class _State(NamedTuple):
    """State that Blender does not list among the changes of a scene."""

    world: Any = None
    materials: Any = None  # the material in place of all others, whether light bounces, and by sharp glass
    moving_frame: float = 0.0  # of pictures that change with the frame
    passes: PassWishes = PassWishes()
    shown: tuple[Any, ...] = ()  # whether meshes are, what is culled, and the objects of all instances that are seen
    linking: Linking = Linking({})
    factors: Factors = {}  # of the light mixer

    @staticmethod
    def of(depsgraph: Any, viewport: Any, culling: Culling | None, factors: Factors | None) -> _State:
        scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
        world = world_of(scene, view_layer)
        moving = any(image.source in {"SEQUENCE", "MOVIE"} for image in bpy.data.images)
        override = view_layer.material_override
        bounces = scene.shlight.max_bounces if viewport is None else scene.shlight.preview_max_bounces
        seen = (
            own.object.as_pointer()
            for own in depsgraph.object_instances
            if _is_seen(own, viewport) or _is_hairy(own, viewport, depsgraph)
        )
        drawing = (*curve_settings(scene).values(), *dicing_settings(depsgraph))
        return _State(
            (world and world.as_pointer(), scene.render.film_transparent, scene.shlight.world_width),
            (override and override.as_pointer(), bounces > 0, filter_glossy(scene) < WIDE_FILTER),
            scene.frame_current_final if moving else 0.0,
            pass_wishes(scene, view_layer) if viewport is None else PassWishes(lamps=factors is not None),
            (view_layer.use_solid, view_layer.use_strand, culling, *drawing, *seen),
            Linking.of(depsgraph),
            factors or {},
        )


class ExportedScene:
    """A shlight.Scene that follows a scene of Blender: `look_from` a camera first, then `update`.

    scene: ready for `shlight.render` after both; what shines lights nothing where no surface is lit.
    meshes: its meshes, with their names and what their materials take.
    dark: what the report says if nothing gives light, else "".
    """

    def __init__(self, part: Part = Part.WHOLE) -> None:
        """part: of the scene; the camera sees it."""
        self.scene = shlight.Scene()
        self._part = part
        self.dark = ""
        self._view: View | None = None
        self._frame: Frame | None = None  # of a camera's picture
        self._culling: Culling | None = None
        self._surroundings = Surroundings()
        self.meshes = SceneMeshes(self.scene)
        self._world = SceneWorld(self.scene, part)
        self._state = _State()
        self._is_lit: dict[str, bool] = {}  # by the part of the scene that gives light or none
        self._reports: dict[str, ExportReport] = {}  # likewise
        self._told: set[Any] = set()  # the objects, and what shows them, that the report of objects has
        self._is_moving = False  # to another time of the same picture
        self._still: dict[Any, Any] = {}  # where instances are that motion blur leaves out

    @property
    def report(self) -> ExportReport:
        """The parts of the Blender scene that are not supported."""
        whole = ExportReport()
        for part in self._reports.values():
            whole.extend(part)
        return whole

    @property
    def is_of_one_camera(self) -> bool:
        """Whether materials ask where the camera is."""
        return self._surroundings.view_is_used

    def look_from(self, depsgraph: Any, *, frame: Frame, camera: Any = None) -> None:
        """Another camera, or the same elsewhere; arguments and errors as of `export_scene`."""
        blender_scene = depsgraph.scene_eval
        eye = _eye(camera or blender_scene.camera, blender_scene, depsgraph)
        report = self._new_report("camera")
        self._view = set_camera(self.scene, eye, depsgraph, frame, blender_scene.render, report)
        self._frame = frame
        self._culling = culling_of(blender_scene, eye.camera.evaluated_get(depsgraph).data, self._view)

    def look_through(self, view: Any) -> None:
        """A view of a viewport in place of a camera; view: a ViewportView."""
        self._new_report("camera")
        self._view, self._frame, self._culling = view.set_camera(self.scene), None, None

    def update(
        self,
        depsgraph: Any,
        changes: Changes,
        *,
        viewport: Any = None,
        waiting: Waiting | None = None,
        factors: Factors | None = None,
    ) -> bool:
        """Takes over what has changed; False if nothing has. `waiting`, and errors, as of `export_scene`.

        viewport: a SpaceView3D; what is hidden in it is left out, in place of what is hidden in renders.
        factors: of the light mixer, None where it is off.
        """
        self._find_more(changes, _State.of(depsgraph, viewport, self._culling, factors))
        blender_scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
        report_unsupported_settings(blender_scene, view_layer, self._new_report("settings"))
        if self._state.linking.has_too_many_sets():
            text = (
                "lights tell more than 64 sets of receivers or 28 of blockers apart; the others are as objects of none"
            )
            self._reports["settings"].add(f"Scene '{name_of(blender_scene)}'", text, Effect.LIGHT)
        if changes.world:
            self._is_lit["world"] = self._world.read(depsgraph, self._state.passes, self._new_report("world"))
        if changes.materials:
            TEXTURES.begin_export()
            _, bounces, sharply = self._state.materials
            self._surroundings = Surroundings(
                self._view, passes=self._state.passes, light_bounces=bounces, sharp_caustics=sharply, part=self._part
            )
        self._surroundings.depsgraph, self._surroundings.linking = depsgraph, self._state.linking
        self._surroundings.factors = self._state.factors
        if changes:
            self._walk(depsgraph, changes, viewport, _asking(waiting))
        report = self._new_report("files")
        for path in TEXTURES.unreadable:
            report.add(f"File '{path}'", "it cannot be read; magenta is used in the place of its picture", Effect.THING)
        self._weigh_report(depsgraph)
        self._find_darkness(blender_scene)
        return bool(changes)

    def move(
        self, depsgraph: Any, changes: Changes, *, frame: Frame, camera: Any = None, waiting: Waiting | None = None
    ) -> None:
        """Takes over where things are at another time while the shutter is open; all else stays, as in Cycles."""
        self.look_from(depsgraph, frame=frame, camera=camera)
        self._surroundings.depsgraph = depsgraph
        self._is_moving = True
        self._walk(depsgraph, changes, None, _asking(waiting))
        self._is_moving = False

    def _new_report(self, part: str) -> ExportReport:
        self._reports[part] = ExportReport()
        return self._reports[part]

    def _find_more(self, changes: Changes, state: _State) -> None:
        """Adds what Blender does not list."""
        old, self._state = self._state, state
        moved = state.moving_frame != old.moving_frame or state.passes != old.passes
        looks_elsewhere = self.is_of_one_camera and self._surroundings.camera_view != self._view
        changes.world |= moved or state.world != old.world
        changes.materials |= moved or looks_elsewhere or state.materials != old.materials
        changes.objects |= state.shown != old.shown or state.linking != old.linking
        changes.lamps |= moved or changes.world or changes.objects or state.factors != old.factors

    def _walk(self, depsgraph: Any, changes: Changes, viewport: Any, ask: Callable[[], None]) -> None:
        """Adds the lamps and meshes that are seen, where they have changed."""
        walks_meshes = changes.objects or changes.materials
        if changes.lamps:
            self.scene.remove_lights()
            self._world.add_suns()
            self._is_lit["lamps"] = False
            self._new_report("lamps")
        if walks_meshes:
            self.meshes.begin(changes, self._surroundings, depsgraph.view_layer_eval.material_override)
            self._new_report("objects")
            self._told = set()
            self.meshes.find_lit(_drawn(depsgraph, viewport))
        for instance in depsgraph.object_instances:
            ask()
            is_seen = _is_seen(instance, viewport)
            if instance.object.type == "LIGHT":
                if is_seen and changes.lamps:
                    self._is_lit["lamps"] |= self._add_lamp(instance)
            elif walks_meshes and (is_seen or _is_hairy(instance, viewport, depsgraph)):
                self._add_object(instance, depsgraph, viewport)
        if walks_meshes:
            self._is_lit["objects"] = self.meshes.finish(ask)
            self._reports["objects"].extend(self.meshes.report)

    def _add_lamp(self, instance: Any) -> bool:
        report, instancer = self._reports["lamps"], _instancer(instance)
        return add_lamp(self.scene, instance.object, _to_world(instance), report, self._surroundings, instancer)

    def _add_object(self, instance: Any, depsgraph: Any, viewport: Any) -> None:
        seen, view_layer, report = instance.object, depsgraph.view_layer_eval, self._reports["objects"]
        to_world = self._place(instance)
        if self._culling is not None and self._culling.leaves_out(seen, to_world):
            return
        is_drawn = _is_seen(instance, viewport) and getattr(view_layer, FILTERS.get(seen.type, ""), True)
        if seen.type in DRAWN_TYPES:
            instancer = _instancer(instance)
            # Instances share one address, which is not that of what they show.
            key = (seen.original.as_pointer(), instancer and instancer.as_pointer())
            if key not in self._told:
                self._told.add(key)
                _report_object(seen, view_layer, report)
                if viewport is not None and is_catcher(instance):
                    text = "shadow catchers are drawn as usual in viewports"
                    report.add(f"Object '{name_of(seen)}'", text, Effect.THING)
            if is_drawn:
                self.meshes.add(instance, to_world, DRAWN_TYPES[seen.type])
            if view_layer.use_strand and _is_hairy(instance, viewport, depsgraph):
                self.meshes.add(instance, to_world, HAIR)
        elif seen.type in UNSUPPORTED_TYPES and is_drawn:
            text = f"{UNSUPPORTED_TYPES[seen.type]} are not supported; left out"
            report.add(f"Object '{name_of(seen)}'", text, Effect.THING)

    def _place(self, instance: Any) -> Any:
        """The transform of an instance; one that is not to be blurred keeps that of the picture's own time."""
        to_world, instancer = _to_world(instance), _instancer(instance)
        if _moves(instance.object) and (instancer is None or _moves(instancer)):
            return to_world
        key = instance.object.original.as_pointer(), instancer and instancer.name_full, *instance.persistent_id
        if not self._is_moving:
            self._still[key] = to_world
        return self._still.get(key, to_world)

    def _weigh_report(self, depsgraph: Any) -> None:
        """Orders the report of a picture by how much of it each finding can change."""
        own, report = self.report, self._new_report("shares")
        if self._view is not None and self._frame is not None and len(own) > 1:
            report.weigh(shares_of_picture(depsgraph, self._view, self._frame, own.things()))

    def _find_darkness(self, blender_scene: Any) -> None:
        """Reports if nothing gives light, with what of the light is left out."""
        report = self._new_report("darkness")
        self.dark = ""
        if not any(self._is_lit.values()):
            left_out = [message.line() for message in self.report if message.effect == Effect.LIGHT]
            text = ". ".join(["it has no light that shlight can render; the picture is black", *left_out])
            self.dark = f"Scene '{name_of(blender_scene)}': {text}"
            report.add(f"Scene '{name_of(blender_scene)}'", text, Effect.DARK)


def export_scene(
    depsgraph: Any, *, frame: Frame | None = None, camera: Any = None, waiting: Waiting | None = None
) -> ExportedScene:
    """The evaluated scene of `depsgraph` with its camera.

    depsgraph: in a render engine the one it is given, else `bpy.context.evaluated_depsgraph_get()`, which shows what
        the viewport shows: an object hidden there is missing, and modifiers have their viewport settings.
    frame: the picture and its part to render; None: resolution and render border of `scene.render`.
    camera: the camera object, or one eye of it; None: the scene's camera.
    waiting: called with what is being done, a few times a second; False stops it.
    Raises ExportError if there is no camera or one that is not supported, and ExportCancelled if `waiting` stopped it.
    A scene without light is black, and the report says so.
    """
    exported = ExportedScene()
    exported.look_from(depsgraph, frame=frame or frame_of(depsgraph.scene_eval.render), camera=camera)
    exported.update(depsgraph, everything(), waiting=waiting, factors=factors_of(depsgraph.scene_eval))
    return exported


def _eye(camera: Any, blender_scene: Any, depsgraph: Any) -> Eye:
    if isinstance(camera, Eye):
        return camera
    if camera is None:
        raise ExportError(f"Scene '{name_of(blender_scene)}' has no camera")
    if camera.type != "CAMERA":
        raise ExportError(
            f"the active camera of scene '{name_of(blender_scene)}', '{name_of(camera)}', is not a camera"
        )
    evaluated = camera.evaluated_get(depsgraph)
    return Eye(camera, evaluated.matrix_world, evaluated.data.shift_x)


def _asking(waiting: Waiting | None) -> Callable[[], None]:
    """To be called between objects: raises ExportCancelled if the export is to stop."""
    last = time.monotonic()

    def ask() -> None:
        nonlocal last
        if waiting is not None and (now := time.monotonic()) - last >= ASKING_SECONDS:
            last = now
            if not waiting("Exporting the scene"):
                raise ExportCancelled

    return ask


def _is_hairy(instance: Any, viewport: Any, depsgraph: Any) -> bool:
    """Whether hair of an instance's particle systems is seen."""
    return (
        instance.object.type == "MESH"
        and len(instance.object.particle_systems) > 0
        and _is_seen(instance, viewport, "show_particles")
        and bool(hair_systems(instance.object, depsgraph))
    )


def _is_seen(instance: Any, viewport: Any, switch: str = "show_self") -> bool:
    """Whether an instance of the depsgraph is seen, in renders or, if one is given, in a viewport."""
    if not getattr(instance, switch):
        return False
    if viewport is None:
        return instance.is_instance or not instance.object.hide_render
    shown = instance.parent if instance.is_instance else instance.object
    return bool(shown.visible_in_viewport_get(viewport))


def _drawn(depsgraph: Any, viewport: Any) -> Iterator[Any]:
    """The objects that may be drawn, for each of their instances."""
    for instance in depsgraph.object_instances:
        if instance.object.type in DRAWN_TYPES and (
            _is_seen(instance, viewport) or _is_hairy(instance, viewport, depsgraph)
        ):
            yield instance.object


def _instancer(instance: Any) -> Any:
    """The object that shows an instance; None: the object itself."""
    return instance.parent if instance.is_instance else None


def _moves(shown: Any) -> bool:
    """Whether motion blur is that of the object: the switch is that of Cycles' add-on."""
    return bool(getattr(getattr(shown.original, "cycles", None), "use_motion_blur", True))


def _to_world(instance: Any) -> Any:
    return np.array(instance.matrix_world, dtype=np.float64)


def _report_object(seen: Any, view_layer: Any, report: ExportReport) -> None:
    place = f"Object '{name_of(seen)}'"
    blur = getattr(seen.original, "cycles", None)
    if view_layer.id_data.render.use_motion_blur and not getattr(blur, "use_deform_motion", True):
        report.add(place, "its deformation is blurred although that is switched off")
