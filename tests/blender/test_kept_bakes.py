# SPDX-License-Identifier: MIT
"""Baked worlds are kept: the same world is baked once, and any change of what it is made of bakes it again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
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

    def make(request: Any, folder: Any, waiting: Any) -> bake.Baked:
        made.append(bake.Baked(np.zeros((4, 8, 3), dtype=np.float32)))
        return made[-1]

    monkeypatch.setattr(bake, "_baked", make)
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
    kinds = ("TexNoise", "ValToRGB", "RGBCurve", "TexEnvironment", "TexIES", "MixRGB", "Group")
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


def changes(studio: Any) -> Iterator[str]:
    """A world of which one thing more is another each time that the next is asked for; yields which."""
    tree = set_world(studio)
    kinds = ("MixRGB", "TexNoise", "ValToRGB", "RGBCurve", "TexIES", "TexEnvironment")
    mix, noise, ramp, curve, profile, environment = (tree.nodes[kind] for kind in kinds)
    inner, image = tree.nodes["Group"].node_tree, environment.image
    yield "nothing"
    mix.inputs["Fac"].default_value += 1e-6
    yield "value"
    mix.inputs["Color1"].default_value[2] = 0.3
    yield "colour"
    noise.noise_dimensions = "4D"
    yield "property of a node"
    noise.texture_mapping.rotation[2] = 0.2
    yield "mapping of a texture"
    ramp.color_ramp.elements[0].position = 0.1
    yield "position in a ramp"
    curve.mapping.curves[3].points[0].location = (0.0, 0.2)
    yield "point of a curve"
    curve.mute = True
    yield "muted node"
    inner.nodes["Value"].outputs[0].default_value = 3.0
    yield "value in a group"
    tree.nodes["Group"].node_tree = other = inner.copy()
    other.nodes["Value"].outputs[0].default_value = 4.0
    yield "another group"
    tree.links[0].is_muted = True
    yield "muted link"
    tree.links.remove(tree.links[0])
    yield "removed link"
    tree.links.new(noise.outputs[1], ramp.inputs["Fac"])
    yield "moved link"
    profile.ies.write("IESNA")
    yield "text of a profile"
    profile.mode, profile.filepath = "EXTERNAL", str(studio.folder / "lamp.ies")
    yield "missing file of a profile"
    for text in ("IESNA 1", "IESNA 2"):
        Path(profile.filepath).write_text(text)
        yield "file of a profile"
    size = Path(image.filepath).stat().st_size
    assert picture_file(studio, 0.75) == image.filepath
    assert Path(image.filepath).stat().st_size == size
    yield "file of a picture"
    image.colorspace_settings.name = "Non-Color"
    yield "space of a picture's colours"
    image.alpha_mode = "CHANNEL_PACKED"
    yield "alpha of a picture"
    image.pixels[5] = 0.875
    image.update()
    yield "one pixel"
    # It differs from its file already; at last its shape changes alone.
    for grey, shape in ((0.5, (4, 2)), (0.6, (4, 2)), (0.6, (2, 4))):
        image.scale(*shape)
        image.pixels.foreach_set(np.full(32, grey, dtype=np.float32))
        yield f"painted {grey}, {shape}"
    for grey in (0.25, 0.5):
        image.pixels.foreach_set(np.full(32, grey, dtype=np.float32))
        image.pack()
        assert not image.is_dirty
        yield "packed picture"
    environment.image = bpy.data.images.load(picture_file(studio, 0.25))
    environment.image.filepath = "/nowhere/sky.png"
    yield "missing file of a picture"
    environment.image = None
    yield "no picture"
    environment.image = made = bpy.data.images.new("Made", 4, 2)
    yield "generated picture"
    made.generated_type = "COLOR_GRID"
    yield "kind of a generated picture"
    made.generated_color = (0.1, 0.2, 0.4, 1.0)
    yield "colour of a generated picture"
    made.generated_width = 6
    yield "width of a generated picture"
    studio.scene.shlight.world_width *= 2
    studio.scene.update_tag()
    yield "width"
    if hasattr(bpy.data, "colorspace"):  # before Blender 5 its colours are always Rec. 709
        before = bpy.data.colorspace.working_space
        bpy.ops.wm.set_working_color_space(working_space="Linear Rec.2020", convert_colors=False)
        yield "space of the colours"
        bpy.ops.wm.set_working_color_space(working_space=before, convert_colors=False)


def test_every_change_is_baked_once(studio: Any, bakes: list[bake.Baked]) -> None:
    for count, what in enumerate(changes(studio), 1):
        assert bake_now(studio) is bake_now(studio) is bakes[-1], what
        assert len(bakes) == count, what


def test_values_that_the_render_alone_has(studio: Any, bakes: list[bake.Baked]) -> None:
    """An animation's values are in the evaluated world, and not always in the user's own."""
    set_world(studio)
    scene = bpy.context.evaluated_depsgraph_get().scene_eval
    bake.bake_world(scene.world, scene)
    scene.world.node_tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.7
    bake.bake_world(scene.world, scene)
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


def test_what_does_not_change_the_picture(studio: Any, bakes: list[bake.Baked]) -> None:
    tree = set_world(studio)
    bake_now(studio)
    tree.nodes["MixRGB"].location = (300, 200)
    tree.nodes["MixRGB"].label = "Both"
    studio.camera()
    studio.scene.view_settings.exposure = 1.0
    studio.scene.frame_set(2)
    bake_now(studio)
    assert len(bakes) == 1
    tree.nodes["MixRGB"].inputs["Fac"].default_value += 1e-6
    bake_now(studio)
    tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.5
    assert bake_now(studio) is bakes[0]
    assert len(bakes) == 2


@pytest.mark.parametrize("use", ["attribute", "script", "coordinates of an object", "sequence"])
def test_what_cannot_be_told_unchanged_is_baked_each_time(studio: Any, bakes: list[bake.Baked], use: str) -> None:
    nodes = set_world(studio).nodes
    if use == "sequence":
        nodes["TexEnvironment"].image.source = "SEQUENCE"
    elif use == "coordinates of an object":
        nodes.new("ShaderNodeTexCoord").object = studio.plane()
    else:
        nodes.new(f"ShaderNode{use.title()}")
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
    make = bake._baked

    def edit(*given: Any) -> Any:
        tree.nodes["MixRGB"].inputs["Fac"].default_value = 0.75
        return make(*given)

    monkeypatch.setattr(bake, "_baked", edit)
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
