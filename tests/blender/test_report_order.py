# SPDX-License-Identifier: MIT
"""The order of the report: what can change more of the picture first, within a class of messages."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender.export import scene as export
from shlight_blender.frame import frame_of
from shlight_blender.report import ExportReport


def shares(studio: Any) -> dict[str, float]:
    """The shares of the picture of all things that the report may name."""
    found: list[dict[str, float]] = []
    original = export.shares_of_picture

    def kept(*arguments: Any) -> dict[str, float]:
        names = {f"Object '{each.name}'" for each in studio.scene.objects}
        found.append(original(*arguments[:3], names | {f"Material '{each.name}'" for each in bpy.data.materials}))
        return found[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "shares_of_picture", kept)
        patch.setattr(ExportReport, "__len__", lambda _: 2)
        export.export_scene(bpy.context.evaluated_depsgraph_get(), frame=frame_of(studio.scene.render))
    return found[0]


@pytest.mark.parametrize("lens", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("border", [False, True])
def test_share_of_a_square_is_that_of_the_pixels_it_covers(studio: Any, lens: str, border: bool) -> None:
    """A square that faces a shifted camera and reaches over the picture's edge."""
    studio.plane(1.6, studio.material(), location=(0.9, 0.4, 0.0))
    studio.area()
    studio.camera((0, 0, 4), (0, 0, 0), type=lens, shift_x=0.1, shift_y=-0.05, ortho_scale=3.0)
    render = studio.scene.render
    render.film_transparent = True
    render.use_border = render.use_crop_to_border = border
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.5, 1.0, 0.25, 0.75
    covered = studio.render("SHLIGHT")[..., 3].mean()
    assert 0.1 < covered < 0.9
    share = shares(studio)
    assert share["Object 'Plane'"] == share["Material 'Material'"]
    assert abs(share["Object 'Plane'"] - covered) <= 5e-3


def test_shares_of_what_is_around_and_behind_the_camera(studio: Any) -> None:
    for name, location in (("Around", (0, 0, 4)), ("Behind", (0, 0, 9)), ("Lost", (np.nan, 0, 0))):
        studio.box(material=studio.material(name=name), name=name, location=location)
    studio.area()
    studio.camera((0, 0, 4), (0, 0, 0))
    found = shares(studio)
    assert [found[f"Object '{name}'"] for name in ("Around", "Behind", "Lost")] == [1.0, 0.0, 1.0]


@pytest.mark.parametrize("first_is_large", [True, False])
def test_what_can_change_more_is_named_first(studio: Any, first_is_large: bool) -> None:
    """Materials by what they cover, and lamps by their power; what lights everything comes first."""
    small, large = {"scale": (0.1, 0.1, 0.1)}, {"scale": (1.0, 1.0, 1.0)}
    first, second = (large, small) if first_is_large else (small, large)
    studio.box(name="A", location=(-1, 0, 0), **first).data.vertices[0].co.x = np.nan
    for name, size, kind in (("C", first, "BsdfHairPrincipled"), ("D", second, "BsdfHair")):
        made = studio.material(f"ShaderNode{kind}", name=name)
        studio.box(material=made, location=(0, 1, 0), **size)
    studio.lamp("SPOT", -1.0 if first_is_large else -100.0, (0, 0, 3))
    studio.area(100.0 if first_is_large else 1.0, scale=(0, 0, 0))
    studio.lamp("SUN", 1.0, (0, 0, 3), rotation_euler=(0.1, 0, 0))
    studio.camera()
    places = [line.partition(": ")[0].partition(",")[0] for line in studio.messages()]
    in_order = [
        ["Light 'Area'", "Light 'Spot'", "Object 'A'", "Material 'C'", "Material 'D'"],
        ["Light 'Spot'", "Light 'Area'", "Object 'A'", "Material 'D'", "Material 'C'"],
    ]
    assert places == in_order[not first_is_large]
