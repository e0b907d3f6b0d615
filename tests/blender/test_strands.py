# SPDX-License-Identifier: MIT
"""Hair of particle systems, hair curves and point clouds, against Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

from shlight.metrics import mean_ratio


def hairy(studio: Any, material: Any = None, **settings: Any) -> Any:
    """A ball with bent hair and its children, over a floor; `settings` of the particles."""
    studio.plane(material=studio.material(Color=(0.7, 0.7, 0.6)))
    ball = studio.ball(
        0.8, studio.material(Color=(0.6, 0.4, 0.3)), location=(0, 0, 0.9), rotation_euler=(0.3, 0.2, 0.5)
    )
    ball.data.materials.append(material or studio.material(Color=(0.8, 0.5, 0.2)))
    modifier = ball.modifiers.new("Hair", "PARTICLE_SYSTEM")
    own = modifier.particle_system.settings
    given = {
        **{"type": "HAIR", "count": 60, "hair_length": 0.9, "brownian_factor": 0.12, "material": 2},
        **{"root_radius": 1.0, "tip_radius": 0.3, "radius_scale": 0.02, "shape": 0.3},
        **{"child_type": "SIMPLE", "rendered_child_count": 12, "child_radius": 0.15},
    }
    for name, value in (given | settings).items():
        setattr(own, name, value)
    studio.area(150, (1.5, -1, 3), size=0.8)
    studio.camera((1.5, -4, 2.5), (0, 0, 0.8))
    studio.resolution(40, 30)
    return ball


def strand_curves(studio: Any, counts: list[int], material: Any, **place: Any) -> Any:
    """An object of hair curves that stand on the floor and bend over."""
    data = bpy.data.hair_curves.new("Fur")
    data.add_curves(counts)
    rng = np.random.default_rng(3)
    points, radii = [], []
    for count in counts:
        root, bend = rng.uniform(-1, 1, 2), rng.normal(size=2)
        t = np.linspace(0, 1, count)[:, None]
        points.append(np.hstack([root + 0.5 * bend * t**2, 1.2 * t]))
        radii.append(rng.uniform(0.01, 0.05) * (1 - 0.7 * t[:, 0]))
    flat = np.concatenate(points).astype(np.float32)
    data.position_data.foreach_set("vector", flat.ravel())
    radius = data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.concatenate(radii).astype(np.float32))
    data.materials.append(material)
    return studio.link("Fur", data, **place)


def cloud(studio: Any, material: Any, **place: Any) -> Any:
    """A mesh whose vertices geometry nodes make points of."""
    rng = np.random.default_rng(5)
    made = studio.mesh("Cloud", rng.uniform((-1, -1, 0.1), (1, 1, 1), (80, 3)), [], **place)
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    new, link = tree.nodes.new, tree.links.new
    start, end, points = new("NodeGroupInput"), new("NodeGroupOutput"), new("GeometryNodeMeshToPoints")
    random, paint = new("FunctionNodeRandomValue"), new("GeometryNodeSetMaterial")
    sizes = [socket for socket in random.inputs if socket.type == "VALUE" and socket.enabled]
    sizes[0].default_value, sizes[1].default_value = 0.03, 0.2
    paint.inputs["Material"].default_value = material
    link(start.outputs[0], points.inputs["Mesh"])
    link(next(socket for socket in random.outputs if socket.enabled), points.inputs["Radius"])
    link(points.outputs[0], paint.inputs["Geometry"])
    link(paint.outputs[0], end.inputs[0])
    made.modifiers.new("Nodes", "NODES").node_group = tree
    return made


@pytest.mark.parametrize("shape", ["RIBBONS", pytest.param("THICK", marks=pytest.mark.slow)])
def test_hair_of_particles(studio: Any, shape: str) -> None:
    hairy(studio)
    studio.scene.cycles_curves.shape = shape
    studio.compare(error=1e-2)  # which is that of Cycles alone
    assert studio.messages() == []


@pytest.mark.parametrize("shape", [pytest.param("RIBBONS", marks=pytest.mark.slow), "THICK"])
def test_hair_curves(studio: Any, shape: str) -> None:
    studio.lit_floor()
    gray = studio.material("ShaderNodeBsdfPrincipled", Base_Color=(0.7, 0.4, 0.2), Roughness=0.4)
    strand_curves(studio, [2, 3, 7, 4, 12, 5] * 20, gray, scale=(0.5, 1.6, 1.2), rotation_euler=(0.1, 0, 0.4))
    studio.scene.cycles_curves.shape = shape
    studio.resolution(40, 30)
    studio.compare()
    assert studio.messages() == []


def test_point_clouds(studio: Any) -> None:
    studio.lit_floor()
    gray = studio.material("ShaderNodeBsdfPrincipled", Base_Color=(0.7, 0.4, 0.2), Roughness=0.4)
    first = cloud(studio, gray, rotation_euler=(0, 0, 0.4), scale=(0.6, 1.4, 1.0))
    studio.link("Other", first.data, (1.5, 1.5, 0), scale=(0.7, 0.7, 0.7)).modifiers.new(
        "Nodes", "NODES"
    ).node_group = first.modifiers[0].node_group
    studio.resolution(40, 30)
    studio.compare()
    assert studio.messages() == []


INFO = ("Is Strand", "Intercept", "Length", "Thickness", "Random")


@pytest.mark.parametrize("kind", ["particles", "curves"])
@pytest.mark.parametrize("output", [*INFO, "UV"])
def test_what_hair_knows_of_itself(studio: Any, kind: str, output: str) -> None:
    """The camera sees it as emission; nothing else shines."""
    material = studio.material("ShaderNodeEmission")
    tree = material.node_tree
    scale = tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "SCALE"
    scale.inputs["Scale"].default_value = 5.0 if output == "Thickness" else 0.5
    if output == "UV":
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], scale.inputs[0])
    else:
        tree.links.new(tree.nodes.new("ShaderNodeHairInfo").outputs[output], scale.inputs[0])
    tree.links.new(scale.outputs[0], tree.nodes["Emission"].inputs["Color"])
    if kind == "particles":
        ball = hairy(studio, material)
        coordinates = np.random.default_rng(7).random((len(ball.data.loops), 2)).astype(np.float32)
        ball.data.uv_layers.new().uv.foreach_set("vector", coordinates.ravel())
    else:
        studio.plane(material=studio.material())
        fur = strand_curves(studio, [2, 3, 7, 4, 12, 5] * 20, material)
        uv = fur.data.attributes.new("surface_uv", "FLOAT2", "CURVE")
        uv.data.foreach_set("vector", np.random.default_rng(8).random(240).astype(np.float32))
        studio.camera()
    for lamp in [own for own in studio.scene.objects if own.type == "LIGHT"]:
        bpy.data.objects.remove(lamp)
    studio.resolution(64, 48)
    studio.scene.cycles.samples = 64
    for plane in [own for own in studio.scene.objects if own.type == "MESH"]:
        plane.data.materials[0] = studio.material("ShaderNodeEmission", Strength=0.0)
    image, reference = studio.render("SHLIGHT"), studio.render("CYCLES")
    assert abs(mean_ratio(image, reference) - 1) <= 5e-3
    assert np.abs(image - reference).mean() <= 0.02 * np.abs(reference).mean() + 5e-3


def test_emitters_may_be_hidden_and_filters_leave_hair_out(studio: Any) -> None:
    ball = hairy(studio)
    ball.show_instancer_for_render = ball.show_instancer_for_viewport = False
    studio.compare(error=1e-2)
    bpy.context.view_layer.use_strand = False
    studio.compare()
