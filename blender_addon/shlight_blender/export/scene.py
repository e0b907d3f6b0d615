# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender scene as a shlight.Scene."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import bpy
import numpy as np

import shlight

from ..frame import Frame, frame_of
from ..passes import pass_wishes
from ..report import Effect, ExportCancelled, ExportError, ExportReport
from .bake import Waiting
from .camera import Eye, set_camera
from .expressions import Surroundings
from .image_pixels import TEXTURES
from .lights import add_lamp
from .meshes import MeshCollector
from .settings import report_unsupported_settings
from .world import add_world

ASKING_SECONDS = 0.05  # between questions whether the export is to go on

# Types of objects that have a surface or volume which is not exported. Curves, texts, surfaces and metaballs are not
# among them: the depsgraph gives their meshes as instances of their own.
UNSUPPORTED_TYPES = {
    "CURVES": "hair curves",
    "POINTCLOUD": "point clouds",
    "VOLUME": "volumes",
    "GPENCIL": "grease pencil drawings",
    "GREASEPENCIL": "grease pencil drawings",
}

# Flags of an object with the value at which they change nothing.
VISIBILITY = {
    "visible_camera": (True, "objects hidden from the camera are not supported; drawn as usual"),
    "visible_diffuse": (True, "objects hidden from diffuse rays are not supported; drawn as usual"),
    "visible_glossy": (True, "objects hidden from glossy rays are not supported; drawn as usual"),
    "visible_shadow": (True, "objects without shadow are not supported; drawn as usual"),
    "is_shadow_catcher": (False, "shadow catchers are not supported; drawn as usual"),
    "is_holdout": (False, "holdouts are not supported; drawn as usual"),
}


class ExportedScene(NamedTuple):
    """A scene ready for `shlight.render`."""

    scene: shlight.Scene
    report: ExportReport  # what of the Blender scene is not supported
    dark: str  # what the report says if nothing gives light, else ""
    operations: dict[str, int]  # of the program of each material whose values vary, for a hit
    texture_bytes: int  # of all textures that are kept
    is_of_one_camera: bool  # materials ask where the camera is
    names: dict[str, set[str]]  # what Cryptomatte may know: of each of passes.CRYPTOMATTES

    def look_from(self, depsgraph: Any, *, frame: Frame, camera: Any = None) -> None:
        """Another camera, or the same elsewhere; arguments and errors as of `export_scene`."""
        blender_scene = depsgraph.scene_eval
        eye = _eye(camera or blender_scene.camera, blender_scene, depsgraph)
        set_camera(self.scene, eye, depsgraph, frame, blender_scene.render, self.report)


def only_cameras_changed(depsgraph: Any) -> bool:
    """Whether all but cameras is as in the render before, of which Blender has kept `depsgraph`."""

    def is_of_camera(changed: Any) -> bool:
        return getattr(changed, "type", "") == "CAMERA" or isinstance(changed, (bpy.types.Camera, bpy.types.Action))

    # The pictures of a sequence change with the frame, and tell nobody.
    moving = any(image.source in {"SEQUENCE", "MOVIE"} for image in bpy.data.images)
    return not moving and all(is_of_camera(update.id) for update in depsgraph.updates)


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
    blender_scene = depsgraph.scene_eval
    frame = frame or frame_of(blender_scene.render)
    report = ExportReport()
    TEXTURES.begin_export()
    eye = _eye(camera or blender_scene.camera, blender_scene, depsgraph)
    scene = shlight.Scene()
    view = set_camera(scene, eye, depsgraph, frame, blender_scene.render, report)
    report_unsupported_settings(blender_scene, depsgraph.view_layer_eval, report)
    passes = pass_wishes(blender_scene, depsgraph.view_layer_eval)
    lit = add_world(scene, blender_scene, depsgraph.view_layer_eval, report, passes, waiting)
    surroundings = Surroundings(view, depsgraph, passes=passes)
    meshes = MeshCollector(report, surroundings, depsgraph.view_layer_eval.material_override)
    lit |= _add_objects(scene, depsgraph, meshes, report, _asking(waiting))
    for path in TEXTURES.unreadable:
        report.add(f"File '{path}'", "it cannot be read; magenta is used in the place of its picture", Effect.THING)
    dark = "" if lit else _report_darkness(blender_scene, report)
    operations = meshes.operations()
    return ExportedScene(
        scene, report, dark, operations, TEXTURES.size_in_bytes, surroundings.view_is_used, meshes.names()
    )


def _eye(camera: Any, blender_scene: Any, depsgraph: Any) -> Eye:
    if isinstance(camera, Eye):
        return camera
    if camera is None:
        raise ExportError(f"Scene '{blender_scene.name}' has no camera")
    if camera.type != "CAMERA":
        raise ExportError(f"the active camera of scene '{blender_scene.name}', '{camera.name}', is not a camera")
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


def _report_darkness(blender_scene: Any, report: ExportReport) -> str:
    """Reports that nothing gives light, with what of the light is left out; returns that line."""
    left_out = [message.line() for message in report if message.effect == Effect.LIGHT]
    place = f"Scene '{blender_scene.name}'"
    text = ". ".join(["it has no light that shlight can render; the picture is black", *left_out])
    report.add(place, text, Effect.DARK)
    return f"{place}: {text}"


def _add_objects(
    scene: shlight.Scene, depsgraph: Any, meshes: MeshCollector, report: ExportReport, ask: Callable[[], None]
) -> bool:
    """Adds all meshes and lamps; True if something gives light."""
    lit = False
    for instance in depsgraph.object_instances:
        ask()
        seen = instance.object
        if not instance.show_self or (seen.hide_render and not instance.is_instance):
            continue
        to_world = np.array(instance.matrix_world, dtype=np.float64)
        instancer = instance.parent if instance.is_instance else None
        if seen.type == "LIGHT":
            _report_light_linking((seen, instancer), f"Light '{seen.name}'", report)
            lit |= add_lamp(scene, seen, to_world, report, meshes.surroundings, instancer)
        elif seen.type == "MESH":
            _report_object(seen, instancer, report)
            meshes.add(instance, to_world)
        elif seen.type in UNSUPPORTED_TYPES:
            text = f"{UNSUPPORTED_TYPES[seen.type]} are not supported; left out"
            report.add(f"Object '{seen.name}'", text, Effect.THING)
    return meshes.hand_over(scene, ask) or lit


def _report_object(seen: Any, instancer: Any, report: ExportReport) -> None:
    place = f"Object '{seen.name}'"
    for name, (neutral, text) in VISIBILITY.items():
        if any(bool(getattr(shown, name, neutral)) != neutral for shown in (seen, instancer)):
            report.add(place, text, Effect.THING)
    for system in seen.particle_systems:
        settings = system.settings
        if settings.type == "HAIR" and settings.render_type == "PATH":
            hair = f"{place}, particle system '{system.name}'"
            report.add(hair, "hair is not supported; left out", Effect.THING)
    _report_light_linking((seen, instancer), place, report)


def _report_light_linking(shown_by: tuple[Any, Any], place: str, report: ExportReport) -> None:
    for shown in shown_by:
        linking = getattr(shown, "light_linking", None)
        if linking is not None and linking.receiver_collection:
            report.add(place, "light linking is not supported; it lights everything", Effect.LIGHT)
        if linking is not None and linking.blocker_collection:
            report.add(place, "shadow linking is not supported; everything shadows it", Effect.LIGHT)
