# SPDX-License-Identifier: MIT
"""Light that bounces against Cycles at the same depths."""

from __future__ import annotations

from typing import Any

import pytest

from shlight_blender.comparison.scene import use_cycles


def compare(studio: Any, samples: int = 512, **bounds: float) -> None:
    """Both pictures with bounces as the scene's settings have them."""
    use_cycles(studio.scene, samples, 0)
    studio.compare(**bounds)


@pytest.mark.parametrize(("glossy", "transmission"), [(4, 12), (1, 1), (0, 2)])
def test_depths_of_gloss_and_glass_are_those_of_cycles(studio: Any, glossy: int, transmission: int) -> None:
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(0.9, 1, 0.9), Roughness=0.0, IOR=1.4)
    mirror = studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Color=(0.9, 0.8, 0.7), Roughness=0.2)
    studio.plane(8, white)
    studio.box((1, 1, 1), glass, "Pane", location=(0.8, -1, 0.6))
    for side in (-1, 1):
        studio.box((0.1, 3, 2), mirror, "Mirror", location=(1.7 * side, 0.5, 1))
    studio.plain_world((0.4, 0.5, 0.6))
    studio.camera()
    settings = studio.scene.shlight
    settings.max_bounces, settings.glossy_bounces, settings.transmission_bounces = 4, glossy, transmission
    compare(studio)
