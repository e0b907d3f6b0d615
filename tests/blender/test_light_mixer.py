# SPDX-License-Identifier: MIT
"""The light mixer: mixes of a render against renders of lamps with that power, and what Apply and Reset write."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender import record
from shlight_blender.light_mix import factors_of
from shlight_blender.ui.light_mixer import mix_problem

NOISE = 5e-3  # of renders with 16 camera rays a pixel


@pytest.fixture
def lit(studio: Any) -> Any:
    """A corner lit by two lamps and a world, with light that bounces."""
    studio.plane(6, studio.material(name="Paper", Color=(0.7, 0.6, 0.5)))
    studio.plane(6, bpy.data.materials["Paper"], location=(0, 1.5, 0), rotation_euler=(np.pi / 2, 0, 0))
    studio.lamp("POINT", 60.0, (-1, 0, 2)).name = "Key"
    studio.lamp("POINT", 90.0, (1.5, -1, 1)).name = "Fill"
    studio.world((0.1, 0.2, 0.3))
    studio.camera()
    studio.resolution(24, 18)
    settings = studio.scene.shlight
    settings.max_bounces, settings.noise_threshold, settings.max_samples = 2, 0.0, 16
    bpy.context.view_layer.update()
    settings.use_light_mixer = True
    return studio


def row(name: str) -> Any:
    return bpy.context.scene.shlight.light_mix[name]


def mixed() -> Any:
    """The mix of the latest render, row 0 on top as `render` has it."""
    factors = factors_of(bpy.context.scene)
    assert factors is not None
    assert mix_problem(bpy.context) == ""
    return record.last.mix.picture(factors)[::-1]


def difference(one: Any, other: Any) -> float:
    """Root of the mean square, relative to the mean."""
    return float(np.sqrt(np.mean(np.square(one - other))) / other.mean())


def test_a_mix_is_the_render_of_lamps_with_its_power(lit: Any) -> None:
    assert {each.name for each in lit.scene.shlight.light_mix} == {"Key", "Fill"}
    neutral = lit.render("SHLIGHT")
    np.testing.assert_allclose(mixed(), neutral, atol=1e-6)
    row("Key").power, row("Fill").color = 2.5, (1.0, 0.5, 0.25)
    mix = mixed()
    rendered = lit.render("SHLIGHT")
    assert difference(mix, rendered) <= NOISE
    assert difference(neutral, rendered) >= 20 * NOISE
    row("Key").on = False  # from a render whose factors are other than 1
    assert difference(mixed(), lit.render("SHLIGHT")) <= NOISE
    row("Key").on = True
    assert "lacks light" in mix_problem(bpy.context)


def test_rows_follow_the_lamps(lit: Any) -> None:
    lit.lamp("POINT", 10.0, (0, 0, 3)).name = "Rim"
    bpy.data.objects.remove(bpy.data.objects["Fill"])
    bpy.context.view_layer.update()
    assert {each.name for each in lit.scene.shlight.light_mix} == {"Key", "Rim"}


def test_apply_writes_what_is_seen_and_reset_takes_it_back(lit: Any) -> None:
    row("Key").power, row("Fill").on = 0.5, False
    before = lit.render("SHLIGHT")
    assert bpy.ops.shlight.apply_light_mix() == {"FINISHED"}
    assert bpy.data.objects["Key"].data.energy == pytest.approx(30.0)
    assert bpy.data.objects["Fill"].hide_render
    assert factors_of(lit.scene) == {}
    np.testing.assert_allclose(mixed(), before, rtol=1e-4, atol=1e-4)
    np.testing.assert_allclose(lit.render("SHLIGHT"), before, rtol=1e-5, atol=1e-5)
    row("Key").power = 3.0
    assert bpy.ops.shlight.reset_light_mix() == {"FINISHED"}
    assert row("Key").power == 1.0


def test_an_undo_keeps_the_mix_unless_it_may_take_back_what_apply_wrote(lit: Any) -> None:
    def undo() -> None:
        for handler in bpy.app.handlers.undo_post:
            handler(lit.scene, None)

    row("Key").power = 0.5
    before = lit.render("SHLIGHT")
    undo()
    np.testing.assert_allclose(mixed(), before, atol=1e-6)
    assert bpy.ops.shlight.apply_light_mix() == {"FINISHED"}
    undo()
    assert "can be mixed" in mix_problem(bpy.context)


def test_nothing_is_applied_to_lamps_that_cannot_have_it(lit: Any) -> None:
    bpy.data.objects["Fill"].data.keyframe_insert("energy", frame=1)
    row("Key").power = row("Fill").power = 2.0
    with pytest.raises(RuntimeError, match="Light 'Fill' has power or colour that may be animated"):
        bpy.ops.shlight.apply_light_mix()
    assert bpy.data.objects["Key"].data.energy == 60.0
    bpy.data.objects["Fill"].data.animation_data_clear()
    bpy.data.objects["Fill"].data = bpy.data.objects["Key"].data
    row("Fill").power = 3.0
    with pytest.raises(RuntimeError, match="shares its data with 'Fill'"):
        bpy.ops.shlight.apply_light_mix()
    assert row("Key").power == 2.0
