# SPDX-License-Identifier: MIT
"""Custom normals of meshes on either side of their faces, against Cycles."""

from __future__ import annotations

import itertools
from typing import Any

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix

from shlight_blender.compat import mesh_triangles, uv_coordinates
from shlight_blender.export.triangle_geometry import triangle_tangents

SHADERS = ("ShaderNodeBsdfDiffuse", "ShaderNodeBsdfPrincipled")
# The cases that run without `--all`: each pair of a turn, a shader and a light.
QUICK = {(-1.0, -1, SHADERS[0], "lamp"), (-1.0, -1, SHADERS[1], "world")}
QUICK |= {(0.3, 1, SHADERS[0], "world"), (0.3, 1, SHADERS[1], "lamp")}


@pytest.mark.parametrize(
    ("turn", "mirror", "shader", "light"),
    [
        pytest.param(*case, marks=() if case in QUICK else pytest.mark.slow)
        for case in itertools.product((-1.0, 0.3), (1, -1), SHADERS, ("world", "lamp"))
    ],
)
def test_normals_on_the_back_of_their_faces(studio: Any, turn: float, mirror: int, shader: str, light: str) -> None:
    """A ball whose normals point inwards, which Cycles draws black, or lean over so that some of them do.

    Turned to the viewer, the first was as bright as any other ball.
    """
    made = studio.ball(material=studio.material(shader), rings=8, scale=(1, mirror, 1))
    normals = np.array([vertex.co for vertex in made.data.vertices])
    normals = -normals if turn < 0 else turn * normals + (0.0, 0.0, 1.0)
    made.data.polygons.foreach_set("use_smooth", [True] * len(made.data.polygons))
    made.data.normals_split_custom_set_from_vertices(normals)
    studio.camera((0, -4, 1), (0, 0, 0))
    if light == "world":
        studio.world((1.0, 0.8, 0.6))
    else:
        studio.area(200, (2, -2, 2), rotation_euler=(0.8, 0.3, 0.5))
    studio.resolution(32, 24)
    studio.scene.cycles.samples = 512
    if turn > 0:
        studio.compare(mean=5e-3, error=1e-3)
    else:
        image, reference = studio.render("SHLIGHT"), studio.render("CYCLES")
        assert np.abs(image - reference).mean() <= 5e-3


@pytest.mark.parametrize("shader", ["ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfToon"])
def test_a_normal_below_the_surface_shows_no_light(studio: Any, shader: str) -> None:
    """It leans away from the viewer, whose mirror image is above the surface."""
    material = studio.material(shader)
    tree = material.node_tree
    bent = tree.nodes.new("ShaderNodeNormalMap")
    bent.inputs["Color"].default_value = (0.5, 0.9, 0.3, 1.0)
    node = next(node for node in tree.nodes if "BSDF" in node.type)
    tree.links.new(bent.outputs["Normal"], node.inputs["Normal"])
    floor = studio.plane(20, material)
    floor.data.uv_layers.new().data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    studio.camera((0, -4, 2), (0, 0, 0), lens=200)
    studio.world((1.0, 0.8, 0.6))
    assert np.abs(studio.render("SHLIGHT") - studio.render("CYCLES")).mean() <= 1e-3


def test_normals_of_a_stretched_object(studio: Any) -> None:
    """A few smooth faces, whose normals Cycles interpolates in the world unless the mesh has instances."""
    studio.ball(material=studio.material("ShaderNodeBsdfAnisotropic", Roughness=0.5), rings=4, scale=(0.5, 0.5, 2))
    studio.camera((0, -6, 1), (0, 0, 0))
    studio.lamp("SUN", 3, (2, -2, 2), angle=0.1, rotation_euler=(0.9, 0.2, 0.4))
    studio.scene.cycles.samples = 512
    studio.compare(mean=3e-3, error=1e-3)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="not known of these versions")
def test_a_vertex_keeps_one_normal_at_an_edge_of_three_faces(studio: Any) -> None:
    """A wall on a floor, all smooth. The floor's far edge is sharp, so that its corners have normals of their own.

    With these the picture had more light than Cycles', whose floor is partly black.
    """
    vertices = [(-1, -1, 0), (0, -1, 0), (1, -1, 0), (-1, 1, 0), (0, 1, 0), (1, 1, 0), (0, -1, 1), (0, 1, 1)]
    vertices += [(2, -1, 0), (2, 1, 0)]
    faces = [(0, 1, 4, 3), (1, 2, 5, 4), (1, 6, 7, 4), (2, 8, 9, 5)]
    mesh = studio.mesh("tee", vertices, faces, studio.material("ShaderNodeBsdfDiffuse")).data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    for edge in mesh.edges:
        edge.use_edge_sharp = set(edge.vertices) == {2, 5}
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    studio.link("sun", sun, rotation_euler=(0.0, 0.7, 0.0))
    studio.camera((0.5, -7, 6), (0.5, 0, 0))
    studio.scene.cycles.samples = 512
    studio.compare(mean=5e-3, error=1e-3)


def normal_mapped(studio: Any) -> Any:
    material = studio.material()
    bent = material.node_tree.nodes.new("ShaderNodeNormalMap")
    bent.inputs["Color"].default_value = (0.85, 0.4, 0.9, 1.0)
    material.node_tree.links.new(bent.outputs["Normal"], material.node_tree.nodes["Diffuse BSDF"].inputs["Normal"])
    return material


def cap(studio: Any, material: Any) -> None:
    """A hexagon with a skirt, smooth and with a UV map."""
    angles = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angles), np.sin(angles), 0.3 * np.cos(2 * angles)], axis=1)
    vertices = np.concatenate([ring, 1.6 * ring + (0, 0, -0.5)])
    faces = [tuple(range(6)), *((i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6) for i in range(6))]
    mesh = studio.mesh("Cap", vertices.tolist(), faces, material).data
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    places = vertices[[loop.vertex_index for loop in mesh.loops]]
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", (places[:, :2] * (-1, 0.5)).ravel())


def floor_of_quads(studio: Any, material: Any) -> None:
    """Four flat quads, each of whose halves has other tangents than the quad as a whole."""
    places = np.array([(x, y) for y in (-1.5, 0.0, 1.5) for x in (-1.5, 0.0, 1.5)])
    faces = [(i, i + 1, i + 4, i + 3) for i in (0, 1, 3, 4)]
    mesh = studio.mesh("Floor", np.pad(places, ((0, 0), (0, 1))).tolist(), faces, material).data
    x, y = places[[loop.vertex_index for loop in mesh.loops]].T
    uvs = np.stack([x + 0.4 * x * y, y - 0.3 * x * x * y], axis=1)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs.ravel())


SINCE_51 = pytest.mark.skipif(bpy.app.version < (5, 1, 0), reason="normal maps have one convention")


@pytest.mark.parametrize("form", ["cap", pytest.param("cap with green down", marks=SINCE_51), "ball", "plane", "quads"])
def test_normal_maps_of_other_faces_than_triangles_and_without_a_uv_map(studio: Any, form: str) -> None:
    """Blender gives no tangents of them, or of faces as a whole, and Cycles has its own. The normals between the cap's
    corners differ much in length.
    """
    if form == "quads":
        floor_of_quads(studio, normal_mapped(studio))
    elif form == "plane":  # all its directions from its origin are of one latitude
        studio.plane(3.0, normal_mapped(studio))
    elif form != "ball":
        material = normal_mapped(studio)
        if form == "cap with green down":
            material.node_tree.nodes["Normal Map"].convention = "DIRECTX"
        cap(studio, material)
    else:
        ball = studio.ball(material=normal_mapped(studio), rings=8)
        ball.data.transform(Matrix.Rotation(0.1, 4, "Z"))  # no corner is where angles begin
    studio.camera((0, -4, 3), (0, 0, 0))
    studio.lamp("SUN", 3, (2, -2, 2), angle=0.1, rotation_euler=(0.6, 0.2, 0.4))
    studio.scene.cycles.samples = 256
    studio.compare(mean=1e-3, error=3e-4)


def test_tangents_are_those_of_blender(studio: Any) -> None:
    """A smooth ball in triangles, one half of whose UV map is mirrored. At the poles its folds meet."""
    mesh = studio.ball(rings=8).data
    form = bmesh.new()
    form.from_mesh(mesh)
    bmesh.ops.triangulate(form, faces=form.faces)
    form.to_mesh(mesh)
    x, y, z = np.array([vertex.co for vertex in mesh.vertices]).T
    of_vertex = np.stack([np.abs(np.arctan2(y, x)), 1.3 * z], axis=1)
    of_loop = [loop.vertex_index for loop in mesh.loops]
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", of_vertex[of_loop].ravel())
    mesh.calc_tangents()
    expected = np.array([(*loop.tangent, loop.bitangent_sign) for loop in mesh.loops])
    normals = np.array([loop.normal for loop in mesh.loops])
    triangles = mesh_triangles(mesh)
    arguments = normals[triangles.corners], uv_coordinates(mesh.uv_layers[0])[triangles.corners]
    found = triangle_tangents(triangles.vertices, triangles.corner_vertices, *arguments)
    is_pole = np.abs(z[triangles.corner_vertices]) > 0.99
    np.testing.assert_allclose(found[~is_pole], expected[triangles.corners][~is_pole], atol=1e-5)
