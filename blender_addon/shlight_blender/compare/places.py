# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees at a pixel, and what the report says of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import bpy
from mathutils import Matrix, Vector

from ..export.camera import matrix_of_camera
from ..frame import frame_of
from ..names import name_of
from ..report import ExportReport, thing

# Places of the report whose light may fall on everything.
OF_LIGHT = ("Light '", "World '")
MOST_LAYERS = 32  # surfaces that the camera does not see, one behind the other


@dataclass(frozen=True)
class Seen:
    """An object, a lamp or the world: its place as the report names it, and names of its materials there."""

    place: str
    materials: tuple[str, ...] = ()

    def to_data(self, report: ExportReport) -> dict[str, Any]:
        """It, and messages of the report about it (`messages`) and about light from elsewhere (`of_light`)."""
        own = {self.place, *(f"Material '{name}'" for name in self.materials)}
        about_it = [message for message in report if own & set(map(thing, message.places))]
        of_light = [
            message
            for message in report
            if message not in about_it and any(place.startswith(OF_LIGHT) for place in message.places)
        ]
        return {
            "place": self.place,
            "materials": list(self.materials),
            "messages": [message.text for message in about_it],
            "of_light": [message.line() for message in of_light],
        }


def show_what_is_rendered(view_layer: Any) -> None:
    """Has the dependency graph of the viewport, in which rays are cast, show what final renders show."""
    for each in (*bpy.data.objects, *bpy.data.collections):
        each.hide_viewport = each.hide_render
    _show_collections(view_layer.layer_collection)
    for each in view_layer.objects:
        each.hide_set(False, view_layer=view_layer)
        for modifier in each.modifiers:
            modifier.show_viewport = modifier.show_render
    view_layer.update()


def _show_collections(layer_collection: Any) -> None:
    layer_collection.hide_viewport = False
    for child in layer_collection.children:
        _show_collections(child)


class Finder:
    """Casts rays through the pixels of a scene's frame, and through the middle of the camera's lens."""

    def __init__(self, scene: Any, view_layer: Any) -> None:
        self._scene = scene
        self._depsgraph = bpy.context.evaluated_depsgraph_get()
        self._frame = frame_of(scene.render)
        camera = scene.camera.evaluated_get(self._depsgraph)
        projection = matrix_of_camera(camera, self._depsgraph, self._frame, scene.render)
        location, rotation, _ = camera.matrix_world.decompose()
        # Objects at a pixel of a panorama are not looked up; the report may name the camera.
        self._panorama = Seen(f"Camera '{name_of(camera)}'") if camera.data.type == "PANO" else None
        self._from_picture = Matrix.LocRotScale(location, rotation, None) @ projection.inverted()
        self._lamps = [seen for seen in view_layer.objects if seen.type == "LIGHT" and not seen.hide_render]

    def seen_at(self, x: float, y: float) -> Seen:
        """What is seen there [pixels from the lower left corner of what is rendered]."""
        if self._panorama:
            return self._panorama
        picture_x = 2 * (self._frame.left + x) / self._frame.full_width - 1
        picture_y = 2 * (self._frame.bottom + y) / self._frame.full_height - 1
        start, end = (self._point(picture_x, picture_y, z) for z in (-1.0, 1.0))
        seen, distance = self._surface(start, end)
        for lamp in self._lamps:
            if lamp.visible_camera and (nearer := _distance_to_lamp(lamp, start, end)) < distance:
                seen, distance = Seen(f"Light '{name_of(lamp)}'"), nearer
        return seen

    def _point(self, *of_picture: float) -> Any:
        """The point of the world that is projected to this one, -1 … 1 over the picture and from near to far."""
        point = self._from_picture @ Vector((*of_picture, 1.0))
        return point.xyz / point.w

    def _surface(self, start: Any, end: Any) -> tuple[Seen, float]:
        """The first surface from `start` towards `end` that the camera sees, and its distance."""
        direction = (end - start).normalized()
        origin = start
        for _ in range(MOST_LAYERS):
            hit, location, _, face, shown, _ = self._scene.ray_cast(
                self._depsgraph, origin, direction, distance=(end - origin).length
            )
            if not hit:
                break
            distance = (location - start).length
            if shown.original.visible_camera:
                return Seen(f"Object '{name_of(shown.original)}'", self._materials(shown, face)), distance
            origin = location + direction * 1e-4 * max(distance, 1e-3)
        world = self._scene.world
        return Seen(f"World '{name_of(world)}'" if world else "Background"), math.inf

    def _materials(self, shown: Any, face: int) -> tuple[str, ...]:
        """The material of a face; all of the object's where it is no mesh."""
        names = [name_of(slot.material) if slot.material else "" for slot in shown.original.material_slots]
        faces = getattr(shown.evaluated_get(self._depsgraph).data, "polygons", ())
        if 0 <= face < len(faces) and faces[face].material_index < len(names):
            names = [names[faces[face].material_index]]
        return tuple(name for name in names if name)


def _distance_to_lamp(lamp: Any, start: Any, end: Any) -> float:
    """How far along the ray the lamp's surface is met; infinite where it is missed, or has none."""
    to_lamp = lamp.matrix_world.inverted_safe()
    origin, direction = to_lamp @ start, to_lamp @ end - to_lamp @ start
    data = lamp.data
    share = math.inf  # of the ray
    if data.type == "AREA" and direction.z > 0:  # it shines to its -Z
        at = origin - direction * (origin.z / direction.z)
        x, y = 2 * at.x / data.size, 2 * at.y / (data.size if data.shape in {"SQUARE", "DISK"} else data.size_y)
        if (math.hypot(x, y) if data.shape in {"DISK", "ELLIPSE"} else max(abs(x), abs(y))) <= 1:
            share = -origin.z / direction.z
    elif data.type in {"POINT", "SPOT"} and data.shadow_soft_size > 0:
        middle = -origin.dot(direction) / direction.length_squared
        if (origin + middle * direction).length <= data.shadow_soft_size:
            share = middle
    return share * (end - start).length if share > 0 else math.inf
