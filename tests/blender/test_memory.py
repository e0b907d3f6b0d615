# SPDX-License-Identifier: MIT
"""Memory of a Blender that works all day."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import pytest

import shlight_blender
from shlight.quiet import quiet

GROWTH = 1.03


@pytest.mark.usefixtures("_addon")
def test_the_addon_can_be_registered_again_and_again(resident: Callable[[], int]) -> None:
    before = 0
    for number in range(105):
        shlight_blender.unregister()
        shlight_blender.register()
        if number == 4:
            before = resident()
    assert resident() <= GROWTH * before


@pytest.mark.slow
def test_an_animation_of_2000_frames(studio: Any, resident: Callable[[], int]) -> None:
    studio.simple_scene()
    scene, box = studio.scene, bpy.data.objects["Box"]
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.shlight.max_bounces = 0
    scene.render.filepath = str(studio.folder / "frame.exr")
    for frame, place in ((1, (0, 0, 0.5)), (2000, (1, 1, 1))):
        box.location = place
        box.keyframe_insert("location", frame=frame)
    before = 0
    for frame in range(1, 2001):
        with quiet():
            scene.frame_set(frame)
            bpy.ops.render.render(write_still=True)
        if frame == 100:
            before = resident()
    print(f"{before / 2**20:.1f} MB after 100 frames, {resident() / 2**20:.1f} MB after 2000")
    assert resident() <= GROWTH * before
