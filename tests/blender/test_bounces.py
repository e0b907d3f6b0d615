# SPDX-License-Identifier: MIT
"""Light that bounces against Cycles at the same depths."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest

import shlight
from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of
from shlight_blender.export import Changes, ExportedScene, changes_of, everything, viewport_settings, whole_frame
from shlight_blender.picture_maker import Job, PictureMaker


def compare(studio: Any, samples: int = 1024, **bounds: float) -> Any:
    """Both pictures with bounces as the scene's settings have them."""
    studio.resolution(32, 24)
    use_cycles(studio.scene, samples, 0, bounces_of(studio.scene))
    return studio.compare(**bounds)


@pytest.mark.parametrize(("glossy", "transmission"), [(4, 12), pytest.param(1, 1, marks=pytest.mark.slow), (0, 2)])
def test_depths_of_gloss_and_glass_are_those_of_cycles(studio: Any, glossy: int, transmission: int) -> None:
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(0.9, 1, 0.9), Roughness=0.0, IOR=1.4)
    mirror = studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Color=(0.9, 0.8, 0.7), Roughness=0.2)
    studio.plane(8, white)
    studio.box((1, 1, 1), glass, "Pane", location=(0.8, -1, 0.6))
    for side in (-1, 1):
        studio.box((0.1, 3, 2), mirror, "Mirror", location=(1.7 * side, 0.5, 1))
    studio.plain_world((0.4, 0.5, 0.6))
    studio.camera()
    settings = studio.scene.shlight
    settings.max_bounces, settings.glossy_bounces, settings.transmission_bounces = 4, glossy, transmission
    compare(studio)


def test_highlights_on_a_floor_are_filtered_as_in_cycles(studio: Any) -> None:
    """The sun shines on a mirror, on polished metal and on one whose roughness varies."""
    inputs = {"Base Color": (0.9, 0.7, 0.4), "Metallic": 1.0}
    metals = [
        studio.material("ShaderNodeBsdfPrincipled", "Metal", **inputs, Roughness=each) for each in (0.0, 0.2, 0.2)
    ]
    tree = metals[2].node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], tree.nodes["Principled BSDF"].inputs["Roughness"])
    studio.plane(8, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.6, 0.6, 0.6)))
    for i, metal in enumerate(metals):
        studio.ball(0.6, metal, location=(1.4 * i - 1.4, 0, 0.6))
    studio.lamp("SUN", 3, (0, 0, 5), rotation_euler=(0.6, 0.3, 0), angle=0.009)
    studio.camera(location=(0, -6, 4), target=(0, 0, 0.3))
    studio.scene.shlight.max_bounces, studio.scene.cycles.blur_glossy = 3, 1.0
    compare(studio)


@pytest.mark.parametrize("color", [(0.8, 0.4, 0.9), (0.998, 0.5, 0.544)])
def test_what_bounces_on_bent_normals(studio: Any, color: tuple[float, float, float]) -> None:
    """A floor between two walls that only it sees, with a normal map that leans by 37° and by 85°."""
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    bent = studio.material("ShaderNodeBsdfDiffuse", "Bent", Color=(0.8, 0.8, 0.8))
    map_ = bent.node_tree.nodes.new("ShaderNodeNormalMap")
    map_.inputs["Color"].default_value = (*color, 1)
    shader = next(node for node in bent.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    bent.node_tree.links.new(map_.outputs["Normal"], shader.inputs["Normal"])
    floor = studio.plane(2, bent)
    floor.data.uv_layers.new().data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    for side in (-1, 1):
        wall = studio.plane(2.4, white, location=(1.2 * side, 0, 1), rotation_euler=(0, side * -np.pi / 2, 0))
        wall.visible_camera = False
    studio.area(60, (0, 0, 2.5), size=0.5)
    studio.camera(location=(0, -3, 3), target=(0, 0, 0.2))
    studio.scene.shlight.max_bounces = 2
    compare(studio, mean=1e-2, error=5e-3)


def test_bumps_count_where_light_comes_from(studio: Any) -> None:
    """A floor beside a wall that only it sees, whose steep bumps make it half as bright."""
    bumped = studio.material("ShaderNodeBsdfDiffuse", "Bumped", Color=(0.8, 0.8, 0.8))
    tree = bumped.node_tree
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 9.0, 0.0
    bump.inputs["Distance"].default_value = 2.0
    shader = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    studio.plane(2, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8)))
    wall = studio.plane(4, bumped, location=(1.2, 0, 1), rotation_euler=(0, -np.pi / 2, 0))
    wall.visible_camera = False
    studio.lamp("SUN", 3, (0, 0, 5), rotation_euler=(0, -1.45, 0), angle=0.1)
    studio.camera(location=(0, -3, 3), target=(0, 0, 0.2))
    studio.scene.shlight.max_bounces = 1
    compare(studio, mean=1e-2, error=5e-3)


def test_what_bounces_is_clamped_as_in_cycles(studio: Any) -> None:
    """A bright square is seen in a mirror, whole, and in another mirror there, and through glass: cut."""
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(1, 1, 1), Roughness=0.0, IOR=1.5)
    mirror = studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Color=(0.9, 0.6, 0.3), Roughness=0.0)
    bright = studio.material("ShaderNodeEmission", "Bright", Color=(1, 0.5, 0.2), Strength=60)
    upright = {"rotation_euler": (np.pi / 2, 0, 0)}
    studio.plane(4, mirror, "Before", location=(-2, 1.5, 0), **upright)
    studio.plane(4, mirror, "Behind", location=(-2, -1.5, 0), **upright)
    studio.plane(0.5, bright, "Square", location=(-0.5, -0.5, 0.8), **upright)
    studio.plane(0.5, bright, "Other", location=(0.6, 1, 0), **upright)
    studio.box((2, 0.2, 2), glass, "Pane", location=(1.2, 0.5, 0))
    studio.camera((0, -0.8, 0), (0, 1, 0))
    studio.scene.shlight.max_bounces, studio.scene.cycles.sample_clamp_indirect = 6, 10.0
    studio.scene.shlight.min_samples = 64  # one of 25 rays is reflected inside of the glass
    # Its edges reflect it too, which Cycles cuts more.
    own, cycles = compare(studio, mean=5e-3, error=2e-2)
    for inside in (np.s_[10:14, 28:30, :3], np.s_[2:5, 9:13, :3]):
        np.testing.assert_allclose(own[inside], cycles[inside], rtol=2e-2)
    assert 9 < cycles[12, 28, :3].mean() < 10 < cycles[3, 10, :3].mean()


def test_lamps_shine_through_clear_glass_as_cycles_filters_it(studio: Any) -> None:
    """A ball behind clear glass, which lamps reach by bounced light alone, with Filter Glossy and Clamp Indirect as
    files have them."""
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(1, 1, 1), Roughness=0.0, IOR=1.45)
    studio.ball(0.5, studio.material(Color=(0.8, 0.8, 0.8)), location=(0, 0, 0))
    studio.box((2, 2, 2), glass, "Around", location=(0, 0, 0))
    studio.lamp("POINT", 500, (2, -3, 3), shadow_soft_size=0.1)
    studio.camera((0, -6, 0), (0, 0, 0))
    cycles = studio.scene.cycles
    studio.scene.shlight.max_bounces, cycles.blur_glossy, cycles.sample_clamp_indirect = 3, 1.0, 10.0
    _, other = compare(studio, mean=0.04, error=0.01)
    assert other[10:14, 14:18, :3].mean() > 0.1


def test_a_wide_lamp_beside_rough_glass(studio: Any) -> None:
    """Rays through the glass meet it seldom, and in the tail of their lobe."""
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(1, 1, 1), Roughness=0.5, IOR=1.45)
    studio.plane(4, glass, "Pane", rotation_euler=(np.pi / 2, 0, 0))
    studio.lamp("POINT", 500, (1.5, 3, 1), shadow_soft_size=0.9)
    studio.camera((0, -6, 0), (0, 0, 0))
    studio.scene.shlight.max_bounces = 1
    compare(studio, mean=5e-3, error=2e-3)


@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX", "BECKMANN"])
def test_frosted_glass_before_a_sun_and_a_point(studio: Any, distribution: str) -> None:
    glass = studio.material(
        "ShaderNodeBsdfGlass", "Glass", Color=(1, 0.9, 0.8), Roughness=0.5, IOR=1.45, distribution=distribution
    )
    studio.plane(8, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.6, 0.6, 0.6)))
    studio.box((3, 0.1, 2), glass, "Pane", location=(0, 0, 1.2))
    studio.lamp("SUN", 2, (0, 0, 5), rotation_euler=(-0.9, 0.3, 0), angle=0.009)
    studio.lamp("POINT", 80, (0.5, 1.5, 1.5), shadow_soft_size=0.0)
    studio.plain_world((0.05, 0.06, 0.08))
    studio.camera((0, -6, 3), (0, 0, 1))
    studio.scene.shlight.max_bounces = 4
    compare(studio, mean=2e-2, error=3e-2)


@pytest.mark.parametrize("bounces", [pytest.param(0, marks=pytest.mark.slow), 2])
def test_translucent_surfaces_take_light_from_behind(studio: Any, bounces: int) -> None:
    """A sheet before a lamp and the sky, a smooth ball around another lamp, and a mix of both sides."""
    paper = studio.material("ShaderNodeBsdfTranslucent", "Paper", Color=(0.9, 0.6, 0.4))
    both = studio.material("ShaderNodeBsdfTranslucent", "Both", Color=(0.3, 0.8, 0.5))
    tree = both.node_tree
    add, white = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    white.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
    output = tree.nodes["Material Output"].inputs["Surface"]
    tree.links.new(output.links[0].from_socket, add.inputs[0])
    tree.links.new(white.outputs[0], add.inputs[1])
    tree.links.new(add.outputs[0], output)
    studio.plane(8, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8)))
    studio.box((0.02, 2, 2), paper, "Sheet", location=(-1, 0.5, 1), rotation_euler=(0, 0, 0.5))
    studio.plane(1.2, both, "Leaf", location=(1.3, -1.3, 0.5), rotation_euler=(0.3, 0.2, 0))
    studio.ball(0.7, paper, location=(0.9, 0.9, 0.9))
    studio.lamp("POINT", 30, (0.9, 0.9, 0.9), shadow_soft_size=0.1)
    studio.area(150, (-3, 2, 2), size=1, rotation_euler=(0.9, 0, -2.2))
    studio.plain_world((0.2, 0.3, 0.4))
    studio.camera()
    studio.scene.shlight.max_bounces = bounces
    compare(studio, mean=5e-3, error=2e-3)
    assert studio.messages(most=99) == []


def test_a_viewport_keeps_light_while_its_view_moves_alone(
    studio: Any, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    studio.plane(8, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8)))
    box = studio.box((1, 1, 1), studio.material("ShaderNodeBsdfDiffuse", "Red", Color=(0.8, 0.1, 0.1)))
    lamp = studio.area(150, (-3, 2, 2), size=1, rotation_euler=(0.9, 0, -2.2))
    studio.plain_world((0.2, 0.3, 0.4))
    studio.camera()
    studio.scene.shlight.preview_max_bounces = 2
    reports: list[shlight.RenderReport] = []
    render = shlight.render

    def watched(*arguments: Any, **options: Any) -> shlight.RenderResult:
        result = render(*arguments, **options)
        reports.append(result.report)
        return result

    monkeypatch.setattr(shlight, "render", watched)
    exported, maker, changes = ExportedScene(), PictureMaker(lambda: None), everything()

    def note(_: Any, depsgraph: Any) -> None:
        changes.add(changes_of(depsgraph))

    def seen_after(change: Callable[[], object]) -> Any:
        """The picture, and that of a viewport made anew."""
        nonlocal changes
        change()
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        exported.look_from(depsgraph, frame=whole_frame(40, 30))
        exported.update(depsgraph, changes)
        changes = Changes()
        job = Job(exported.scene, whole_frame(40, 30), viewport_settings(studio.scene))
        maker._make(job, maker._number)
        other = PictureMaker(lambda: None)
        other._make(job, 0)
        assert not maker.error
        return maker.picture.pixels, other.picture.pixels

    bpy.app.handlers.depsgraph_update_post.append(note)
    request.addfinalizer(lambda: bpy.app.handlers.depsgraph_update_post.remove(note))
    seen_after(lambda: None)
    own, anew = seen_after(lambda: setattr(studio.scene.camera, "location", (3.05, -6, 4)))
    assert reports[-2].records <= 0.5 * reports[-1].records
    assert 0 < np.abs(own - anew).mean() <= 0.02 * anew.mean()
    surface = box.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs
    for change in (
        lambda: setattr(lamp, "location", (-3, 2, 2.5)),
        lambda: setattr(lamp.data, "energy", 100),
        lambda: setattr(box, "location", (0.5, 0, 0)),
        lambda: setattr(surface["Color"], "default_value", (0, 1, 0, 1)),
        lambda: studio.plain_world((0.5, 0.3, 0.2)),
    ):
        np.testing.assert_array_equal(*seen_after(change))
