# SPDX-License-Identifier: MIT
"""Where a picture is smooth, shlight and Cycles differ by Cycles' own noise."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.metrics import standard_error


def smooth_pixels(image: NDArray[np.float32], reach: int = 1, contrast: float = 0.06) -> NDArray[np.bool_]:
    """Lit pixels with no edge and no penumbra within `reach` pixels."""
    brightness = image[..., :3].mean(axis=-1)
    shifts = [(y, x) for y in range(-reach, reach + 1) for x in range(-reach, reach + 1)]
    change = np.max([np.abs(np.roll(brightness, shift, axis=(0, 1)) - brightness) for shift in shifts], axis=0)
    return (change < contrast * brightness) & (brightness > 1e-3)


def test_smooth_surfaces_lie_within_three_standard_errors(studio: Any) -> None:
    studio.still_life()
    studio.camera()
    studio.resolution(96, 72)
    cycles = studio.scene.cycles
    image = studio.render("SHLIGHT")
    cycles.samples = 64
    halves = [studio.render("CYCLES", seed) for seed in (1, 2)]
    reference = (halves[0] + halves[1]) / 2
    smooth = smooth_pixels(image)[..., None] & (reference[..., :3] > 1e-3)
    assert smooth.sum() > 1000
    difference = (image - reference)[..., :3]
    within = np.abs(difference) <= 3 * standard_error(*halves)
    # 99.7 % of a normal distribution; the error is itself an estimate from 25 pixels and two halves.
    assert within[smooth].mean() >= 0.97
    # Hits of a pixel share an evaluation where they agree within a fraction of 1e-3: half of that is left to it.
    assert abs(difference[smooth].sum() / reference[..., :3][smooth].sum()) <= 5e-4
