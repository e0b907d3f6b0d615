# SPDX-License-Identifier: MIT
"""Shadow catchers beside those of Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from test_passes import rendered

from shlight.metrics import mean_ratio, rel_mse
from shlight_blender import record
from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of

SLOW = pytest.mark.slow


def stage(studio: Any, bounces: int, film_transparent: bool, has_lantern: bool = True) -> None:
    """A ball and a post on a floor that catches shadows, with a lamp and a world of different colours."""
    white = studio.material(Color=(0.8, 0.8, 0.8))
    glow = studio.material("ShaderNodeEmission", "Glow", Color=(0.2, 1, 0.2), Strength=1.0)
    studio.plane(6, white, "Floor", is_shadow_catcher=True)
    studio.ball(0.7, studio.material(Color=(0.9, 0.1, 0.1)), location=(0, 0, 0.7), rings=32)
    studio.box((0.5, 0.5, 1.5), white, "Post", location=(-1.2, 0.5, 0.75))
    if has_lantern:  # in Cycles it makes noise
        studio.box((0.4, 0.4, 0.4), glow, "Lantern", location=(1.4, -0.4, 0.3))
    studio.area(150, (1.5, -1, 3), size=1.0).data.color = (1, 0.5, 0.3)
    studio.plain_world((0.1, 0.2, 0.4))
    studio.camera((1.5, -7, 2.5), (0, 1.5, 0.6))
    studio.scene.shlight.max_bounces = bounces
    studio.scene.shlight.noise_threshold = 0.002
    studio.scene.render.film_transparent = film_transparent
    use_cycles(studio.scene, 1024, 0, bounces_of(studio.scene))


@pytest.mark.parametrize(
    ("bounces", "film_transparent", "error"),
    # Before an opaque film Cycles makes objects' edges on catchers darker, and light that bounces is its noise.
    [(0, True, 1e-3), pytest.param(0, False, 5e-3, marks=SLOW), pytest.param(3, True, 6e-3, marks=SLOW)],
)
def test_catchers_show_how_much_light_is_left(studio: Any, bounces: int, film_transparent: bool, error: float) -> None:
    stage(studio, bounces, film_transparent, has_lantern=error > 1e-3)
    if film_transparent:
        pane = studio.material("ShaderNodeBsdfTransparent", "Pane", Color=(0.9, 0.6, 0.4))
        studio.plane(1.0, pane, "Pane", location=(-0.9, -1.2, 0.3), rotation_euler=(1.4, 0, 0))
    image, reference = studio.compare(mean=5e-3, error=error)
    alpha, expected = (np.repeat(own[..., 3:], 3, axis=-1) for own in (image, reference))
    assert abs(mean_ratio(alpha, expected) - 1.0) <= 5e-3
    assert rel_mse(alpha, expected) <= error
    assert record.last.report.lines() == []


def test_passes_of_catchers(studio: Any) -> None:
    """Catchers that have a pass of their own are not in the picture, nor in passes of light; data have them."""
    stage(studio, 0, True)
    studio.scene.cycles.samples = 256
    view_layer = bpy.context.view_layer
    view_layer.cycles.use_pass_shadow_catcher = True
    view_layer.use_pass_normal = view_layer.use_pass_diffuse_direct = view_layer.use_pass_emit = True
    if hasattr(studio.scene.render.image_settings, "media_type"):
        studio.scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    studio.scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    (own, _), (reference, _) = (rendered(studio, engine) for engine in ("SHLIGHT", "CYCLES"))
    assert own.keys() == reference.keys()
    for name, expected in reference.items():
        tolerance = 0.03 * np.abs(expected).max()
        assert np.sqrt(np.mean((own[name] - expected) ** 2)) <= tolerance, name
