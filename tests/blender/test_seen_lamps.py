# SPDX-License-Identifier: MIT
"""Lamps that the camera looks at: their radiance is in the picture, as in Cycles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

SLOW = pytest.mark.slow
# Lamps at the origin of the view; area lamps look at the camera.
LAMPS: dict[str, dict[str, Any]] = {
    "sphere": {"kind": "POINT", "energy": 40, "shadow_soft_size": 0.5, "use_soft_falloff": False},
    "disk": {"kind": "POINT", "energy": 40, "shadow_soft_size": 0.5, "use_soft_falloff": True},
    "spot": {
        "kind": "SPOT", "energy": 200, "shadow_soft_size": 0.5, "spot_size": 0.8, "spot_blend": 1.0,
        "use_soft_falloff": False, "rotation_euler": (-1.45, 0, 0.1),
    },
    "rectangle": {"kind": "AREA", "energy": 60, "shape": "RECTANGLE", "size": 1.4, "size_y": 0.6},
    "turned_away": {
        "kind": "AREA", "energy": 60, "shape": "RECTANGLE", "size": 1.4, "size_y": 0.6, "rotation_euler": (0.9, 0, 0),
    },
    "spread": {"kind": "AREA", "energy": 60, "shape": "SQUARE", "size": 1.2, "spread": 1.4},
    "mirrored": {"kind": "AREA", "energy": 60, "shape": "SQUARE", "size": 0.8, "scale": (-1.5, 0.7, 1)},
    "sun": {"kind": "SUN", "energy": 3, "angle": 0.3, "rotation_euler": (-1.4, 0, 0.1)},
    "small": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.0},
}  # fmt: skip


def set_up(studio: Any, lamp: str) -> Any:
    """A floor, a post before the lamp and a wall that runs through it."""
    material = studio.material(Color=(0.8, 0.6, 0.4))
    studio.plane(6.0, material, location=(0, 0, -0.6))
    studio.box((0.15, 0.15, 2.0), material, location=(-0.2, -1.2, 0))
    studio.camera(location=(0, -4, 0.2), target=(0, 0, 0.1))
    values: dict[str, Any] = {"rotation_euler": (0.2 - math.pi / 2, 0, 0.3), "visible_camera": True, **LAMPS[lamp]}
    made = studio.lamp(values.pop("kind"), values.pop("energy"), (0, 0, 0.2), **values)
    studio.resolution(48, 48)
    # Edges of lamps are as bright as they are.
    studio.scene.shlight.pixel_samples = 64
    studio.scene.cycles.samples = 400
    return made


def interior(reference: Any) -> Any:
    """Pixels that hardly differ from their neighbours: those that no edge crosses."""
    shifts = [np.roll(reference, (y, x), axis=(0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1)]
    return (np.ptp(np.stack(shifts), axis=0) < 0.2 * reference + 1e-2).all(axis=-1)


@pytest.mark.parametrize(
    "lamp", [name if name in {"sphere", "spread"} else pytest.param(name, marks=SLOW) for name in LAMPS]
)
def test_lamp(studio: Any, lamp: str) -> None:
    set_up(studio, lamp)
    image, reference = studio.compare(mean=2e-3, error=2e-3)
    assert studio.messages() == []
    assert np.abs(image[..., 3] - reference[..., 3]).mean() < 2e-3
    if lamp not in {"turned_away", "small"}:
        bright = interior(reference[..., :3]) & (reference[..., 0] > 0.25 * reference[..., 0].max())
        assert bright.sum() > 50, "the lamp is not in the picture"
        np.testing.assert_allclose(image[bright], reference[bright], rtol=1e-2)


def test_hidden_from_the_camera(studio: Any) -> None:
    set_up(studio, "rectangle").visible_camera = False
    image, _ = studio.compare(mean=3e-3, error=3e-3)
    assert image[..., :3].max() < 10.0


@pytest.mark.parametrize("lamp", ["disk", "sun"])
def test_over_a_transparent_film(studio: Any, lamp: str) -> None:
    """Lamps cover nothing: alpha stays what it is without them."""
    set_up(studio, lamp)
    studio.scene.render.film_transparent = True
    image, reference = studio.compare(mean=2e-3, error=2e-3)
    assert np.abs(image[..., 3] - reference[..., 3]).mean() < 2e-3


@pytest.mark.parametrize("clip", [0.1, pytest.param(3.5, marks=SLOW), pytest.param(4.2, marks=SLOW)])
def test_orthographic_camera_and_clipping(studio: Any, clip: float) -> None:
    set_up(studio, "disk")
    lens = studio.scene.camera.data
    lens.type, lens.ortho_scale, lens.clip_start = "ORTHO", 3.0, clip
    studio.scene.cycles.samples, studio.scene.shlight.pixel_samples = 2048, 64  # edges of the cut disk are noisy
    studio.compare(mean=2e-3, error=2e-3)


def test_lamps_behind_each_other_add_up(studio: Any) -> None:
    set_up(studio, "sphere")
    values = dict(LAMPS["rectangle"])
    studio.lamp(
        values.pop("kind"), values.pop("energy"), (0.2, 1.0, 0.2), rotation_euler=(-1.4, 0, 0), visible_camera=True,
        **values,
    )  # fmt: skip
    studio.compare(mean=2e-3, error=2e-3)


def test_camera_inside_a_sphere(studio: Any) -> None:
    set_up(studio, "sphere").data.shadow_soft_size = 6.0
    studio.compare(mean=2e-3, error=2e-3)
