# SPDX-License-Identifier: MIT
"""Materials with the file of a measured BRDF: where it is found, what is drawn of it, and what is said."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

from shlight import Bsdf
from shlight_blender import record
from shlight_blender.export import materials
from shlight_blender.farm import source

ALBEDO = np.array([0.6, 0.3, 0.1])


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of UTIA's database: white paper, twice as bright seen from above as at a grazing angle."""
    path = tmp_path_factory.mktemp("measured") / "paper.bin"
    theta_out = np.radians(15.0 * np.arange(6))[:, None]
    shape = (3, 6, 48, 6, 48)  # colour, to the light, to the viewer
    values = np.broadcast_to(ALBEDO[:, None, None, None, None] * (0.5 + 0.5 * np.cos(theta_out)) / math.pi, shape)
    values.astype("<f8").tofile(path)
    return path


@pytest.fixture
def paper(studio: Any, measured: Path) -> Any:
    """A sheet seen from above, in even light from all around."""
    studio.plane(8, studio.material(name="Paper", Color=(0.9, 0.9, 0.9)))
    studio.camera()
    studio.scene.camera.location, studio.scene.camera.rotation_euler = (0, 0, 4), (0, 0, 0)
    studio.resolution(16, 12)
    studio.plain_world((1.0, 1.0, 1.0))
    bpy.data.materials["Paper"].use_nodes = True
    return studio


def middle(studio: Any) -> Any:
    """The colour in the middle of the picture."""
    image = studio.render("SHLIGHT")
    return image[image.shape[0] // 2, image.shape[1] // 2, :3]


def said() -> str:
    return "\n".join(record.last.report.lines())


def test_a_picture_at_the_base_color_tints_it(paper: Any, measured: Path) -> None:
    """What is seen is, pixel by pixel, the untinted picture times the colour there."""
    material = bpy.data.materials["Paper"]
    tree, settings = material.node_tree, material.shlight
    surface = surface_of(tree).links[0].from_node
    checks = np.array([[[0.9, 0.2, 0.5], [0.3, 0.6, 0.1]]])
    texture, place = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "TexCoord"))
    texture.image, texture.interpolation, texture.extension = paper.picture(checks), "Closest", "EXTEND"
    tree.links.new(place.outputs["Window"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], surface.inputs["Color"])
    settings.measured_file = str(measured)
    plain = paper.render("SHLIGHT")[..., :3]
    settings.tints_measured = True
    colors = np.repeat(checks, plain.shape[1] // 2, axis=1)
    np.testing.assert_allclose(paper.render("SHLIGHT")[..., :3], plain * colors, rtol=1e-3)
    assert "as its measured file 'paper.bin' has it, times its base colour" in said()
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTranslucent").outputs[0], surface_of(tree))
    np.testing.assert_array_equal(paper.render("SHLIGHT")[..., :3], plain)
    assert "its surface is no Principled or Diffuse BSDF; its measured file is not tinted" in said()


def surface_of(tree: Any) -> Any:
    return tree.get_output_node("CYCLES").inputs["Surface"]


def test_a_file_that_cannot_be_read_is_named_and_the_nodes_are_drawn(paper: Any, measured: Path) -> None:
    by_nodes = middle(paper)
    settings = bpy.data.materials["Paper"].shlight
    settings.measured_file = str(measured.with_name("gone.bin"))
    np.testing.assert_array_equal(middle(paper), by_nodes)
    assert f"Material 'Paper': its measured file '{measured.with_name('gone.bin')}' is missing" in said()
    (measured.parent / "short.bin").write_bytes(b"nothing")
    settings.measured_file = str(measured.parent / "short.bin")
    np.testing.assert_array_equal(middle(paper), by_nodes)
    assert "its measured file cannot be read" in said()
    settings.measured_file = str(measured.parent)
    np.testing.assert_array_equal(middle(paper), by_nodes)
    assert "its measured file cannot be read" in said()


def test_what_is_left_out_of_the_nodes_is_named(paper: Any, measured: Path) -> None:
    material = bpy.data.materials["Paper"]
    tree = material.node_tree
    glow = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(glow.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    material.shlight.measured_file = str(measured)
    assert any("emission, transparency and AOVs of its nodes are left out" in line for line in paper.messages())


def test_paths_are_relative_to_the_file_and_to_that_of_a_library(
    paper: Any, measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(materials, "_measured", lambda *_: Bsdf.lambert(0.5))  # a file at another path takes long
    (tmp_path / "brdf").mkdir()
    (tmp_path / "brdf" / "paper.bin").hardlink_to(measured)
    bpy.data.materials["Paper"].shlight.measured_file = "//brdf/paper.bin"
    library = tmp_path / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    assert any("'paper.bin' has it" in line for line in paper.messages())
    (tmp_path / "elsewhere").mkdir()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.scenes = ["Scene"]
    bpy.context.window.scene = wanted.scenes[0]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "elsewhere" / "shot.blend"))
    paper.scene = bpy.context.scene
    assert any("'paper.bin' has it" in line for line in paper.messages())


def test_files_of_a_farm_are_sent_and_found(paper: Any, measured: Path, tmp_path: Path) -> None:
    bpy.data.materials["Paper"].shlight.measured_file = str(measured)
    scene = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    found, missing = source.of_open_scene(scene)
    assert str(measured) in found
    assert missing == []
    there = tmp_path / "received" / str(measured).lstrip("/")
    there.parent.mkdir(parents=True)
    there.hardlink_to(measured)
    source.move_absolute_paths(tmp_path / "received")
    assert bpy.data.materials["Paper"].shlight.measured_file == str(there)
    there.unlink()
    assert source.of_open_scene(scene)[1] == [str(there)]


def test_it_is_drawn_in_the_place_of_the_nodes_and_named_and_they_afterwards(paper: Any, measured: Path) -> None:
    """Persistent Data keeps the scene from render to render."""
    paper.scene.render.use_persistent_data = True
    by_nodes = middle(paper)
    settings = bpy.data.materials["Paper"].shlight
    settings.measured_file = str(measured)
    np.testing.assert_allclose(middle(paper), ALBEDO, rtol=0.02)
    assert "Material 'Paper': it reflects as its measured file 'paper.bin' has it" in said()
    settings.measured_file = ""
    np.testing.assert_array_equal(middle(paper), by_nodes)


@pytest.mark.slow
def test_a_comparison_draws_the_same_picture(paper: Any, measured: Path) -> None:
    from shlight_blender.compare import results

    bpy.data.materials["Paper"].shlight.measured_file = "//paper.bin"
    bpy.ops.wm.save_as_mainfile(filepath=str(measured.with_name("scene.blend")))
    image = paper.render("SHLIGHT")
    assert bpy.ops.shlight.compare() == {"FINISHED"}
    np.testing.assert_array_equal(results.last.shlight[::-1], image)
    bpy.ops.shlight.remove_comparison()


def test_the_panel_says_where_the_file_is_missing(paper: Any, measured: Path) -> None:
    from shlight_blender.ui.data import measured as panel

    material, lines = bpy.data.materials["Paper"], []
    layout = SimpleNamespace(prop=lambda owner, name: getattr(owner, name), label=lambda text, **_: lines.append(text))
    context = SimpleNamespace(engine="SHLIGHT", material=material)
    assert panel.poll(context)
    for path, count in (("", 0), (str(measured), 0), (str(measured.with_name("gone.bin")), 1)):
        material.shlight.measured_file = path
        lines.clear()
        panel.draw(SimpleNamespace(layout=layout), context)
        assert len(lines) == count
    assert not panel.poll(SimpleNamespace(engine="SHLIGHT", material=None))
