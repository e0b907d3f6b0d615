# SPDX-License-Identifier: MIT
"""Shadow Terminator of objects: coarse smooth meshes as Cycles draws them at the edge of their own shadow."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

SIDEWAYS = (0.2, 1.1, 0.0)


def _uneven_world(studio: Any) -> None:
    background = studio.world()
    tree = background.id_data
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    bright = np.full((16, 32, 3), 0.1)
    bright[7:11, 20:25] = 12.0
    texture.image = studio.picture(bright)
    tree.links.new(texture.outputs[0], background.inputs["Color"])


LIGHTS = {
    "area": lambda studio: studio.area(150, (3, -1, 1.5), rotation_euler=SIDEWAYS),
    "large area": lambda studio: studio.area(400, (3, -1, 1.5), rotation_euler=SIDEWAYS, size=4.0),
    "point": lambda studio: studio.lamp("POINT", 300, (3, -1, 2), shadow_soft_size=0.0),
    "sun": lambda studio: studio.lamp("SUN", 3, (0, 0, 0), rotation_euler=SIDEWAYS, angle=0.3),
    "even world": lambda studio: studio.world((0.7, 0.6, 0.5)),
    "uneven world": _uneven_world,
}
SHADERS = {
    "diffuse": {"Color": (0.8, 0.8, 0.8)},
    "glossy": {"shader": "ShaderNodeBsdfAnisotropic", "Color": (0.8, 0.8, 0.8), "Roughness": 0.5},
}


DEFAULT, FAR, SHADING = (0.1, 0.0), (0.5, 0.0), (0.0, 0.3)


@pytest.mark.parametrize(
    ("light", "shader", "offsets"),
    [
        ("area", "diffuse", DEFAULT),
        pytest.param("large area", "glossy", FAR, marks=pytest.mark.slow),
        ("point", "diffuse", FAR),
        pytest.param("sun", "diffuse", DEFAULT, marks=pytest.mark.slow),
        ("even world", "diffuse", FAR),
        ("uneven world", "diffuse", FAR),
        ("area", "glossy", SHADING),
        pytest.param("point", "diffuse", SHADING, marks=pytest.mark.slow),
        pytest.param("even world", "glossy", SHADING, marks=pytest.mark.slow),
        pytest.param("uneven world", "diffuse", SHADING, marks=pytest.mark.slow),
    ],
)
def test_a_coarse_ball_and_a_roof(studio: Any, light: str, shader: str, offsets: tuple[float, float]) -> None:
    """Without its default offset the diffuse pictures are 1.2 to 2.5 % too dark under lamps."""
    material = studio.material(**SHADERS[shader])
    studio.terminator(studio.ball(material=material, rings=4), *offsets)
    places = [(1.3 + 0.8 * t, y, 0.6 * math.cos(2.2 * t)) for y in (-1, 1) for t in (-1, -0.5, 0, 0.5, 1)]
    roof = studio.mesh("Roof", places, [(i, i + 1, i + 6, i + 5) for i in range(4)], material, location=(0.6, 0, 0))
    roof.data.polygons.foreach_set("use_smooth", [True] * 4)
    studio.terminator(roof, *offsets)
    studio.camera((0.8, -5, 1.5), (0.8, 0, 0))
    LIGHTS[light](studio)
    studio.resolution(32, 24)
    studio.scene.cycles.samples = 1024
    studio.scene.shlight.noise_threshold = 0.003
    studio.compare(mean=5e-3, error=1.5e-3)  # Cycles' noise of a large lamp is 5e-4


def test_bumps_of_a_metal(studio: Any) -> None:
    """They take no light from below the smooth surface, with which the picture is 1.3 % too bright."""
    material = studio.material("ShaderNodeBsdfAnisotropic", Color=(0.8, 0.8, 0.8), Roughness=0.5)
    new, link = material.node_tree.nodes.new, material.node_tree.links.new
    wave, bump = new("ShaderNodeTexWave"), new("ShaderNodeBump")
    wave.inputs["Scale"].default_value, bump.inputs["Distance"].default_value = 2.0, 0.3
    link(new("ShaderNodeTexCoord").outputs["Object"], wave.inputs["Vector"])
    link(wave.outputs["Color"], bump.inputs["Height"])
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_GLOSSY")
    link(bump.outputs["Normal"], shader.inputs["Normal"])
    studio.terminator(studio.ball(material=material, rings=32), *DEFAULT)
    studio.camera((0, -6, 0), (0, 0, 0))
    LIGHTS["area"](studio)
    studio.world((0.4, 0.4, 0.4))
    studio.scene.cycles.samples = 512
    studio.compare(mean=8e-3, error=8e-3)


def test_objects_of_one_mesh_have_their_own_offsets(studio: Any) -> None:
    """Half of the picture is a ball without its light at grazing angles, and must not be as the other half."""
    left = studio.ball(material=studio.material(), rings=4, location=(-1.1, 0, 0))
    right = studio.link("Right", left.data, location=(1.1, 0, 0))
    studio.terminator(left, 0.1, 0.0)
    studio.terminator(right, 0.1, 0.5)
    studio.camera((0, -6, 1), (0, 0, 0))
    LIGHTS["sun"](studio)
    studio.scene.cycles.samples = 512
    image, _ = studio.compare(mean=5e-3, error=2e-3)
    assert image[:, 32:, :3].mean() <= 0.8 * image[:, :32, :3].mean()
