# SPDX-License-Identifier: MIT
"""The balls of examples/glossy_balls.py, each under each lamp, with and without shadows, against Cycles."""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from contextlib import nullcontext
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from shlight.metrics import mean_ratio, reference_rel_mse, rel_mse
from shlight_blender.compare.render import without_shadows

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "glossy_balls.py"
SIDE = 40  # pixels of a picture, which one ball fills
LENS = 270.0  # focal length [mm] that makes it do so
SAMPLES = {0.1: 256}  # of each half of the reference, where it takes more than 128
QUICK = {
    (0.1, "small", True),
    (0.2, "quad", True),
    (0.3, "quad", False),
    (0.3, "sphere", True),
    (0.5, "sphere", False),
    (0.8, "small", False),
}


def look_at_ball(studio: Any, roughness: float, light: str) -> None:
    """The example under one lamp, its camera moved in front of one ball."""
    runpy.run_path(str(EXAMPLE))["build_scene"]()
    studio.prepare()
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = SIDE
    studio.scene.cycles.samples = SAMPLES.get(roughness, 128)
    for seen in studio.scene.objects:
        if seen.type == "LIGHT":
            seen.hide_render = seen.name != light
    ball, camera = studio.scene.objects[f"ball {roughness}"], studio.scene.camera
    camera.location.x, camera.data.lens = ball.location.x, LENS


def cases() -> Iterator[Any]:
    """Roughness, lamp and shadows; those beside the quick ones are for `./dev test --all`."""
    for roughness, light, shadowed in product((0.1, 0.2, 0.3, 0.5, 0.8), ("sphere", "quad", "small"), (True, False)):
        marks = [] if (roughness, light, shadowed) in QUICK else [pytest.mark.slow]
        name = f"{roughness}-{light}-{'shadowed' if shadowed else 'unshadowed'}"
        yield pytest.param(roughness, light, shadowed, marks=marks, id=name)


@pytest.mark.parametrize(("roughness", "light", "shadowed"), list(cases()))
def test_ball(studio: Any, roughness: float, light: str, shadowed: bool) -> None:
    look_at_ball(studio, roughness, light)
    studio.scene.shlight.use_shadows = shadowed
    image = studio.render("SHLIGHT")
    with nullcontext() if shadowed else without_shadows():
        halves = [studio.render("CYCLES", seed) for seed in (1, 2)]
    reference = (halves[0] + halves[1]) / 2
    noise, error = reference_rel_mse(*halves), rel_mse(image, reference)
    print(f"relMSE {error:.2e}, of it the reference's noise {noise:.1e}, mean ratio {mean_ratio(image, reference):.4f}")
    assert noise <= 2e-4
    assert error <= 1e-3
