# SPDX-License-Identifier: MIT
"""Adaptive subdivision, against Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from test_displacement import displaced, hills

from shlight.metrics import rel_mse
from shlight_blender.compat import DICES_OTHERWISE, Dicing
from shlight_blender.export import dicing
from shlight_blender.export.camera import View
from shlight_blender.export.mesh_arrays import MeshArrays, Undisplaced


def subdivided(studio: Any, made: Any, kind: str = "SIMPLE") -> Any:
    """The owner of the switch of an object's adaptive subdivision, which is on."""
    own = made.modifiers.new("Subdivision", "SUBSURF")
    own.subdivision_type, own.levels, own.render_levels = kind, 1, 1
    if hasattr(studio.scene.cycles, "feature_set"):
        studio.scene.cycles.feature_set = "EXPERIMENTAL"
    owner = own if hasattr(own, "use_adaptive_subdivision") else made.cycles
    owner.use_adaptive_subdivision = True
    return owner


@pytest.mark.parametrize("kind", ["SIMPLE", "CATMULL_CLARK", "smooth box"])
def test_adaptive_subdivision(studio: Any, kind: str) -> None:
    """Vertices are moved of edges as long as pixels, flat faces get small, and normals are those of the mesh before."""
    if kind == "SIMPLE":
        made = hills(studio, displaced(studio, "DISPLACEMENT"), 2)
    else:
        flat = studio.ball(1.0, studio.material(), rings=3, smooth=False, location=(0, 0, 1))
        smooth = studio.box((1.5, 1.5, 1.5), studio.material(), location=(0, 0, 1))
        smooth.data.polygons.foreach_set("use_smooth", [True] * 6)
        made, other = (flat, smooth) if kind == "CATMULL_CLARK" else (smooth, flat)
        bpy.data.objects.remove(other)
        studio.lit_floor()
    owner = subdivided(studio, made, "CATMULL_CLARK" if kind == "CATMULL_CLARK" else "SIMPLE")
    is_named = any("adaptive subdivision of smooth meshes" in line for line in studio.messages(most=99))
    assert is_named == (kind != "SIMPLE" and DICES_OTHERWISE)
    if is_named:
        return
    image, reference = studio.compare(error=6e-4)
    assert not any("adaptive" in line for line in studio.messages(most=99))
    owner.use_adaptive_subdivision = False
    made.update_tag()
    assert rel_mse(studio.render("SHLIGHT"), reference) > 5 * rel_mse(image, reference)


def test_what_is_not_divided_is_named(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A mesh that would have too many triangles, and one that shines."""
    made = hills(studio, displaced(studio, "DISPLACEMENT"), 4)
    subdivided(studio, made)
    studio.scene.cycles.preview_dicing_rate = 1.0
    monkeypatch.setattr(dicing, "MOST_TRIANGLES", 1000)
    assert any("'Hills': adaptive subdivision ends at 1000 triangles" in line for line in studio.messages())
    made.data.materials.append(studio.material("ShaderNodeEmission"))
    assert any("'Hills': adaptive subdivision of what shines" in line for line in studio.messages())


@pytest.mark.parametrize("orthographic", [False, True])
def test_the_divided_mesh_is_whole(orthographic: bool) -> None:
    """Each edge within it is of two triangles and no longer than is wanted, and what is linear stays so."""
    vertices = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], dtype=np.float32)
    triangles = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)
    attributes = {"place": 3.0 * vertices[triangles]}
    before = Undisplaced(np.float32([(0, 0, 1)] * 4), np.array([False, True]))
    flat = MeshArrays(vertices, triangles, None, np.array([0, 1], dtype=np.int32), attributes, before)
    view = View(((1, 0, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1.2)), 0.05, (1.0, 1.0), (0.0, 0.0), orthographic)
    fine, text = dicing.diced(flat, Dicing(1.0, True, False, 12, 1.0), np.eye(4), view)
    assert not text
    corners = fine.vertices[fine.triangles].astype(np.float64)
    edges = np.roll(corners, -1, axis=1) - corners
    area = 0.5 * np.cross(edges[:, 0], edges[:, 1])[:, 2]
    assert abs(area.sum() - 4.0) <= 1e-6
    assert (area > 0.0).all()
    assert [area[fine.material_indices == i].sum() for i in (0, 1)] == pytest.approx([2.0, 2.0], abs=1e-6)
    np.testing.assert_array_equal(fine.attributes["place"], 3.0 * fine.vertices[fine.triangles])
    middles = corners + 0.5 * edges
    distance = np.ones(middles.shape[:2]) if orthographic else np.linalg.norm(middles + np.array([0, 1.2, 0]), axis=2)
    length = np.linalg.norm(edges, axis=2) / (0.05 * distance)
    assert length.max() <= dicing.LONGEST
    assert 0.7 <= length.mean() <= 1.1
    ends = np.sort(np.stack([fine.triangles, np.roll(fine.triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, count = np.unique(ends, axis=0, return_counts=True)
    on_rim = np.abs(fine.vertices[unique].sum(axis=1)).max(axis=1) / 2.0 == 1.0
    assert (count[~on_rim] == 2).all()
