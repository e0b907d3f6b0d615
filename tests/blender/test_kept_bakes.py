# SPDX-License-Identifier: MIT
"""Baked worlds are kept: the same world is baked once, and any change of what it is made of bakes it again."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender.export import bake


@pytest.fixture
def bakes(monkeypatch: pytest.MonkeyPatch) -> list[bake.Baked]:
    """Nothing is kept, and what is baked from now on is black; returns the list of it."""
    made: list[bake.Baked] = []

    def make(world: Any, scene: Any, waiting: Any) -> bake.Baked:
        made.append(bake.Baked(np.zeros((4, 8, 3), dtype=np.float32)))
        return made[-1]

    monkeypatch.setattr(bake, "_bake", make)
    monkeypatch.setattr(bake, "kept", type(bake.kept)())
    return made


def bake_now(studio: Any) -> bake.Baked | None:
    """The world as a render has it."""
    scene = bpy.context.evaluated_depsgraph_get().scene_eval
    assert scene.world.original == studio.scene.world
    return bake.bake_world(scene.world, scene)


def picture_file(studio: Any, grey: float) -> str:
    """Writes a PNG, always of the same number of bytes."""
    path = studio.folder / "sky.png"
    image = bpy.data.images.new("Written", 4, 2)
    image.pixels.foreach_set(np.full(32, grey, dtype=np.float32))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return str(path)


def set_world(studio: Any) -> Any:
    """Noise through a ramp, a curve and a group, a picture and a lamp's profile; returns the tree."""
    studio.scene.world = world = bpy.data.worlds.new("World")
    world.use_nodes = True
    tree = world.node_tree
    group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    inner = group.nodes.new("ShaderNodeValue")
    group.interface.new_socket("Value", in_out="OUTPUT", socket_type="NodeSocketFloat")
    group.links.new(inner.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    kinds = ("TexNoise", "ValToRGB", "RGBCurve", "TexEnvironment", "TexIES", "MixRGB", "TexSky", "Group")
    nodes = {kind: tree.nodes.new(f"ShaderNode{kind}") for kind in kinds}
    for kind, node in nodes.items():
        node.name = kind
    nodes["Group"].node_tree = group
    nodes["TexEnvironment"].image = bpy.data.images.load(picture_file(studio, 0.25))
    nodes["TexIES"].ies = bpy.data.texts.new("Profile")
    chain = [nodes[kind] for kind in ("TexNoise", "ValToRGB", "RGBCurve")]
    for before, after in pairwise(chain):
        tree.links.new(before.outputs[0], after.inputs["Fac"])
    tree.links.new(nodes["RGBCurve"].outputs[0], nodes["MixRGB"].inputs["Color1"])
    tree.links.new(nodes["TexEnvironment"].outputs[0], nodes["MixRGB"].inputs["Color2"])
    lit = tree.nodes["Background"]
    tree.links.new(nodes["MixRGB"].outputs[0], lit.inputs["Color"])
    tree.links.new(nodes["Group"].outputs[0], lit.inputs["Strength"])
    return tree


def value(tree: Any) -> None:
    tree.nodes["MixRGB"].inputs["Fac"].default_value += 1e-6


def colour(tree: Any) -> None:
    tree.nodes["MixRGB"].inputs["Color1"].default_value[2] = 0.3


def node_property(tree: Any) -> None:
    tree.nodes["TexNoise"].noise_dimensions = "4D"


def operation(tree: Any) -> None:
    tree.nodes["MixRGB"].blend_type = "ADD"


def sun_elevation(tree: Any) -> None:
    tree.nodes["TexSky"].sun_elevation += 1e-3


def ramp_position(tree: Any) -> None:
    tree.nodes["ValToRGB"].color_ramp.elements[0].position = 0.1


def ramp_interpolation(tree: Any) -> None:
    tree.nodes["ValToRGB"].color_ramp.interpolation = "EASE"


def curve_point(tree: Any) -> None:
    tree.nodes["RGBCurve"].mapping.curves[3].points[0].location = (0.0, 0.2)


def mapping_of_a_texture(tree: Any) -> None:
    tree.nodes["TexNoise"].texture_mapping.rotation[2] = 0.2


def value_in_a_group(tree: Any) -> None:
    tree.nodes["Group"].node_tree.nodes["Value"].outputs[0].default_value = 3.0


def muted_node(tree: Any) -> None:
    tree.nodes["RGBCurve"].mute = True


def muted_node_in_a_group(tree: Any) -> None:
    tree.nodes["Group"].node_tree.nodes["Value"].mute = True


def muted_link(tree: Any) -> None:
    tree.links[0].is_muted = True


def removed_link(tree: Any) -> None:
    tree.links.remove(tree.links[0])


def moved_link(tree: Any) -> None:
    tree.links.new(tree.nodes["TexNoise"].outputs[1], tree.nodes["ValToRGB"].inputs["Fac"])


def other_group(tree: Any) -> None:
    tree.nodes["Group"].node_tree = tree.nodes["Group"].node_tree.copy()
    value_in_a_group(tree)


def painted(tree: Any) -> None:
    image = tree.nodes["TexEnvironment"].image
    image.pixels[5] = 0.75
    image.update()


def colour_space(tree: Any) -> None:
    tree.nodes["TexEnvironment"].image.colorspace_settings.name = "Non-Color"


def alpha_mode(tree: Any) -> None:
    tree.nodes["TexEnvironment"].image.alpha_mode = "CHANNEL_PACKED"


def no_image(tree: Any) -> None:
    tree.nodes["TexEnvironment"].image = None


def missing_file(tree: Any) -> None:
    tree.nodes["TexEnvironment"].image.filepath = "/nowhere/sky.png"


def profile(tree: Any) -> None:
    tree.nodes["TexIES"].ies.write("IESNA")


CHANGES = [
    value, colour, node_property, operation, sun_elevation, ramp_position, ramp_interpolation, curve_point,
    mapping_of_a_texture, value_in_a_group, muted_node, muted_node_in_a_group, muted_link, removed_link, moved_link,
    other_group, painted, colour_space, alpha_mode, no_image, missing_file, profile,
]  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_is_baked(studio: Any, bakes: list[bake.Baked], change: Callable[[Any], None]) -> None:
    tree = set_world(studio)
    assert bake_now(studio) is bake_now(studio) is bakes[0]
    change(tree)
    assert bake_now(studio) is bake_now(studio) is bakes[1]
    assert len(bakes) == 2


def test_a_picture_that_is_painted_again(studio: Any, bakes: list[bake.Baked]) -> None:
    """It differs from its file already; at last its shape changes alone."""
    image = set_world(studio).nodes["TexEnvironment"].image
    for grey, size in ((0.5, (4, 2)), (0.6, (4, 2)), (0.6, (2, 4))):
        image.scale(*size)
        image.pixels.foreach_set(np.full(32, grey, dtype=np.float32))
        assert bake_now(studio) is bake_now(studio)
    assert len(bakes) == 3


def test_a_generated_picture(studio: Any, bakes: list[bake.Baked]) -> None:
    set_world(studio).nodes["TexEnvironment"].image = image = bpy.data.images.new("Made", 4, 2)
    for image.generated_type in ("BLANK", "COLOR_GRID"):
        for image.generated_color in ((0.1, 0.2, 0.3, 1.0), (0.1, 0.2, 0.4, 1.0)):
            assert bake_now(studio) is bake_now(studio)
    image.generated_width = 6
    assert bake_now(studio) is bake_now(studio)
    assert len(bakes) == 5


def test_values_that_the_render_alone_has(studio: Any, bakes: list[bake.Baked]) -> None:
    """An animation's values are in the evaluated world, and not always in the user's own."""
    set_world(studio)
    scene = bpy.context.evaluated_depsgraph_get().scene_eval
    bake.bake_world(scene.world, scene)
    scene.world.node_tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.7
    bake.bake_world(scene.world, scene)
    assert len(bakes) == 2


def test_a_file_that_is_written_again(studio: Any, bakes: list[bake.Baked]) -> None:
    set_world(studio)
    path = picture_file(studio, 0.25)
    bake_now(studio)
    size = Path(path).stat().st_size
    assert picture_file(studio, 0.75) == path
    assert Path(path).stat().st_size == size
    bake_now(studio)
    assert len(bakes) == 2


def test_a_packed_picture(studio: Any, bakes: list[bake.Baked]) -> None:
    image = set_world(studio).nodes["TexEnvironment"].image
    for grey in (0.25, 0.5):
        image.pixels.foreach_set(np.full(32, grey, dtype=np.float32))
        image.pack()
        assert not image.is_dirty
        assert bake_now(studio) is bake_now(studio)
    assert len(bakes) == 2


def test_a_profile_in_a_file(studio: Any, bakes: list[bake.Baked]) -> None:
    node = set_world(studio).nodes["TexIES"]
    path = studio.folder / "lamp.ies"
    path.write_text("IESNA 1")
    node.mode, node.filepath = "EXTERNAL", str(path)
    assert bake_now(studio) is bake_now(studio)
    path.write_text("IESNA 2")
    assert bake_now(studio) is bake_now(studio)
    assert len(bakes) == 2


def test_width(studio: Any, bakes: list[bake.Baked]) -> None:
    set_world(studio)
    for width in (512, 1024, 512):
        studio.scene.shlight.world_width = width
        studio.scene.update_tag()
        bake_now(studio)
    assert len(bakes) == 2


@pytest.mark.skipif(not hasattr(bpy.data, "colorspace"), reason="this Blender's colours are always Rec. 709")
def test_space_of_the_colours(studio: Any, bakes: list[bake.Baked]) -> None:
    set_world(studio)
    before = bpy.data.colorspace.working_space
    for space in ("Linear Rec.2020", before):
        assert bake_now(studio) is bake_now(studio)
        bpy.ops.wm.set_working_color_space(working_space=space, convert_colors=False)
    assert bpy.data.colorspace.working_space == before
    bake_now(studio)
    assert len(bakes) == 2


def drive(socket: Any, expression: str = "frame") -> None:
    socket.driver_add("default_value").driver.expression = expression


def keyframe(socket: Any) -> None:
    socket.keyframe_insert("default_value", frame=1)


@pytest.mark.parametrize("in_group", [False, True])
@pytest.mark.parametrize("animate", [drive, partial(drive, expression="1"), keyframe])
def test_frames_of_an_animated_world(
    studio: Any, bakes: list[bake.Baked], animate: Callable[[Any], None], in_group: bool
) -> None:
    """Whatever the animation's values are: the other Blender computes them anew."""
    tree = set_world(studio)
    group = tree.nodes["Group"].node_tree.nodes["Value"].outputs[0]
    animate(group if in_group else tree.nodes["MixRGB"].inputs["Fac"])
    for frame, subframe in ((1, 0.0), (2, 0.0), (2, 0.5), (1, 0.0)):
        studio.scene.frame_set(frame, subframe=subframe)
        bake_now(studio)
    assert len(bakes) == 3


def test_a_driver_on_an_object(studio: Any, bakes: list[bake.Baked]) -> None:
    fac = set_world(studio).nodes["MixRGB"].inputs["Fac"]
    moved = studio.plane()
    driver = fac.driver_add("default_value").driver
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = moved, "location.x"
    driver.expression = variable.name
    bake_now(studio)
    moved.location.x = 0.5
    assert bake_now(studio) is bake_now(studio)
    assert len(bakes) == 2


def test_frames_of_a_world_at_rest(studio: Any, bakes: list[bake.Baked]) -> None:
    set_world(studio)
    for frame in (1, 2):
        studio.scene.frame_set(frame)
        bake_now(studio)
    assert len(bakes) == 1


def test_what_does_not_change_the_picture(studio: Any, bakes: list[bake.Baked]) -> None:
    tree = set_world(studio)
    bake_now(studio)
    tree.nodes["MixRGB"].location = (300, 200)
    tree.nodes["MixRGB"].label = "Both"
    studio.camera()
    studio.scene.view_settings.exposure = 1.0
    value(tree)
    bake_now(studio)
    tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.5
    assert bake_now(studio) is bakes[0]
    assert len(bakes) == 2


def attribute(studio: Any, tree: Any) -> None:
    tree.nodes.new("ShaderNodeAttribute")


def script(studio: Any, tree: Any) -> None:
    tree.nodes.new("ShaderNodeScript")


def coordinates_of_an_object(studio: Any, tree: Any) -> None:
    tree.nodes.new("ShaderNodeTexCoord").object = studio.plane()


def sequence(studio: Any, tree: Any) -> None:
    tree.nodes["TexEnvironment"].image.source = "SEQUENCE"


@pytest.mark.parametrize("use", [attribute, script, coordinates_of_an_object, sequence])
def test_what_cannot_be_told_unchanged_is_baked_each_time(
    studio: Any, bakes: list[bake.Baked], use: Callable[[Any, Any], None]
) -> None:
    use(studio, set_world(studio))
    bake_now(studio)
    bake_now(studio)
    assert len(bakes) == 2
    assert not bake.kept


def test_a_world_that_is_edited_while_it_is_baked_is_not_kept(
    studio: Any, bakes: list[bake.Baked], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A render has the evaluated world; the user's own, which is baked, may change before it is read."""
    tree = set_world(studio)
    scene = bpy.context.evaluated_depsgraph_get().scene_eval
    make = bake._bake

    def edit(*given: Any) -> Any:
        tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.75
        return make(*given)

    monkeypatch.setattr(bake, "_bake", edit)
    bake.bake_world(scene.world, scene)
    assert len(bakes) == 1
    assert not bake.kept


def test_the_last_used_are_kept(studio: Any, bakes: list[bake.Baked], monkeypatch: pytest.MonkeyPatch) -> None:
    fac = set_world(studio).nodes["MixRGB"].inputs["Fac"]
    monkeypatch.setattr(bake, "MOST_KEPT_BYTES", 2 * 4 * 8 * 3 * 4)
    for value, count in ((0.1, 1), (0.2, 2), (0.1, 2), (0.3, 3), (0.1, 3), (0.2, 4)):
        fac.default_value = value
        bake_now(studio)
        assert len(bakes) == count
    assert len(bake.kept) == 2
    monkeypatch.setattr(bake, "MOST_KEPT_BYTES", 0)
    fac.default_value = 0.4
    assert bake_now(studio) is bake_now(studio)
    assert len(bake.kept) == 1
