# SPDX-License-Identifier: MIT
"""Renders that keep what has not changed since the last one."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import bpy
import numpy as np
import pytest
from numpy.typing import NDArray

from shlight.images import read_exr
from shlight_blender.export import Changes, changes_of, meshes


def changed_pictures(studio: Any) -> Iterator[tuple[int, NDArray[np.float32]]]:
    """The studio's simple scene after one change and another."""
    studio.simple_scene()
    scene, box, lamp = studio.scene, bpy.data.objects["Box"], bpy.data.objects["Area"]
    striped = studio.material("ShaderNodeEmission")
    nodes = striped.node_tree.nodes
    coordinates = nodes.new("ShaderNodeTexCoord").outputs
    input_ = nodes["Emission"].inputs["Color"]
    input_.default_value = (0.1, 0.2, 0.4, 1)
    changes: list[tuple[int, Callable[[], object]]] = [  # and how many meshes have to be converted for each
        (4, lambda: None),
        (0, lambda: setattr(scene.camera, "location", (4, -5, 3))),
        (0, lambda: setattr(lamp, "location", (0, -2, 3))),
        (0, lambda: setattr(lamp.data, "energy", 2 * lamp.data.energy)),
        (0, lambda: setattr(box, "location", (0.7, 0, 0.5))),
        (1, lambda: setattr(box, "scale", (1, 1, 0))),
        (1, lambda: setattr(box, "scale", (1, 1, 1))),
        (1, lambda: setattr(box.material_slots[0], "material", striped)),
        (0, lambda: setattr(input_, "default_value", (0.4, 0.2, 0.1, 1))),
        (1, lambda: striped.node_tree.links.new(coordinates["Generated"], input_)),
        (1, lambda: setattr(box, "rotation_euler", (0, 0, 0.5))),
        (1, lambda: striped.node_tree.links.new(coordinates["Camera"], input_)),
        (1, lambda: setattr(scene.camera, "location", (4, -4, 3))),
        (0, lambda: studio.plain_world((0.1, 0.2, 0.3))),
        (0, lambda: studio.plain_world((0.3, 0.2, 0.1))),
        (0, lambda: setattr(box, "hide_render", True)),
        (1, lambda: setattr(box, "hide_render", False)),
        (1, lambda: setattr(box.data.vertices[0], "co", (-2, -1, 0))),
        (1, lambda: box.modifiers.new("Array", "ARRAY")),
        (0, lambda: bpy.data.objects.remove(box)),
    ]
    for number, (conversions, change) in enumerate(changes):
        change()
        scene.render.filepath = str(studio.folder / f"{number}.exr")
        bpy.ops.render.render(write_still=True)
        yield conversions, read_exr(scene.render.filepath)


def test_persistent_data_keeps_what_did_not_change(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures are as without it, bit for bit, and only the meshes are converted again whose triangles are others."""
    converted: list[str] = []
    arrays = meshes.object_arrays

    def counted(seen: Any, *given: Any, **named: Any) -> Any:
        converted.append(seen.name)
        return arrays(seen, *given, **named)

    monkeypatch.setattr(meshes, "object_arrays", counted)
    pictures: dict[bool, list[Any]] = {False: [], True: []}
    for keeps in pictures:
        fresh = type(studio)(studio.folder)
        fresh.scene.render.use_persistent_data = keeps
        for conversions, picture in changed_pictures(fresh):
            pictures[keeps].append(picture)
            assert not keeps or len(converted) == conversions
            converted.clear()
    for kept, anew in zip(pictures[True], pictures[False], strict=True):
        np.testing.assert_array_equal(kept, anew)
    same = [np.array_equal(a, b) for a, b in itertools.pairwise(pictures[True])]
    assert not any(same)


def test_only_what_changes_a_shape_counts_as_its_change(studio: Any) -> None:
    """Pictures seldom show that a change is missed: a shape made anew has another address in most cases."""
    studio.simple_scene()
    box, found = bpy.data.objects["Box"], Changes()

    def note(_: Any, depsgraph: Any) -> None:
        found.add(changes_of(depsgraph))

    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        box.location = (0.7, 0, 0.5)
        bpy.context.view_layer.update()
        assert (found.objects, found.shapes) == (True, set())
        box.data.vertices[0].co = (-2, -1, 0)
        bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    assert found.shapes == {"Box"}
