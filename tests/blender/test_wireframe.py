# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Wireframe node: edges of triangles as they stand in the world, as in Cycles."""

from __future__ import annotations

from typing import Any

import pytest


def wired(studio: Any, *, size: float, in_pixels: bool, shader: str, socket: str) -> Any:
    """A material whose colour shows the edges."""
    material = studio.material(shader)
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeWireframe")
    node.use_pixel_size = in_pixels
    node.inputs["Size"].default_value = size
    target = next(each for each in tree.nodes if each.bl_idname == shader)
    tree.links.new(node.outputs[0], target.inputs[socket])
    return material


@pytest.mark.parametrize(
    ("size", "in_pixels", "kind"),
    [(0.05, False, "PERSP"), (6.0, True, "PERSP"), (6.0, True, "ORTHO")],
    ids=["metres", "pixels", "parallel"],
)
def test_edges_are_those_of_cycles(studio: Any, size: float, in_pixels: bool, kind: str) -> None:
    """A ball that is stretched, and a box that is turned."""
    material = wired(studio, size=size, in_pixels=in_pixels, shader="ShaderNodeBsdfDiffuse", socket="Color")
    studio.ball(1.0, material, location=(-1.2, 0, 0), scale=(1, 1, 1.5), rings=8)
    studio.box(material=material, location=(1.2, 0, 0), rotation_euler=(0.4, 0.2, 0.7))
    studio.lamp("SUN", 3, (0, 0, 5), rotation_euler=(0.9, 0.2, 0.4))
    studio.camera((0, -7, 2), (0, 0, 0), type=kind, ortho_scale=5)
    studio.resolution(96, 64)
    assert studio.messages() == []
    studio.compare(error=2e-3)


def test_edges_that_shine_are_named(studio: Any) -> None:
    material = wired(studio, size=0.2, in_pixels=False, shader="ShaderNodeEmission", socket="Strength")
    studio.lit_floor()
    studio.plane(size=2, material=material, location=(0, 0, 1))
    assert any("Wireframe in its emission is drawn coarsely" in line for line in studio.messages(most=99))
