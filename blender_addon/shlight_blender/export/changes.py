# SPDX-License-Identifier: GPL-3.0-or-later
"""What has changed in a scene since it was exported, as Blender's depsgraph tells."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import bpy

from ..names import name_of


@dataclass
class Changes:
    """The parts of an exported scene that must be made again; cameras are given with every picture instead."""

    world: bool = False
    lamps: bool = False
    objects: bool = False  # which there are, and where
    materials: bool = False
    all_shapes: bool = False
    motion: bool = False  # within the time of one picture
    shapes: set[str] = field(default_factory=set)  # the objects whose triangles are others, by their full names

    def __bool__(self) -> bool:
        return self.world or self.lamps or self.objects or self.materials

    def add(self, other: Changes) -> None:
        """Adds those that came later."""
        for each in fields(self):
            setattr(self, each.name, getattr(self, each.name) | getattr(other, each.name))

    def parts(self) -> str:
        """The changed parts, in users' words."""
        named = {"World": self.world, "Lamps": self.lamps, "Objects": self.objects, "Materials": self.materials}
        return ", ".join(name for name, changed in named.items() if changed)


def everything() -> Changes:
    """All parts, for a scene that has not been exported."""
    return Changes(True, True, True, True, True)


def changes_of(depsgraph: Any) -> Changes:
    """The changes that Blender reports to a render engine that keeps the scene."""
    changes = Changes()
    for update in depsgraph.updates:
        _add(changes, update)
    return changes


def motion_of(depsgraph: Any) -> Changes:
    """The changes that Cycles blurs: those of places and shapes of objects."""
    changes = Changes(objects=True, motion=True)
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Object) and update.is_updated_geometry:
            changes.shapes.add(name_of(update.id, "name_full"))
    return changes


def _add(changes: Changes, update: Any) -> None:
    changed = update.id
    kind = getattr(changed, "type", "")
    if isinstance(changed, (bpy.types.Camera, bpy.types.Action)) or kind == "CAMERA":
        return
    if isinstance(changed, bpy.types.World):
        changes.world = True
    elif isinstance(changed, bpy.types.Light) or kind == "LIGHT":
        changes.lamps = True
    elif isinstance(changed, bpy.types.Material):
        changes.materials = True
    elif isinstance(changed, bpy.types.Object):
        changes.objects = changes.lamps = True
        if update.is_updated_geometry:
            changes.shapes.add(name_of(changed, "name_full"))
    elif isinstance(changed, bpy.types.Scene):
        return  # what its settings mean for the picture is compared
    elif isinstance(changed, (bpy.types.NodeTree, bpy.types.Image, bpy.types.Texture)):
        # The owner of an embedded tree is listed too; groups and images may be used by all.
        if not getattr(changed, "is_embedded_data", False):
            changes.world = changes.lamps = changes.materials = True
    else:  # collections, meshes, particles …
        changes.objects = changes.lamps = True
