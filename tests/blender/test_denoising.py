# SPDX-License-Identifier: MIT
"""The Denoise switches of final renders and of viewports."""

from __future__ import annotations

import threading
import time
from typing import Any

import bpy
import numpy as np
import pytest

import shlight
from shlight.metrics import rel_mse
from shlight_blender.export import export_scene, viewport_settings, whole_frame
from shlight_blender.picture_maker import WAITING, Job, PictureMaker

needs_denoiser = pytest.mark.skipif(not shlight.has_denoiser(), reason="this Blender has no Open Image Denoise")


def build(studio: Any) -> None:
    """A floor under bars behind the camera, a wide lamp and the sky, with one ray for a pixel."""
    studio.plane(8, studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.7, 0.7, 0.7)))
    for x in range(-4, 5):
        studio.box((0.2, 6, 0.1), location=(x / 2, 0, 2.5))
    studio.area(300, (1, -1, 4), size=2)
    studio.plain_world((0.3, 0.4, 0.6))
    studio.camera((0, 0.1, 2), (0, 0, 0))
    settings = studio.scene.shlight
    settings.min_samples = settings.max_samples = settings.shadow_rays = 1
    settings.preview_min_samples = settings.preview_max_samples = 1


@needs_denoiser
def test_a_render_is_denoised_where_its_scene_says_so(studio: Any) -> None:
    build(studio)
    noisy = studio.render("SHLIGHT")
    studio.scene.shlight.use_denoising = True
    made = studio.render("SHLIGHT")
    studio.scene.shlight.use_denoising = False
    settings = studio.scene.shlight
    settings.max_samples = settings.min_samples = 64
    reference = studio.render("SHLIGHT")
    assert rel_mse(made, reference) <= 0.4 * rel_mse(noisy, reference)
    assert studio.messages(most=99) == []


def test_a_viewport_waits_for_a_render(studio: Any) -> None:
    """It keeps what it has, and goes on when the render has ended."""
    build(studio)
    scene, frame = export_scene(bpy.context.evaluated_depsgraph_get()).scene, whole_frame(320, 240)
    settings = viewport_settings(studio.scene) | {"noise_threshold": 0.0, "max_samples": 64}
    waits, shown = threading.Event(), list[Any]()

    def redraw() -> None:
        shown.append(maker.picture)
        if len(shown) == 1:
            waits.set()

    def is_shown(status: str) -> bool:
        until = time.monotonic() + 60
        while not (shown and shown[-1].status == status) and time.monotonic() < until:
            time.sleep(0.01)
        return bool(shown[-1].status == status)

    maker = PictureMaker(redraw, waits.is_set)
    maker.start(Job(scene, frame, settings))
    assert is_shown(WAITING)
    count = len(shown)
    time.sleep(0.5)
    assert len(shown) == count
    waits.clear()
    assert is_shown("")
    maker.end()


@needs_denoiser
def test_a_viewport_is_denoised_at_its_end(studio: Any) -> None:
    build(studio)
    scene, frame = export_scene(bpy.context.evaluated_depsgraph_get()).scene, whole_frame(64, 48)
    job = Job(scene, frame, viewport_settings(studio.scene), denoises=True)
    shown: list[Any] = []
    maker = PictureMaker(lambda: shown.append(maker.picture))
    maker.start(job)
    until = time.monotonic() + 30
    while not (shown and shown[-1].status == "") and time.monotonic() < until:
        time.sleep(0.01)
    maker.end()
    before, after = shown[-2:]
    assert (before.status, after.status) == ("Denoising", "")
    reference = shlight.render(scene, 64, 48, **(job.settings | {"min_samples": 64, "max_samples": 64}))[::-1]
    assert rel_mse(after.pixels, reference) <= 0.4 * rel_mse(before.pixels, reference)


def test_a_blender_without_the_denoiser_says_so(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    build(studio)
    monkeypatch.setattr("shlight.denoising._library", lambda: None)
    studio.scene.shlight.use_denoising = True
    assert np.all(np.isfinite(studio.render("SHLIGHT")))
    assert ["Open Image Denoise" in text for text in studio.messages(most=99)] == [True]
