# SPDX-License-Identifier: MIT
"""The export: instances, reports, and scenes that are broken in one way or another."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender.export import ExportError, export_scene, meshes, scene
from shlight_blender.report import Effect, ExportCancelled, ExportReport


def export() -> Any:
    """Exports the current scene as the viewport shows it."""
    return export_scene(bpy.context.evaluated_depsgraph_get())


def messages() -> list[str]:
    """Lines of the export's report."""
    return export().report.lines(most=99)


def test_the_export_asks_between_objects_whether_it_goes_on(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """And again before it hands over each mesh."""
    monkeypatch.setattr(scene, "ASKING_SECONDS", 0.0)
    studio.still_life()
    studio.camera()
    asked: list[str] = []
    depsgraph = bpy.context.evaluated_depsgraph_get()
    export_scene(depsgraph, waiting=lambda text: asked.append(text) is None)
    assert len(asked) > len(list(depsgraph.object_instances))
    for last in range(len(asked)):
        answers = iter([True] * last + [False])
        with pytest.raises(ExportCancelled):
            export_scene(depsgraph, waiting=lambda text, answers=answers: next(answers))


# --- meshes


def test_instances_are_one_mesh_and_what_is_hidden_is_none(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the viewport's scene too; a ball, then curves, texts and metaballs, each once."""
    instances: list[int] = []

    place = meshes._place
    monkeypatch.setattr(meshes, "_place", lambda use: instances.append(len(use.transforms)) or place(use))
    studio.lit_floor()
    studio.box().hide_render = True
    ball = studio.ball(0.2)
    for i in range(5):
        studio.link("Copy", ball.data, (i, 0, 1), scale=(1, 1, -1 if i % 2 else 1))
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    curve.splines.new("POLY").points.add(1)
    curve.splines[0].points[1].co = (1, 1, 1, 1)
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "R"
    meta = bpy.data.metaballs.new("Meta")
    meta.elements.new()
    for data in (curve, text, meta):
        studio.link(data.name, data)
    export()
    assert sorted(instances) == [1, 1, 1, 1, 6]


def test_broken_objects_do_no_harm(studio: Any) -> None:
    studio.lit_floor()
    expected = studio.render("SHLIGHT")
    nan = float("nan")
    studio.mesh("Nothing", [], [])
    studio.mesh("Points", [(0, 0, 0), (1, 0, 0)], [])
    studio.mesh("Nowhere", [(nan, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    with_a_face = [(nan, 0, 0), (1, 0, -1), (0, 1, -1), (-1, -1, -1), (2, 2, 1e12)]
    lower = studio.mesh("Below the floor", with_a_face, [(1, 2, 3), (0, 1, 2), (1, 2, 4)])
    lower.data.polygons.foreach_set("use_smooth", [True] * 3)
    studio.box(location=(nan, 0, 0), name="Lost")
    studio.box(scale=(0, 0, 0), location=(0, 0, 1), name="Point")
    studio.box(scale=(0, 0, 1), location=(0, 0, 1), name="Line")
    studio.ball(1e-30, location=(0, 0, 1))
    studio.lamp("POINT", 0.0, (0, 0, 3))
    studio.lamp("AREA", 10.0, (0, 0, 3), scale=(0, 1, 1))
    studio.lamp("POINT", 10.0, (nan, 0, 3))
    text = "\n".join(messages())
    assert "Object 'Nowhere', Object 'Below the floor': some of its vertices are not finite, or" in text
    assert "Object 'Lost': its transform is not finite; left out" in text
    assert "its area is 0" in text
    assert "its power or its transform is not finite" in text
    np.testing.assert_array_equal(studio.render("SHLIGHT"), expected)


def test_object_with_one_axis_of_scale_0(studio: Any) -> None:
    studio.lit_floor()
    studio.plane(1.0, studio.material(Color=(0.8, 0.2, 0.2)), location=(0, 0, 0.6), scale=(1, 1.5, 0))
    studio.compare()


def test_degenerate_faces_and_many_emitters(studio: Any) -> None:
    studio.plane()
    studio.camera()
    glow = studio.material("ShaderNodeEmission", Strength=3.0)
    vertices = [(0, 0, 1), (1, 0, 1), (0, 1, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]
    made = studio.mesh("Sliver", vertices, [(0, 1, 2), (3, 4, 5), (0, 3, 1)], glow)
    made.data.polygons.foreach_set("use_smooth", [True] * 3)
    assert messages() == []
    assert np.isfinite(studio.render("SHLIGHT")).all()
    box = studio.box((0.1, 0.1, 0.1), glow, name="Cube")
    for index in range(29):
        studio.link("Copy", box.data, (0.2 * index, 0, 2))
    assert messages() == []
    assert np.isfinite(studio.render("SHLIGHT")).all()


# --- lamps


def test_a_spread_below_a_tenth_of_a_degree_is_drawn_as_that(studio: Any) -> None:
    studio.lit_floor()
    lamp = studio.scene.objects["Area"].data
    lamp.spread = math.radians(0.11)
    assert messages() == []
    lamp.spread = math.radians(0.09)
    (line,) = messages()
    assert "Light 'Area': a spread below 0.1° is drawn as that" in line
    expected = studio.render("SHLIGHT")
    lamp.spread = 0.0
    np.testing.assert_array_equal(studio.render("SHLIGHT"), expected)
    assert expected[..., :3].any()


def test_lamps_that_are_not_supported_are_named(studio: Any) -> None:
    studio.lit_floor()
    studio.lamp("AREA", 30, (0, 0, 3), size=0.0).name = "Line"
    studio.lamp("SPOT", 30, (0, 0, 3), scale=(1, 0, 1)).name = "Torch"
    studio.lamp("SUN", 3, (0, 0, 3), scale=(0, 0, 0)).name = "Sol"
    studio.lamp("POINT", -5, (0, 0, 3), shadow_soft_size=0.1).name = "Dark"
    text = "\n".join(messages())
    for part in (
        "Light 'Line': its area is 0",
        "Light 'Torch', Light 'Sol': its scale is 0",
        "Light 'Dark': negative light",
    ):
        assert part in text


@pytest.mark.parametrize("use_nodes", [True, False])
def test_nodes_of_a_lamp(studio: Any, use_nodes: bool) -> None:
    """Materials and worlds of Blender 5.0 ignore the switch, lamps do later."""
    studio.plane(material=studio.material())
    lamp = studio.area(80, (0.5, -1, 2)).data
    lamp.use_nodes = True
    emission = next(node for node in lamp.node_tree.nodes if node.type == "EMISSION")
    emission.inputs["Color"].default_value = (1.0, 0.5, 0.2, 1)
    falloff = lamp.node_tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 1.7
    lamp.node_tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
    lamp.use_nodes = use_nodes
    studio.camera()
    studio.compare()
    assert messages() == []
    if use_nodes:
        occlusion = lamp.node_tree.nodes.new("ShaderNodeAmbientOcclusion")
        lamp.node_tree.links.new(occlusion.outputs[0], emission.inputs["Color"])
        lamp.node_tree.links.new(falloff.outputs["Linear"], emission.inputs["Strength"])
        for name in ("Ambient Occlusion", "Light Falloff"):
            assert [line for line in messages() if f"Light 'Area', node '{name}'" in line]


# --- reports


@pytest.mark.skipif(not hasattr(bpy.data, "colorspace"), reason="this Blender's colours are always Rec. 709")
def test_another_working_space_is_named(studio: Any) -> None:
    studio.lit_floor()
    before = bpy.data.colorspace.working_space
    bpy.ops.wm.set_working_color_space(working_space="Linear Rec.2020", convert_colors=False)
    (line,) = studio.messages()
    bpy.ops.wm.set_working_color_space(working_space=before, convert_colors=False)
    assert "working space Linear Rec.2020 is not supported" in line
    assert studio.messages() == []


def test_scene_settings_and_objects_that_are_not_supported_are_named(studio: Any) -> None:
    studio.lit_floor()
    scene = studio.scene
    scene.render.use_motion_blur, scene.cycles.rolling_shutter_type = True, "TOP"
    view_layer = bpy.context.view_layer
    view_layer.use_pass_vector = True
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = False
    scene.world.color = (0.1, 0.1, 0.1)
    scene.world.cycles_visibility.diffuse = False
    studio.link("Smoke", bpy.data.volumes.new("Smoke"))
    text = "\n".join(messages())
    for part in (
        "a rolling shutter is not supported",
        "passes that are not supported: vector",
        "World 'Sky': hiding it from diffuse rays",
        "Object 'Smoke': volumes are not supported; left out",
    ):
        assert part in text, text


def test_equal_findings_are_one_message() -> None:
    report = ExportReport()
    for place in ("a", "b", "a", "c", "d", "e"):
        report.add(place, "odd")
    report.add("a", "even")
    assert report.lines() == ["a, b, c, d and 1 more: odd", "a: even"]
    assert report.to_data()[0] == {"text": "odd", "places": ["a", "b", "c", "d", "e"]}
    assert len(report) == 2
    report.add("b", "even", Effect.LIGHT)
    report.add("a", "dull", Effect.SLIGHT)
    assert report.lines(1) == ["a and 1 more: even", "a and 4 more: odd", "a: dull"]


CANNOT_BE_RENDERED = {
    "camera": "no camera",
    "flat camera": "scale 0",
}


@pytest.mark.parametrize("missing", CANNOT_BE_RENDERED)
def test_scenes_that_cannot_be_rendered(studio: Any, missing: str) -> None:
    studio.plane()
    studio.area()
    if missing != "camera":
        camera = studio.camera()
        if missing == "flat camera":
            camera.scale = (1, 0, 1)
    with pytest.raises(ExportError, match=CANNOT_BE_RENDERED[missing]):
        export()


def test_what_is_left_out_of_a_dark_scene_is_named_first(studio: Any) -> None:
    studio.plane(material=studio.material("ShaderNodeBsdfHair"))
    studio.camera()
    assert export().dark == messages()[0]
    assert messages()[0] == "Scene 'Scene': it has no light that shlight can render; the picture is black"
    studio.lamp("SUN", 3, (0, 0, 3), scale=(0, 0, 0))
    assert messages()[0].endswith("the picture is black. Light 'Sun': its scale is 0; left out")
    assert not studio.render("SHLIGHT")[..., :3].any()
    studio.area()
    assert export().dark == ""
    assert messages()[0] == "Light 'Sun': its scale is 0; left out"
