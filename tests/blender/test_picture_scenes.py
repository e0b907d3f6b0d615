# SPDX-License-Identifier: MIT
"""The scenes of `./dev bench picture` are the same in shlight and in Cycles."""

from __future__ import annotations

from dataclasses import replace

import pytest

from shlight.metrics import rel_mse_without_noise
from shlight_tools.bench.picture import SCENES
from shlight_tools.bench.picture_renderers import Cycles, Image, Shlight


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_both_render_one_scene(name: str) -> None:
    scene = replace(SCENES[name](), max_bounces=0)
    ours = Shlight(scene, 64).halves(2.0)[0]
    pictures = (_coarse(image) for image in (ours, *Cycles(scene, 64, denoised=False).halves(2.0)))
    assert rel_mse_without_noise(*pictures)[0] <= 2e-3  # another lamp, colour or camera is ten times it


def _coarse(image: Image) -> Image:
    """Means over 8 × 8 pixels, which have a tenth of the noise."""
    return image.reshape(8, 8, 8, 8, -1).mean(axis=(1, 3))
