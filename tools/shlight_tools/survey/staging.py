# SPDX-License-Identifier: MIT
"""Opening the file of a survey, and the camera and lamps for one that has none."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy
from mathutils import Matrix, Vector

from shlight_blender.background import open_blend
from shlight_blender.worker_process import SceneError

VIEW = Vector((1.0, -1.3, 0.8)).normalized()  # from what is seen to the camera
ROOM = 1.08  # times the distance at which everything just fits
KEY, FILL = Vector((-0.8, 0.7, 1.0)), Vector((1.0, 0.2, 0.7))  # lamps, to the camera's right, up and back
LAMP_DISTANCE, LAMP_SIZE = 2.5, 1.0  # times the radius of what is lit
IRRADIANCE = math.pi  # of the key lamp: white paper then has radiance 1
FILL_SHARE = 0.3


def open_file(path: Path) -> Any:
    """The scene of a Blender file, or of a glTF file by Blender's importer; with its first camera if it has several."""
    scene = open_blend(path) if path.suffix.lower() == ".blend" else _import(path)
    if scene is None:
        raise SceneError("there is no scene in it")
    if scene.camera is None:
        scene.camera = next((seen for seen in scene.objects if seen.type == "CAMERA"), None)
    return scene


def _import(path: Path) -> Any:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=str(path.resolve()))
    return bpy.context.scene


def add_camera(scene: Any) -> None:
    """A camera that sees everything from a three-quarter view; the size of the picture is to be set before."""
    camera = scene.camera = _link(scene, "Survey camera", bpy.data.cameras.new("Survey camera"))
    corners = _corners()
    camera.matrix_world = _looking(VIEW, Vector())
    depsgraph = bpy.context.evaluated_depsgraph_get()
    location, _ = camera.camera_fit_coords(depsgraph, [x for corner in corners for x in corner])
    centre, radius = _sphere(corners)
    location = centre + ROOM * (location - centre)
    camera.matrix_world = _looking(VIEW, location)
    distance = max((location - centre).length, radius)
    camera.data.clip_start, camera.data.clip_end = 1e-3 * distance, 1e3 * distance


def add_lamps(scene: Any) -> None:
    """A key lamp and a fill lamp beside the camera, for everything."""
    centre, radius = _sphere(_corners())
    to_world = scene.camera.matrix_world.to_3x3().normalized()
    for name, direction, share in (("Survey key", KEY, 1.0), ("Survey fill", FILL, FILL_SHARE)):
        towards = (to_world @ direction).normalized()
        distance = LAMP_DISTANCE * radius
        lamp = bpy.data.lights.new(name, "AREA")
        lamp.size = LAMP_SIZE * radius
        lamp.energy = share * IRRADIANCE * math.pi * distance**2
        _link(scene, name, lamp).matrix_world = _looking(towards, centre + distance * towards)


def _link(scene: Any, name: str, data: Any) -> Any:
    made = bpy.data.objects.new(name, data)
    scene.collection.objects.link(made)
    return made


def _looking(back: Vector, location: Vector) -> Matrix:
    """Placed at `location`, with local z along `back`: cameras and lamps look the other way."""
    return Matrix.Translation(location) @ back.to_track_quat("Z", "Y").to_matrix().to_4x4()


def _corners() -> list[Vector]:
    """Corners of the bounding boxes of all that is rendered."""
    corners = [
        instance.matrix_world @ Vector(corner)
        for instance in bpy.context.evaluated_depsgraph_get().object_instances
        if instance.show_self and instance.object.type not in ("CAMERA", "LIGHT", "EMPTY", "ARMATURE", "LIGHT_PROBE")
        if instance.is_instance or not instance.object.hide_render
        for corner in instance.object.bound_box
    ]
    corners = [corner for corner in corners if all(map(math.isfinite, corner))]
    if not corners:
        raise SceneError("there is nothing in it to be seen")
    return corners


def _sphere(corners: list[Vector]) -> tuple[Vector, float]:
    """Centre and radius of the sphere around the bounding box of the corners."""
    low, high = (Vector(map(end, zip(*corners, strict=True))) for end in (min, max))
    return (low + high) / 2, max((high - low).length / 2, 1e-3)
