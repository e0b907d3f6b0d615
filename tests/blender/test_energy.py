# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light Principled BSDF reflects in all: none is made."""

from __future__ import annotations

from typing import Any

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
