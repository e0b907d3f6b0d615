# SPDX-License-Identifier: MIT
"""A scene that Blender writes as glTF, and shlight.load reads, looks as the add-on exports it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

import shlight
from shlight.metrics import mean_ratio, rel_mse
from shlight_blender.export import export_scene

pytest.importorskip("trimesh")
pytest.importorskip("PIL")


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_scene_by_way_of_gltf_is_the_scene(studio: Any, tmp_path: Path) -> None:
    # The distribution is one that glTF has, and the colour is a picture.
    gloss = {"Roughness": 0.2, "distribution": "GGX"}
    painted = studio.material("ShaderNodeBsdfPrincipled", "Painted", Metallic=0.5, **gloss)
    nodes, links = painted.node_tree.nodes, painted.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = studio.picture(np.random.default_rng(1).integers(0, 255, (8, 8, 3)) / 255, is_float=False)
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    bpy.ops.mesh.primitive_plane_add(size=6)
    bpy.context.object.data.materials.append(painted)
    red = studio.material("ShaderNodeBsdfPrincipled", "Red", Base_Color=(0.8, 0.2, 0.1), **gloss)
    studio.box((1, 1.5, 1), red, location=(0, 0, 1), rotation_euler=(0.2, 0, 0.5))
    studio.lamp("POINT", 200, (2, -2, 3), shadow_soft_size=0)
    studio.lamp("SUN", 1, (0, 0, 3), angle=0, rotation_euler=(0.4, 0.6, 0))
    studio.camera((1, -6, 3.5), (0, 0, 0.5))
    bpy.context.view_layer.update()
    size, settings = (96, 64), {"min_samples": 16, "max_samples": 64, "max_bounces": 0}
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = size
    expected = shlight.render(export_scene(bpy.context.evaluated_depsgraph_get()).scene, *size, **settings)
    path = tmp_path / "scene.glb"
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.export_scene.gltf(filepath=str(path), export_lights=True, export_cameras=True)
    image = shlight.render(shlight.load(path), *size, **settings)
    assert abs(mean_ratio(image, expected) - 1) <= 1e-5
    assert rel_mse(image, expected) <= 1e-8  # glTF holds float32
