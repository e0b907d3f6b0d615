# SPDX-License-Identifier: MIT
"""The report's tick is true: a picture without a remark is that of Cycles at the same depths."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import pytest
from test_strands import hairy
from test_volumes import body

from shlight.metrics import mean_ratio, rel_mse_without_noise
from shlight_blender import record
from shlight_blender.background import use_cycles
from shlight_blender.compare.render import bounces_of
from shlight_blender.report import Effect

CORNELL = Path(__file__).resolve().parents[3] / "shared/scenes/cornell_box.blend"


def chrome_and_glass(studio: Any) -> None:
    studio.plane(8, studio.material(Color=(0.7, 0.6, 0.5)))
    chrome = studio.material("ShaderNodeBsdfPrincipled", "Chrome", Metallic=1.0, Roughness=0.0)
    studio.ball(0.7, chrome, location=(-0.9, 0, 0.7))
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Roughness=0.0, IOR=1.45)
    studio.ball(0.7, glass, location=(0.9, 0, 0.7))
    studio.area(150, (1.5, -1, 3), size=1.5)
    studio.plain_world((0.3, 0.4, 0.5))
    studio.camera()


def cornell_box(studio: Any) -> None:
    if not CORNELL.is_file():
        pytest.skip("the shared scenes are not here")
    bpy.ops.wm.open_mainfile(filepath=str(CORNELL))
    studio.prepare()


def negative_world(studio: Any) -> None:
    studio.plane(8, studio.material())
    studio.ball(0.7, studio.material("ShaderNodeBsdfPrincipled", "Paint"), location=(0, 0, 0.7))
    studio.area(150, (1.5, -1, 3), size=1.0)
    studio.world((0.2, 0.3, 0.4))
    studio.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = -3.0
    studio.camera()


def volume(kind: str) -> Callable[[Any], None]:
    def build(studio: Any) -> None:
        studio.plane(8, studio.material())
        studio.box((1.4, 1.4, 1.2), body(studio, None, f"ShaderNodeVolume{kind}", Density=1.5), location=(0, 0, 0.7))
        studio.area(150, (1.5, -1, 3), size=1.0)
        studio.camera()

    return build


SCENES: dict[str, Callable[[Any], Any]] = {
    "chrome and glass": chrome_and_glass,
    "Cornell box": cornell_box,
    "negative world": negative_world,
    "hair": hairy,
    "absorption": volume("Absorption"),
    "scattering": volume("Scatter"),
}


@pytest.mark.slow
@pytest.mark.parametrize("bounces", [0, 4])
@pytest.mark.parametrize("name", SCENES)
def test_a_picture_without_remarks_is_that_of_cycles(studio: Any, name: str, bounces: int) -> None:
    SCENES[name](studio)
    studio.scene.shlight.max_bounces = bounces
    studio.resolution(48, 36)
    use_cycles(studio.scene, 1024, 0, bounces_of(studio.scene))
    image, *halves = studio.render("SHLIGHT"), studio.render("CYCLES", seed=1), studio.render("CYCLES", seed=2)
    remarks = [message.text for message in record.last.report if message.effect < Effect.SLIGHT]
    error, noise = rel_mse_without_noise(image, *halves)
    mean = mean_ratio(image, (halves[0] + halves[1]) / 2)
    print(f"{name}, {bounces} bounces: relMSE {error:.1e} ± {noise:.1e}, mean {mean:.4f}, {remarks}")
    assert remarks or (error <= 1e-2 + 2 * noise and abs(mean - 1.0) <= 1e-2)
