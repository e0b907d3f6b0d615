# SPDX-License-Identifier: MIT
"""Displacement of normals and of vertices, against Cycles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

METHODS = ("BUMP", "DISPLACEMENT", "BOTH")


def displaced(studio: Any, method: str, node: str = "Displacement", space: str = "OBJECT", **inputs: Any) -> Any:
    """A material with a displacement by a smooth picture of random values."""
    material = studio.material(name="Moved")
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = method
    tree = material.node_tree
    moves, picture = tree.nodes.new(f"ShaderNode{node}"), tree.nodes.new("ShaderNodeTexImage")
    moves.space = space
    for name, value in {"Scale": 0.5, "Midlevel": 0.3, **inputs}.items():
        moves.inputs[name].default_value = value
    picture.image, picture.interpolation = studio.picture(np.random.default_rng(3).random((5, 5, 3))), "Cubic"
    tree.links.new(picture.outputs["Color"], moves.inputs[0])
    tree.links.new(moves.outputs[0], tree.get_output_node("CYCLES").inputs["Displacement"])
    return material


def mapped(mesh: Any) -> Any:
    """The mesh with a UV map of its x and y."""
    layer = mesh.uv_layers.new(name="UVMap")
    for loop, place in zip(mesh.loops, layer.data, strict=True):
        place.uv = [0.5 + c / 3.0 for c in mesh.vertices[loop.vertex_index].co[:2]]
    return mesh


def hills(studio: Any, material: Any, count: int = 24, *, smooth: bool = True) -> Any:
    """A grid of faces, turned, scaled and mirrored, over a floor."""
    ends = np.linspace(-1.5, 1.5, count)
    vertices = [(x, y, 0.0) for y in ends for x in ends]
    first = [j * count + i for j in range(count - 1) for i in range(count - 1)]
    faces = [(i, i + 1, i + count + 1, i + count) for i in first]
    made = studio.mesh("Hills", vertices, faces, material, scale=(1.0, -1.3, 0.8), rotation_euler=(0.1, -0.2, 0.4))
    made.data.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    mapped(made.data)
    studio.plane(location=(0, 0, -1.5))
    studio.area(150, size=0.8)
    studio.camera()
    return made


@pytest.mark.parametrize(
    ("method", "node", "space"),
    [
        *(
            (method, "Displacement", space)
            for method, space in zip(METHODS, ("OBJECT", "WORLD", "OBJECT"), strict=True)
        ),
        *(("DISPLACEMENT", "VectorDisplacement", space) for space in ("TANGENT", "OBJECT", "WORLD")),
        pytest.param("BUMP", "VectorDisplacement", "TANGENT", marks=pytest.mark.slow),
        pytest.param("BOTH", "VectorDisplacement", "OBJECT", marks=pytest.mark.slow),
    ],
)
def test_displacement(studio: Any, method: str, node: str, space: str) -> None:
    hills(studio, displaced(studio, method, node, space))
    studio.compare(mean=2e-3, error=6e-4)


@pytest.mark.parametrize(
    ("shape", "method"), [("box", "BOTH"), ("some flat", "DISPLACEMENT"), ("sharp edges", "DISPLACEMENT")]
)
def test_vertices_of_flat_and_smooth_faces(studio: Any, shape: str, method: str) -> None:
    """Flat faces stay joined where all are flat, and are split off where some are smooth."""
    material = displaced(studio, method)
    made = hills(studio, material, 12)
    if shape == "box":
        made.hide_render = True
        mapped(studio.box((1.5, 1.5, 1.5), material, location=(0, 0, 0.4)).data)
        studio.scene.cycles.samples = 1024
    elif shape == "some flat":
        made.data.polygons.foreach_set("use_smooth", [i % 3 != 0 for i in range(len(made.data.polygons))])
    else:
        made.data.edges.foreach_set("use_edge_sharp", [i % 5 == 0 for i in range(len(made.data.edges))])
    if hasattr(made.data, "use_auto_smooth"):
        made.data.use_auto_smooth = True
    studio.compare(mean=3e-3, error=8e-4)


def test_materials_that_move_what_they_share(studio: Any) -> None:
    """The first triangle that moves a vertex says where to, and both of its materials have the normal."""
    mesh = hills(studio, displaced(studio, "DISPLACEMENT"), 12).data
    mesh.materials.append(studio.material(name="Still", Color=(0.9, 0.2, 0.1)))
    mesh.materials.append(displaced(studio, "BOTH", Scale=-0.2))
    mesh.polygons.foreach_set("material_index", [i // 3 % 3 for i in range(len(mesh.polygons))])
    studio.compare(mean=2e-3, error=6e-4)


@pytest.mark.parametrize("method", METHODS)
def test_what_reads_the_normal_reads_the_bent_one(studio: Any, method: str) -> None:
    """Layer Weight, and a Bump node upon it."""
    material = displaced(studio, method)
    hills(studio, material)
    new, link = material.node_tree.nodes.new, material.node_tree.links.new
    picture = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    weight, bump = new("ShaderNodeLayerWeight"), new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 0.2
    link(weight.outputs["Facing"], shader.inputs["Color"])
    link(picture.outputs["Color"], bump.inputs["Height"])
    link(bump.outputs["Normal"], shader.inputs["Normal"])
    studio.compare(mean=4e-3, error=1e-3)


@pytest.mark.parametrize("method", ["BUMP", "BOTH"])
def test_a_normal_map_is_not_bent_and_leans_from_what_is(studio: Any, method: str) -> None:
    """It is a bump of the bent surface, and shades itself the less the nearer to the bent normal it leans."""
    material = displaced(studio, method)
    bent = material.node_tree.nodes.new("ShaderNodeNormalMap")
    bent.inputs["Color"].default_value = (0.9, 0.3, 0.8, 1)
    material.node_tree.links.new(bent.outputs["Normal"], material.node_tree.nodes["Diffuse BSDF"].inputs["Normal"])
    hills(studio, material)
    studio.compare(mean=2e-3, error=4e-4)


@pytest.mark.parametrize("method", METHODS[:2])
def test_the_place_of_a_displacement_is_that_before_it(studio: Any, method: str) -> None:
    """Coordinates of the object are those that the UV map has of it, though they would move along with the mesh."""
    material = displaced(studio, method)
    hills(studio, material)
    new, link = material.node_tree.nodes.new, material.node_tree.links.new
    picture = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    place, of_map, turned = (new(f"ShaderNode{kind}") for kind in ("TexCoord", "Mapping", "Mapping"))
    of_map.inputs["Scale"].default_value, of_map.inputs["Location"].default_value = (3, 3, 0), (-1.5, -1.5, 0)
    turned.inputs["Rotation"].default_value = (0.8, 0.5, 0.0)
    link(place.outputs["UV"], of_map.inputs["Vector"])
    link(turned.outputs["Vector"], picture.inputs["Vector"])
    pictures = []
    for source in (place.outputs["Object"], of_map.outputs["Vector"]):
        link(source, turned.inputs["Vector"])
        pictures.append(studio.render("SHLIGHT"))
    assert np.abs(pictures[0] - pictures[1]).mean() <= 2e-4 * pictures[0].mean()


@pytest.mark.parametrize("width", [None, 1.0])
@pytest.mark.parametrize("method", ["BUMP", "BOTH"])
def test_waves_of_a_ball(studio: Any, method: str, width: float | None) -> None:
    """Cycles looks their slope up along the displaced face; where they bend the normal, it tells how a ray is lifted.

    width: of a Bump node upon them, whose heights are compared over another distance than the displacement's.
    """
    material = displaced(studio, method, Scale=0.1, Midlevel=0.0)
    new, link = material.node_tree.nodes.new, material.node_tree.links.new
    wave = new("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 2.0
    link(new("ShaderNodeTexCoord").outputs["Object"], wave.inputs["Vector"])
    moves = next(node for node in material.node_tree.nodes if node.type == "DISPLACEMENT")
    link(wave.outputs["Color"], moves.inputs["Height"])
    if width is not None:
        bump = new("ShaderNodeBump")
        if "Filter Width" not in bump.inputs:
            pytest.skip("Bump nodes of this version of Blender have no width")
        bump.inputs["Filter Width"].default_value = width
        link(wave.outputs["Color"], bump.inputs["Height"])
        shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
        link(bump.outputs["Normal"], shader.inputs["Normal"])
    studio.terminator(studio.ball(material=material, rings=32), 0.5, 0.0)
    studio.area(150, (3, -1, 1.5), rotation_euler=(0.2, 1.1, 0.0), size=0.5)
    studio.camera((0, -6, 0), (0, 0, 0))
    studio.scene.cycles.samples = 512
    studio.compare(mean=6e-3, error=3e-3)


def test_a_change_moves_the_vertices_again(studio: Any) -> None:
    """Vertices that are kept follow a change of the material, and one of the object's place."""
    material = displaced(studio, "DISPLACEMENT", space="WORLD")
    made = hills(studio, material, 8)
    studio.scene.render.use_persistent_data = True
    node = next(node for node in material.node_tree.nodes if node.type == "DISPLACEMENT")
    studio.render("SHLIGHT")
    for owner, name, value in ((node.inputs["Scale"], "default_value", 1.0), (made, "rotation_euler", (0.5, 0.2, 0.1))):
        setattr(owner, name, value)
        kept = studio.render("SHLIGHT")
        studio.scene.render.use_persistent_data = False
        np.testing.assert_array_equal(kept, studio.render("SHLIGHT"))
        studio.scene.render.use_persistent_data = True
        studio.render("SHLIGHT")
