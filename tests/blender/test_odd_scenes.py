# SPDX-License-Identifier: MIT
"""Scenes with something missing or far too large: the right picture, or one line that says what is wrong."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

from shlight.images import write_png
from shlight.nodes.textures import texture_pixels
from shlight_blender import frame, record
from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of
from shlight_blender.export.images import KEPT_EXPORTS, TextureCache


def test_a_picture_larger_than_the_memory_is_an_error(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is rendered or saved. In a border that fits the scene is rendered."""
    studio.simple_scene()
    info = studio.folder / "meminfo"
    info.write_text("MemTotal: 9000000 kB\nMemAvailable: 180 kB\nSwapFree: 20 kB\n")
    monkeypatch.setattr(frame, "MEMORY_INFO", info)
    with pytest.raises(RuntimeError, match="a picture of 48 × 36 pixels takes about"):
        studio.render("SHLIGHT")
    assert not (studio.folder / "shlight.exr").exists()
    render = studio.scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_max_x, render.border_max_y = 0.5, 0.5
    assert studio.render("SHLIGHT")[..., :3].any()


def test_a_scene_without_objects_shows_the_world(studio: Any) -> None:
    studio.simple_scene()
    for shown in [each for each in studio.scene.objects if each.type != "CAMERA"]:
        bpy.data.objects.remove(shown)
    studio.world((0.2, 0.4, 0.6))
    studio.compare(mean=1e-5, error=1e-9)


def test_faces_that_lie_on_others_are_named(studio: Any) -> None:
    """Two turned squares in one place, cut by other diagonals, a mesh that has a face twice, and a small square in the
    middle of a large one's side; those that nobody sees (a box on the floor) and a box like another, elsewhere, do not
    count."""
    studio.simple_scene()
    corners, faces = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]), [(0, 1, 2, 3)]
    turned = {"location": (2, 1, 0.7), "rotation_euler": (0.3, 0.2, 0.1)}
    studio.mesh("Square", corners, [(0, 1, 2), (0, 2, 3)], **turned)
    studio.mesh("Square again", corners, [(1, 2, 3), (1, 3, 0)], **turned)
    studio.mesh("Twice", [*corners, *corners], [*faces, (4, 5, 6, 7)], location=(-2, 1, 0.3))
    studio.link("Copy", bpy.data.objects["Box"].data, (0.4, 2.1, 0.3))
    studio.mesh("Small", 0.3 * corners + (-1, -1, 0), faces)
    studio.render("SHLIGHT")
    (message,) = record.last.report
    assert "lie on others" in message.text
    assert sorted(message.places) == [
        f"Object '{name}'" for name in ("Plane", "Small", "Square again", "Square", "Twice")
    ]


@pytest.mark.parametrize(("turn", "bounces"), [(0.0, 0), (0.3, 0), (0.2, 4)])
def test_faces_that_lie_on_others_are_as_dark_as_in_cycles(studio: Any, turn: float, bounces: int) -> None:
    """Squares in one plane to the last bit are black. Turned ones have patches, half of them dark, to which light comes
    by ways to and fro between the two."""
    studio.scene.shlight.max_bounces = bounces
    use_cycles(studio.scene, 1024, 0, bounces_of(studio.scene))
    studio.plane()
    studio.area()
    studio.camera()
    corners = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)])
    for name, offset in (("Large", 0.0), ("Small", 0.5)):
        at = {"location": (-1, -1, 0.5), "rotation_euler": (turn, turn / 2, 0)}
        studio.mesh(name, corners * (1 - offset / 2) + (offset / 2, offset / 2, 0), [(0, 1, 2, 3)], **at)
    mean, error = (1e-3, 1e-3) if turn == 0 else (1e-2, 3e-3) if bounces else (5e-3, 0.02)
    elsewhere = turn > 0 and bpy.app.version >= (5, 2, 0)  # whose Cycles rounds otherwise, so that patches move
    studio.compare(mean=0.03 if elsewhere else mean, error=error)


def test_faces_with_vertices_that_are_not_finite_are_left_out(studio: Any) -> None:
    studio.lit_floor()
    square = [(-1, -1, 0.5), (1, -1, 0.5), (1, 1, 0.5), (-1, 1, 0.5)]
    away = [(math.nan, 0, 1), (0, 0, math.inf), (0, 1e12, 0)]
    studio.mesh("Torn", [*square, *away], [(0, 1, 2, 3), (0, 1, 4), (2, 3, 5), (1, 2, 6)])
    studio.compare(mean=1e-3, error=1e-3)
    assert any("their faces are left out" in message.text for message in record.last.report)


@pytest.mark.parametrize("missing", ["library", "texture"])
def test_what_is_missing_of_a_library(studio: Any, missing: str) -> None:
    """Missing libraries behave as in Cycles: their objects are absent, and their textures magenta."""
    studio.simple_scene()
    folder = studio.folder
    write_png(str(folder / "green.png"), np.full((8, 8, 3), (20, 200, 20), np.uint8))
    material = studio.material()
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(str(folder / "green.png"))
    shader = next(each for each in tree.nodes if each.type == "BSDF_DIFFUSE")
    tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    linked = studio.box(material=material, name="Linked", location=(0, 0, 0.5))
    bpy.data.libraries.write(str(folder / "library.blend"), {linked})
    for made in (linked, material, node.image):
        bpy.data.batch_remove([made])
    with bpy.data.libraries.load(str(folder / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Linked"]
    studio.scene.collection.objects.link(wanted.objects[0])
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "main.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    (folder / {"library": "library.blend", "texture": "green.png"}[missing]).unlink()
    bpy.ops.wm.open_mainfile(filepath=str(folder / "main.blend"))
    studio.scene = bpy.context.scene
    studio.scene.shlight.pixel_samples = 64
    studio.compare()
    assert ["green.png' is missing" in line for line in studio.messages()] == [True] * (missing == "texture")


def test_textures_are_kept_while_exports_ask_for_them() -> None:
    cache = TextureCache()
    cache.get(("dropped",), lambda: texture_pixels(np.ones((4, 4, 3), dtype=np.float32)))
    cache.get(("kept",), lambda: texture_pixels(np.ones((2, 2, 3), dtype=np.float32)))
    both = cache.size_in_bytes
    for _ in range(KEPT_EXPORTS + 1):
        cache.begin_export()
        assert cache.get(("kept",), lambda: None) is not None
    assert 0 < cache.size_in_bytes < both / 2


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="asks the system for the memory of the process")
@pytest.mark.parametrize("persistent", [False, True])
def test_renders_do_not_gather_memory(studio: Any, persistent: bool) -> None:
    """After the first ones, of a scene that changes and so is exported each time, with textures on and around it."""
    studio.simple_scene()
    pixels = np.random.default_rng(1).random((256, 512, 3))
    material = studio.material()
    for tree, kind, socket in (
        (material.node_tree, "ShaderNodeTexImage", next(iter(material.node_tree.nodes)).inputs["Color"]),
        (
            studio.world().id_data,
            "ShaderNodeTexEnvironment",
            studio.scene.world.node_tree.nodes["Background"].inputs[0],
        ),
    ):
        node = tree.nodes.new(kind)
        node.image = studio.picture(pixels)
        tree.links.new(node.outputs["Color"], socket)
    ball = studio.ball(rings=200, material=material)
    studio.scene.render.use_persistent_data = persistent
    memory = []
    for _ in range(16):
        ball.location.x += 0.01
        bpy.ops.render.render()
        memory.append(int(Path("/proc/self/statm").read_text().split()[1]))
    first, last = max(memory[:6]), min(memory[-6:])  # what the allocator keeps goes up and down
    print(f"{last / first - 1:+.2%}")
    assert last <= 1.05 * first
