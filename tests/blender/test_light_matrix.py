# SPDX-License-Identifier: MIT
"""Every type of lamp over a diffuse and a glossy scene: shlight and Cycles differ by Cycles' noise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

SEEDS = (1, 2, 3, 4)
# Properties of lamp and object; `at` is the place, lamps look down unless they are turned.
LAMPS: dict[str, dict[str, Any]] = {
    "point": {
        "kind": "POINT", "energy": 60, "shadow_soft_size": 0.4, "use_soft_falloff": False, "color": (1.0, 0.7, 0.4),
        "scale": (2.0, 0.5, 1.5),
    },
    "point_disk": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.4, "use_soft_falloff": True},
    "point_small": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.0},
    "point_unnormalized": {"kind": "POINT", "energy": 20, "shadow_soft_size": 0.4, "normalize": False},
    "point_small_unnormalized": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.0, "normalize": False},
    "spot": {"kind": "SPOT", "energy": 200, "shadow_soft_size": 0.3, "spot_size": 1.0, "spot_blend": 0.5},
    "spot_sphere": {
        "kind": "SPOT", "energy": 200, "shadow_soft_size": 0.3, "spot_size": 0.8, "spot_blend": 1.0,
        "use_soft_falloff": False,
    },
    "spot_small": {"kind": "SPOT", "energy": 200, "shadow_soft_size": 0.0, "spot_size": 0.9, "spot_blend": 0.3},
    "spot_unnormalized": {
        "kind": "SPOT", "energy": 200, "shadow_soft_size": 0.3, "spot_size": 1.0, "spot_blend": 0.5,
        "normalize": False,
    },
    "sun": {"kind": "SUN", "energy": 3, "angle": 0.1, "rotation_euler": (0.4, 0.5, 0)},
    "sun_wide": {"kind": "SUN", "energy": 3, "angle": 1.5, "rotation_euler": (0.9, 0.5, 0)},
    "sun_small": {"kind": "SUN", "energy": 3, "angle": 0.0, "rotation_euler": (0.4, 0.5, 0)},
    "sun_unnormalized": {
        "kind": "SUN", "energy": 30, "angle": 0.3, "rotation_euler": (0.4, 0.5, 0), "normalize": False,
    },
    "square": {"kind": "AREA", "energy": 60, "shape": "SQUARE", "size": 0.8},
    "rectangle": {"kind": "AREA", "energy": 60, "shape": "RECTANGLE", "size": 1.4, "size_y": 0.5},
    "spread": {"kind": "AREA", "energy": 60, "shape": "RECTANGLE", "size": 1.4, "size_y": 0.5, "spread": math.pi / 3},
    "spread_narrow": {"kind": "AREA", "energy": 20, "shape": "SQUARE", "size": 1.5, "spread": 0.2},
    "spread_tilted": {
        "kind": "AREA", "energy": 60, "shape": "SQUARE", "size": 0.8, "spread": 2.0,
        "rotation_euler": (0.5, 0.4, 0.3), "scale": (1.5, -0.6, 2.0),
    },
    "disk": {"kind": "AREA", "energy": 60, "shape": "DISK", "size": 1.1},
    "disk_close": {"kind": "AREA", "energy": 60, "shape": "DISK", "size": 2.5, "rotation_euler": (0.3, 0.2, 0)},
    "disk_spread": {"kind": "AREA", "energy": 60, "shape": "DISK", "size": 1.2, "spread": math.pi / 3},
    "ellipse": {
        "kind": "AREA", "energy": 60, "shape": "ELLIPSE", "size": 1.4, "size_y": 0.5, "rotation_euler": (0.4, 0.3, 0.7),
    },
    "ellipse_mirrored": {
        "kind": "AREA", "energy": 60, "shape": "ELLIPSE", "size": 1.0, "size_y": 0.8,
        "rotation_euler": (0.5, 0.4, 0.3), "scale": (1.5, -0.6, 2.0),
    },
    "no_shadow": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.3, "use_shadow": False},
    "not_diffuse": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.4, "visible_diffuse": False},
    "not_glossy": {"kind": "POINT", "energy": 60, "shadow_soft_size": 0.4, "visible_glossy": False},
}  # fmt: skip
QUICK = {
    "diffuse": {
        "point", "point_small", "spot_small", "sun", "spread", "disk", "ellipse",
    },
    "glossy": {"point_disk", "spot", "sun_small", "square"},
}  # fmt: skip


def set_up(studio: Any, lamp: str, glossy: bool) -> None:
    """A plane, a ball on it and a tilted card, one lamp above."""
    shader = {"shader": "ShaderNodeBsdfAnisotropic", "Roughness": 0.5} if glossy else {}
    material = studio.material(**shader, Color=(0.8, 0.6, 0.4), **({"distribution": "GGX"} if glossy else {}))
    studio.plane(6.0, material)
    studio.ball(0.45, material, location=(-0.7, 0.2, 0.45))
    studio.box((0.7, 0.05, 0.9), material, location=(0.7, 0.5, 0.5), rotation_euler=(0.5, 0.2, 0.3))
    values = dict(LAMPS[lamp])
    made = studio.lamp(values.pop("kind"), values.pop("energy"), (0.3, -0.4, 1.7), **values)
    made.visible_camera = False
    studio.camera(location=(2.0, -4.0, 3.0))
    studio.resolution(40, 40)
    studio.scene.cycles.samples = 128
    studio.scene.shlight.pixel_samples = 32
    studio.scene.shlight.tolerance = 1e-4  # below the noise of the reference


@pytest.mark.parametrize(
    ("lamp", "material"),
    [
        pytest.param(lamp, material, marks=() if lamp in quick else pytest.mark.slow)
        for material, quick in QUICK.items()
        for lamp in LAMPS
    ],
)
def test_lamp(studio: Any, lamp: str, material: str) -> None:
    set_up(studio, lamp, material == "glossy")
    assert studio.messages() == []
    image = studio.render("SHLIGHT")[..., :3].astype(float)
    pictures = np.stack([studio.render("CYCLES", seed)[..., :3] for seed in SEEDS]).astype(float)
    reference = pictures.mean(axis=0)
    if (lamp, material) in {("not_diffuse", "diffuse"), ("not_glossy", "glossy")}:
        assert not image.any()
        assert not reference.any()
        return
    ratio = image.mean() / reference.mean()
    # Pixels with an edge differ by the way it is sampled: the error of those around the mean is robust.
    error = pictures.std(axis=0, ddof=1) / math.sqrt(len(SEEDS))
    lit = reference > 1e-3 * reference.max()
    # Four pictures tell a pixel's error badly, their neighbours' with it well; nothing is known better than float32.
    error = np.maximum(np.sqrt(smoothed(error**2)), 5e-4 * reference)
    z = (image - reference)[lit] / error[lit]
    within = (np.abs(z) <= 3).mean()
    print(f"{lamp:26s} {material:8s} mean {100 * (ratio - 1):+.3f} %, z rms {np.sqrt(np.median(z**2)) / 0.6745:.2f}, "
          f"mean {z.mean():+.2f}, within 3: {100 * within:.1f} %")  # fmt: skip
    assert abs(ratio - 1) <= 3e-3
    assert within >= 0.93  # the rest: edges, where Cycles' filter and shlight's even rays differ


def smoothed(values: Any) -> Any:
    """Means over 3 by 3 pixels."""
    shifts = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)]
    return np.mean([np.roll(values, shift, axis=(0, 1)) for shift in shifts], axis=0)
