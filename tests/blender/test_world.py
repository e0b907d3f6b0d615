# SPDX-License-Identifier: MIT
"""The world as light and background, against Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest


def set_world(studio: Any, color: tuple[float, float, float], strength: float = 1.0) -> Any:
    """A world of one Background node; returns the node."""
    world = studio.scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    node = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    node.inputs["Color"].default_value = (*color, 1)
    node.inputs["Strength"].default_value = strength
    return node


def messages() -> list[str]:
    from shlight_blender.export import export_scene

    return export_scene(bpy.context.evaluated_depsgraph_get()).report.lines()


def balls(studio: Any) -> None:
    """A diffuse and a glossy ball on a floor."""
    studio.plane(material=studio.material(Color=(0.7, 0.6, 0.5)))
    studio.ball(material=studio.material(Color=(0.8, 0.5, 0.3)), rings=32, location=(-1.1, 0, 1))
    glossy = studio.material("ShaderNodeBsdfAnisotropic", Color=(0.9, 0.8, 0.6), Roughness=0.5, distribution="GGX")
    studio.ball(material=glossy, rings=32, location=(1.1, 0, 1))
    studio.camera(target=(0, 0, 0.8))


def test_constant_world(studio: Any) -> None:
    balls(studio)
    set_world(studio, (0.4, 0.6, 1.0), 1.5)
    image, _ = studio.compare(error=1e-3)
    assert messages() == []
    np.testing.assert_array_equal(image[..., 3], 1)


@pytest.mark.parametrize("transparent", [True, False])
def test_world_without_nodes_and_film(studio: Any, transparent: bool) -> None:
    studio.ball(material=studio.material(Color=(0.8, 0.5, 0.3)), rings=32)
    studio.camera()
    studio.scene.world = world = bpy.data.worlds.new("World")
    world.use_nodes = False
    world.color = (0.2, 0.4, 0.6)
    studio.scene.render.film_transparent = transparent
    image, reference = studio.compare(error=1e-3)
    assert np.abs(image[..., 3] - reference[..., 3]).mean() < 2e-3


def test_world_and_lamp(studio: Any) -> None:
    studio.still_life()
    studio.camera()
    set_world(studio, (0.3, 0.3, 0.4))
    studio.compare(error=2e-3)
