# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur of final renders, beside Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from test_displacement import displaced, hills

from shlight.metrics import rel_mse
from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of
from shlight_blender.compat import position_owner
from shlight_blender.export import meshes
from shlight_blender.export.displacement import displace
from shlight_blender.motion_blur import MeanPicture, times_of

SLOW = pytest.mark.slow


def animate(owner: Any, path: str, start: Any, end: Any) -> None:
    """Moves a property evenly from frame 4 to frame 6."""
    kind = bpy.context.preferences.edit.keyframe_new_interpolation_type
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    for frame, value in ((4, start), (6, end)):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    bpy.context.preferences.edit.keyframe_new_interpolation_type = kind


def stage(studio: Any, moving: str) -> dict[str, Any]:
    """A box and a ball on a floor; something moves by some 10 % of the picture's width."""
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    red = studio.material("ShaderNodeBsdfDiffuse", "Red", Color=(0.8, 0.2, 0.1))
    studio.plane(8, white)
    made = {
        "box": studio.box((1, 1, 1), red, location=(-1, 0, 0.5)),
        "ball": studio.ball(0.5, white, location=(1.3, 0.3, 0.5)),
        "lamp": studio.area(200, (1.5, -1, 3), size=0.6),
        "camera": studio.camera((0, -7, 4), (0, 0, 0.4)),
    }
    if moving == "deformation":
        made["box"].shape_key_add(name="Basis")
        key = made["box"].shape_key_add(name="Sheared")
        for point in key.data:
            point.co.x += 1.8 * (point.co.z > 0)
        animate(key, "value", 0.0, 1.0)
    elif moving:
        made[moving].cycles.motion_steps = 5  # Cycles goes straight between them
        place = np.array(made[moving].location)
        animate(made[moving], "location", place - np.array([0.9, 0, 0]), place + np.array([0.9, 0, 0]))
    studio.plain_world((0.1, 0.12, 0.15))
    scene = studio.scene
    scene.frame_set(5)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    use_cycles(scene, 512, 0, bounces_of(scene))
    return made


@pytest.mark.parametrize(
    "moving", ["box", *(pytest.param(name, marks=SLOW) for name in ("deformation", "camera", "lamp"))]
)
def test_what_moves_is_blurred_as_in_cycles(studio: Any, moving: str) -> None:
    """Lamps are not."""
    stage(studio, moving)
    studio.scene.shlight.motion_times = 16
    image, reference = studio.compare(mean=2e-3, error=1e-3)
    assert studio.scene.frame_current_final == 5.0
    assert studio.messages(most=99) == []
    studio.scene.render.use_motion_blur = False
    sharp = rel_mse(studio.render("SHLIGHT"), reference)
    assert (sharp > 5 * rel_mse(image, reference)) == (moving != "lamp")


def test_what_moves_is_displaced_once(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its vertices are moved as at the picture's own time, as in Cycles."""
    made = hills(studio, displaced(studio, "DISPLACEMENT", space="WORLD"), 4)
    animate(made, "location", (-0.5, 0, 0), (0.5, 0, 0))
    studio.scene.frame_set(5)
    studio.scene.render.use_motion_blur, studio.scene.shlight.motion_times = True, 4
    places = []

    def counted(arrays: Any, displacements: Any, to_world: Any, values: Any) -> Any:
        places.append(to_world[0, 3])
        return displace(arrays, displacements, to_world, values)

    monkeypatch.setattr(meshes, "displace", counted)
    studio.render("SHLIGHT")
    assert places == [0.0]


@pytest.mark.parametrize("position", ["START", pytest.param("END", marks=SLOW)])
def test_the_shutter_opens_when_it_is_told(studio: Any, position: str) -> None:
    """Its curve is open for the first half alone, and an object that has no motion blur of its own stays."""
    made = stage(studio, "box")
    animate(made["ball"], "location", (1.3, 0.3, 0.5), (0.3, 0.3, 0.5))
    made["ball"].cycles.use_motion_blur = False
    studio.scene.frame_set(5)
    position_owner(studio.scene).motion_blur_position = position
    curve = studio.scene.render.motion_blur_shutter_curve
    for point, place in zip(curve.curves[0].points, ((0, 1), (0.5, 1), (1, 0)), strict=True):
        point.location, point.handle_type = place, "VECTOR"
    curve.update()
    studio.scene.shlight.motion_times = 16
    studio.compare(mean=2e-3, error=1e-3)


def test_times_of_an_even_shutter(studio: Any) -> None:
    stage(studio, "")
    scene = studio.scene
    scene.shlight.motion_times = 4
    times = times_of(scene, bpy.context.view_layer)
    np.testing.assert_allclose(times, [-0.375, -0.125, 0.125, 0.375], atol=2e-3)
    bpy.context.view_layer.use_motion_blur = False
    assert times_of(scene, bpy.context.view_layer) == [0.0]


def test_passes_are_means_or_those_of_the_middle() -> None:
    mean = MeanPicture(3)
    for number in range(3):
        picture = np.full((1, 1, 4), float(number), np.float32)
        shown = mean.shown(picture)
        mean.add({"combined": picture, "depth": picture, "normal": picture})
        np.testing.assert_array_equal(shown, mean.layers["combined"])
    assert mean.layers["combined"].mean() == mean.layers["normal"].mean() == 1.0
    assert mean.layers["depth"].mean() == 1.0
    assert mean.progress(lambda share: share == 1.0)(0.0)


def test_a_rolling_shutter_is_named(studio: Any) -> None:
    made = stage(studio, "box")
    studio.scene.cycles.rolling_shutter_type = "TOP"
    made["box"].cycles.use_deform_motion = False
    text = "\n".join(studio.messages(most=99))
    assert "a rolling shutter is not supported" in text
    assert "its deformation is blurred" in text
