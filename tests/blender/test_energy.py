# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light Principled and Glossy BSDF reflect in all: none is made, and as much as Cycles'."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

DISTRIBUTIONS = ("GGX", "MULTI_GGX")


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_white_furnace(studio: Any, distribution: str) -> None:
    """White balls of all kinds in a white world reflect what they get; GGX loses what is reflected twice."""
    kinds: list[dict[str, Any]] = [{"Metallic": 1.0}, {}, {"IOR": 2.5}, {"Coat_Weight": 1.0}, {"Sheen_Weight": 1.0}]
    if "Diffuse Roughness" in studio.material("ShaderNodeBsdfPrincipled").node_tree.nodes["Principled BSDF"].inputs:
        kinds.append({"Diffuse_Roughness": 1.0})
    roughnesses = (0.05, 0.3, 0.6, 1.0)
    for row, kind in enumerate(kinds):
        if any(name.replace("_", " ") not in _inputs(studio) for name in kind):
            continue
        for column, roughness in enumerate(roughnesses):
            inputs = {"Base_Color": (1.0, 1.0, 1.0), "Roughness": roughness, "distribution": distribution, **kind}
            made = studio.material("ShaderNodeBsdfPrincipled", **inputs)
            studio.ball(0.1, made, location=(column, row, 0), rings=24)
    studio.world(color=(1.0, 1.0, 1.0))
    studio.camera((1.5, 2, 60), (1.5, 2, 0), lens=450)
    studio.scene.shlight.use_shadows = False
    studio.scene.shlight.pixel_samples = 16  # which averages what single rays are off by
    image = studio.render("SHLIGHT")[..., :3]
    assert image.max() <= 1.0 + 1e-3
    assert image.min() >= (1.0 - 5e-3 if distribution == "MULTI_GGX" else 0.85)


def _inputs(studio: Any) -> Any:
    return studio.material("ShaderNodeBsdfPrincipled").node_tree.nodes["Principled BSDF"].inputs


ROUGHNESSES = (0.3, 0.5, 0.75, 1.0)


@pytest.mark.parametrize(
    ("metallic", "distribution", "roughness"),
    [
        pytest.param(float(i), distribution, roughness, marks=() if (i + j + k / 3) % 2 == 0 else pytest.mark.slow)
        for i in range(2)
        for j, distribution in enumerate(DISTRIBUTIONS)
        for k, roughness in enumerate(ROUGHNESSES)
    ],
)
def test_a_ball_is_as_bright_as_in_cycles(studio: Any, metallic: float, distribution: str, roughness: float) -> None:
    inputs = {"Base_Color": (0.8, 0.6, 0.4), "Metallic": metallic, "Roughness": roughness}
    studio.ball(1.0, studio.material("ShaderNodeBsdfPrincipled", distribution=distribution, **inputs), rings=32)
    studio.area(100, (1.5, -2.5, 3), size=1.5, rotation_euler=(0.6, 0.4, 0))
    studio.camera((0, -5, 1), (0, 0, 0))
    studio.scene.cycles.samples = 512
    ours, theirs = studio.compare(mean=5e-3, error=2e-3)
    assert np.isfinite(ours).all()
    assert theirs[..., 0].max() > 0.0
