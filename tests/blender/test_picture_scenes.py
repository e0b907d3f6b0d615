# SPDX-License-Identifier: MIT
"""The scenes of `shlight bench picture` are the same in shlight and in Cycles."""

from __future__ import annotations

import pytest

from shlight.bench.picture_renderers import Cycles, Shlight
from shlight.bench.picture_scenes import PICTURE_SCENES
from shlight.metrics import rel_mse_without_noise


@pytest.mark.slow
@pytest.mark.parametrize("name", PICTURE_SCENES)
def test_both_render_one_scene(name: str) -> None:
    scene = PICTURE_SCENES[name]()
    ours = Shlight(scene, 64).halves(1.0)[0]
    error = rel_mse_without_noise(ours, *Cycles(scene, 64, denoised=False).halves(2.0))[0]
    assert error <= 5e-3  # noise that is left; another lamp, colour or camera is ten times it
