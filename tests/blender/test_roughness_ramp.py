# SPDX-License-Identifier: MIT
"""The strip of examples/roughness_ramp.py: no seam where one way of computing a reflection hands over to another."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "roughness_ramp.py"
HEIGHT, STEP = 84, 6  # pixels of the picture and of a step's width
EVEN = 0.05  # from this roughness on steps grow by the same factor
DARK = 0.02  # of a step's brightest pixel: what is darker counts as this


def step_columns(studio: Any) -> tuple[Array, Array]:
    """Roughness (n) and brightness (rows, n) of the steps, without their borders."""
    names = runpy.run_path(str(EXAMPLE))
    names["build_scene"]()
    studio.prepare()
    roughnesses = np.array(names["ROUGHNESSES"])
    render = studio.scene.render
    render.resolution_x, render.resolution_y = STEP * len(roughnesses), HEIGHT
    studio.scene.shlight.use_shadows = False
    image = studio.render("SHLIGHT")[..., :3].mean(axis=-1, dtype=np.float64)
    return roughnesses, image.reshape(HEIGHT, -1, STEP)[:, :, 1:-1].mean(axis=-1)


def bends(values: Array) -> Array:
    """How far each value of the last axis, but the outermost, is from the mean of its neighbours."""
    return values[..., 1:-1] - 0.5 * (values[..., :-2] + values[..., 2:])


@pytest.mark.slow
def test_no_step_of_the_ramp_stands_out(studio: Any) -> None:
    """A reflection bends slowly along even steps: what a step's neighbours do not share is a seam.

    Down to the mirror, whose image is sharp, only the sum over a column of pixels changes slowly.
    """
    roughnesses, steps = step_columns(studio)
    jumps = np.abs(bends(np.log(steps.sum(axis=0))))
    print(f"largest jump of a step's light {jumps.max():.4f} at roughness {roughnesses[np.argmax(jumps) + 1]:.4f}")

    even = roughnesses >= EVEN - 1e-9
    roughnesses, steps = roughnesses[even], steps[:, even]
    seams = np.abs(bends(bends(np.log(steps + DARK * steps.max(axis=0)))))
    row, step = np.unravel_index(np.argmax(seams), seams.shape)
    print(f"largest seam {seams.max():.4f} in row {row} at roughness {roughnesses[step + 2]:.3f}")
    assert jumps.max() <= 5e-3
    assert seams.max() <= 0.01
