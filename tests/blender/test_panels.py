# SPDX-License-Identifier: MIT
"""What the engine's panels show, set and lead to."""

from __future__ import annotations

import math
import sys
from types import SimpleNamespace
from typing import Any

import bpy
import pytest

from shlight_blender import compat, preferences
from shlight_blender.ui import data, report, settings


class Layout:
    """Notes what a panel draws; as Blender's, it raises for properties that their owner does not have."""

    def __init__(self) -> None:
        self.shown: set[str] = set()
        self.text = ""
        self.places: list[str] = []
        self.active = True

    def operator(self, name: str, text: str, **_: Any) -> Any:
        self.places.append(text)
        return SimpleNamespace()

    def prop(self, owner: Any, name: str, **_: Any) -> None:
        getattr(owner, name)
        self.shown.add(name)

    def template_node_view(self, tree: Any, node: Any, socket: Any) -> None:
        self.shown.add(f"{node.bl_idname}.{socket.name}")

    def label(self, text: str, **_: Any) -> None:
        self.text += " " + text

    def column(self, **_: Any) -> Layout:
        return self

    row = box = column


def drawn_by(panel: Any, **context: Any) -> Layout:
    """The layout that `panel` draws in a context of shlight; empty if it is not shown."""
    around = {"preferences": bpy.context.preferences, "region": SimpleNamespace(width=500)}
    layout, shown_in = Layout(), SimpleNamespace(engine="SHLIGHT", **around | context)
    if panel.poll(shown_in):
        panel.draw(SimpleNamespace(layout=layout), shown_in)
    return layout


@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        ("POINT", {"shadow_soft_size"}),
        ("SPOT", {"shadow_soft_size", "spot_size", "spot_blend"}),
        ("SUN", {"angle"}),
        ("AREA", {"shape", "size", "spread"}),
    ],
)
def test_the_panels_of_a_lamp_show_what_makes_its_light(studio: Any, kind: str, shape: set[str]) -> None:
    light = bpy.data.lights.new(kind, kind)
    switch = compat.shadow_switch(light)
    assert switch is not None
    assert shape | {"type", "color", "energy", switch[1]} <= drawn_by(data.lamp, light=light).shown
    light.use_nodes = True
    assert "ShaderNodeOutputLight.Surface" in drawn_by(data.lamp_nodes, light=light).shown


def test_ray_visibility_is_shown(studio: Any) -> None:
    studio.camera()
    kinds = {"visible_camera", "visible_diffuse", "visible_glossy"}
    shown = {
        thing.name: drawn_by(data.ray_visibility, object=thing)
        for thing in (studio.area(), studio.box(), studio.scene.camera)
    }
    assert shown["Area"].shown == kinds
    assert shown["Box"].shown == kinds | {
        "visible_transmission",
        "visible_shadow",
        "is_shadow_catcher",
        "is_holdout",
        "use_camera_cull",
        "use_distance_cull",
    }
    assert shown["Camera"].shown == set()


def test_presets_set_what_they_say_and_standard_is_the_default(studio: Any) -> None:
    chosen, values = studio.scene.shlight, {}
    for name in ("default", "Standard", "Draft", "High"):
        if name != "default":
            chosen.shadow_rays, chosen.pixel_samples, chosen.time_limit = 5, 2, 3.0
            file = str(settings.PRESETS / f"{name}.py")
            bpy.ops.script.execute_preset(filepath=file, menu_idname="SHLIGHT_PT_presets")
            assert chosen.time_limit == 3.0
        values[name] = {each: getattr(chosen, each) for each in settings.PRESET_SETTINGS}
    assert values["Standard"] == values["default"]
    assert values["Draft"]["noise_threshold"] == pytest.approx(0.05)
    assert values["High"]["noise_threshold"] == pytest.approx(0.002)


def test_presets_of_the_user_stand_beside_those_of_the_add_on(studio: Any) -> None:
    listed: list[str] = []
    panel = settings.SHLIGHT_PT_presets
    menu = SimpleNamespace(layout=SimpleNamespace(), preset_subdir=panel.preset_subdir, bl_idname=panel.__name__)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bpy.types.Menu, "path_menu", lambda self, paths, operator, **_: listed.extend(paths))
        panel.path_menu(menu, ["/of/the/user"], panel.preset_operator)
    assert listed == [str(settings.PRESETS), "/of/the/user"]
    assert {path.stem for path in settings.PRESETS.glob("*.py")} == {"Draft", "Standard", "High"}


def test_the_report_leads_to_its_places(studio: Any) -> None:
    studio.simple_scene()
    box = bpy.data.objects["Box"]
    box.data.materials.clear()
    for name in ("Plain", "Odd's"):
        box.data.materials.append(studio.material(name=name))
    tree = box.data.materials[1].node_tree
    sheen = tree.nodes.new("ShaderNodeBsdfHair")
    sheen.label = "Fluff, 'soft'"
    tree.links.new(sheen.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    box.data.vertices[0].co.x = math.nan
    context = {"scene": studio.scene, "region": SimpleNamespace(width=300)}
    context["preferences"] = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))  # a Blender without a window has 0
    assert "Render to see" in drawn_by(report.report, **context).text
    studio.render("SHLIGHT")
    shown = drawn_by(report.report, **context)
    assert "vertices are not finite" in " ".join(shown.text.split()).lower()
    node = next(place for place in shown.places if "node" in place)
    assert node == "Material 'Odd's', node 'Fluff, 'soft''"
    for place in shown.places:
        bpy.context.view_layer.objects.active = None
        assert bpy.ops.shlight.show_place(place=place) == {"FINISHED"}
        assert bpy.context.view_layer.objects.active == box
    bpy.ops.shlight.show_place(place=node)
    assert box.active_material.name == "Odd's"
    assert tree.nodes.active == sheen
    with pytest.raises(RuntimeError, match="'Gone' is not in this view layer"):
        bpy.ops.shlight.show_place(place="Object 'Gone'")
    studio.scene.name = "Another"
    assert "Render to see" in drawn_by(report.report, **context).text


def test_what_is_shown_of_direct_light_is_said(studio: Any) -> None:
    """The report begins with few bounces, metal is named, and the tick is of these depths."""
    studio.simple_scene()
    context = {"scene": studio.scene, "region": SimpleNamespace(width=2000)}
    context["preferences"] = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    expected = {
        0: " Direct light only: Max Bounces is 0 As Cycles draws direct light",
        1: " This file lets light bounce 3 times in Cycles As Cycles draws it with 1 bounce",
        3: " As Cycles draws it with 3 bounces",
    }
    studio.scene.cycles.max_bounces = 3
    for bounces, text in expected.items():
        studio.scene.shlight.max_bounces = bounces
        studio.render("SHLIGHT")
        assert drawn_by(report.report, **context).text == text
        assert ("Direct light only" in drawn_by(settings.sampling, **context).text) == (bounces == 0)
        assert ("in Cycles" in drawn_by(settings.light, **context).text) == (bounces == 1)
    bpy.data.objects["Box"].data.materials[0] = studio.material("ShaderNodeBsdfGlossy", name="Chrome", Roughness=0.0)
    studio.render("SHLIGHT")
    assert "As Cycles draws it" in drawn_by(report.report, **context).text
    studio.scene.shlight.max_bounces = 0
    studio.render("SHLIGHT")
    shown = drawn_by(report.report, **context).text
    assert "Direct light only" in shown
    assert "It reflects lamps and the world, and no surface, while Max Bounces is 0" in shown
    assert "As Cycles" not in shown


def test_world_width_is_a_setting_of_the_world(studio: Any) -> None:
    studio.world()
    context = {"scene": studio.scene, "world": studio.scene.world}
    assert drawn_by(data.world_picture, **context).shown == {"world_width"}
    assert "world_width" not in drawn_by(settings.light, **context).shown
    assert drawn_by(data.world_picture, scene=studio.scene, world=None).shown == set()


def test_without_the_native_module_the_engine_says_so(
    studio: Any, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def ready() -> str:
        layout = Layout()
        preferences.SHLIGHT_Preferences.draw(SimpleNamespace(layout=layout), None)
        return layout.text

    studio.simple_scene()
    assert "Ready" in ready()
    with monkeypatch.context() as missing:
        missing.setitem(sys.modules, "shlight", None)
        said = ready()
        with pytest.raises(RuntimeError, match=r"'shlight' cannot be loaded .*pip install") as error:
            studio.render("SHLIGHT")
        assert str(error.value).count("\n") <= 1
        assert "'shlight' cannot be loaded" in said
        assert "pip install" in said
    assert "Ready" in ready()
    assert "Traceback" not in capfd.readouterr().err
