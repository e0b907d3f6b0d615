# SPDX-License-Identifier: MIT
"""Emission that depends on the side that is seen, against Cycles: light on a floor, in a mirror and to the camera."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest


def glow(studio: Any, output: str, front: float, back: float, *, textured: bool = False) -> Any:
    """A material that emits `front` where an output of Geometry is 0, `back` where that is 1; or colours of a checker
    times as much."""
    made = studio.material("ShaderNodeEmission", name="Glow")
    tree = made.node_tree
    side = tree.nodes.new("ShaderNodeNewGeometry").outputs[output]
    if output == "True Normal":
        axes = tree.nodes.new("ShaderNodeSeparateXYZ")
        tree.links.new(side, axes.inputs[0])
        side = axes.outputs["Z"]
    strength = tree.nodes.new("ShaderNodeMapRange")
    strength.inputs["To Min"].default_value, strength.inputs["To Max"].default_value = front, back
    tree.links.new(side, strength.inputs["Value"])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(strength.outputs[0], emission.inputs["Strength"])
    if textured:
        checker = tree.nodes.new("ShaderNodeTexChecker")
        checker.inputs["Scale"].default_value = 2.0
        checker.inputs["Color1"].default_value = (1, 0.2, 0.1, 1)
        checker.inputs["Color2"].default_value = (0.1, 0.3, 1, 1)
        place = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(place.outputs["Object"], checker.inputs["Vector"])
        tree.links.new(checker.outputs["Color"], emission.inputs["Color"])
    return made


def half_ball(studio: Any, material: Any, **properties: Any) -> Any:
    whole = studio.ball(0.5, material, smooth=False, rings=12, **properties)
    upper = [face.vertices[:] for face in whole.data.polygons if face.center.z > 0]
    vertices = [vertex.co[:] for vertex in whole.data.vertices]
    whole.data.clear_geometry()
    whole.data.from_pydata(vertices, [], upper)
    return whole


SHAPES = {
    "square": lambda studio, *own, **given: studio.plane(0.8, *own, **given),
    "box": lambda studio, *own, **given: studio.box((0.7, 0.6, 0.5), *own, **given),
    "ball": lambda studio, *own, **given: studio.ball(0.4, *own, smooth=False, rings=10, **given),
    "half ball": half_ball,
}


@pytest.mark.parametrize(
    ("shape", "output", "front", "back", "textured", "width"),
    [
        pytest.param("square", "Backfacing", 5, 0, False, 1, marks=pytest.mark.slow),
        ("square", "True Normal", 0, 5, False, -1),
        ("box", "Backfacing", 5, 2, True, 1),
        pytest.param("ball", "Backfacing", 5, 0, False, 1, marks=pytest.mark.slow),
        pytest.param("half ball", "Backfacing", 0, 5, False, -1, marks=pytest.mark.slow),
        pytest.param("half ball", "Backfacing", 2, 5, True, 1, marks=pytest.mark.slow),
    ],
)
def test_each_side_gives_its_own_light(
    studio: Any, shape: str, output: str, front: float, back: float, textured: bool, width: float
) -> None:
    studio.plane(6, studio.material())
    mirror = studio.material("ShaderNodeBsdfGlossy", name="Mirror", Roughness=0.0)
    studio.plane(6, mirror, location=(0, 2, 0), rotation_euler=(np.pi / 2, 0, 0))
    material = glow(studio, output, front, back, textured=textured)
    turned = {"rotation_euler": (0.5, 1.2, 0.3), "scale": (width, 1, 1)}
    SHAPES[shape](studio, material, location=(0.2, 0.3, 0.9), **turned)
    studio.camera((1.5, -5, 3.5))
    studio.resolution(48, 36)
    studio.scene.shlight.noise_threshold = 2e-3  # little of a hollow is seen, by rays to all of it
    studio.compare()
    assert studio.messages(most=99) == []


@pytest.mark.parametrize("textured", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_dome_lights_what_it_surrounds_by_its_inside_alone(studio: Any, textured: bool) -> None:
    studio.plane(2, studio.material(), rotation_euler=(0.2, 0.3, 0))
    dome = studio.ball(4, glow(studio, "Backfacing", 0, 1, textured=textured), rings=8)
    studio.camera((1, -3, 1.5))
    studio.resolution(32, 24)
    image, _ = studio.compare()
    assert image[..., :3].mean() > 0.3
    dome.data.materials[0] = glow(studio, "Backfacing", 1, 0, textured=textured)
    assert np.abs(studio.render("SHLIGHT")[..., :3]).max() == 0


def test_light_that_varies_with_the_direction_has_its_total(studio: Any) -> None:
    """A ball whose rim shines, far from the floor that is seen."""
    made = glow(studio, "Backfacing", 0, 0)
    tree = made.node_tree
    facing = tree.nodes.new("ShaderNodeLayerWeight")
    facing.inputs["Blend"].default_value = 0.7
    brighter = tree.nodes.new("ShaderNodeMath")
    brighter.operation, brighter.inputs[1].default_value = "MULTIPLY", 40.0
    tree.links.new(facing.outputs["Facing"], brighter.inputs[0])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(brighter.outputs[0], emission.inputs["Strength"])
    studio.ball(0.3, made, rings=24, location=(0, 0, 3))
    studio.plane(4)
    studio.plain_world((0, 0, 0))
    studio.camera(location=(0, -4, 2), target=(0, 0, 0))
    studio.compare(mean=0.01, error=2e-3)
    assert any("varies with the direction" in message for message in studio.messages())
