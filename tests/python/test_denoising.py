# SPDX-License-Identifier: MIT
"""Open Image Denoise on pictures of few rays."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, SQUARE, from_above

import shlight
from shlight.denoising import FEATURES
from shlight.metrics import rel_mse

pytestmark = pytest.mark.skipif(not shlight.has_denoiser(), reason="Open Image Denoise is missing")


@pytest.fixture(scope="module")
def scene() -> shlight.Scene:
    """A floor under the sky and a wide lamp that many plates stand before."""
    made = shlight.Scene()
    made.add_mesh(FLOOR, FACES, bsdf=shlight.Bsdf.lambert(0.6))
    for x in np.linspace(-1.8, 1.8, 7):
        for y in np.linspace(-1.8, 1.8, 7):
            made.add_mesh(0.12 * SQUARE + [x, y, 0.3], FACES, bsdf=shlight.Bsdf.lambert((0.2, 0.5, 0.8)))
    made.add_sphere_light((1, 1, 4), 1, (3, 3, 3))
    made.set_environment((0.3, 0.4, 0.6))
    return from_above(made)


@pytest.fixture(scope="module")
def noisy(scene: shlight.Scene) -> dict[str, NDArray[np.float32]]:
    return shlight.render(scene, 96, 80, min_samples=1, max_samples=1, shadow_rays=1, passes=FEATURES)


def denoised(pictures: dict[str, NDArray[np.float32]], **options: str) -> NDArray[np.float32]:
    return shlight.denoise(pictures["combined"], *(pictures[name] for name in FEATURES), **options)


def test_little_is_left_of_noise(scene: shlight.Scene, noisy: dict[str, NDArray[np.float32]]) -> None:
    before = noisy["combined"].copy()
    reference = shlight.render(scene, 96, 80, min_samples=64, max_samples=64)
    for quality in ("fast", "high"):
        made = denoised(noisy, quality=quality)
        assert made.shape == before.shape
        assert made.dtype == np.float32
        assert rel_mse(made, reference) <= 0.2 * rel_mse(before, reference), quality
        np.testing.assert_array_equal(made[..., 3], before[..., 3])
    np.testing.assert_array_equal(noisy["combined"], before)


def test_it_can_be_cancelled(noisy: dict[str, NDArray[np.float32]]) -> None:
    told: list[float] = []
    with pytest.raises(shlight.RenderCancelled):
        shlight.denoise(noisy["combined"], progress=lambda share: told.append(share) or share < 0.5)
    assert 0.5 <= told[-1] < 1

    def fails(share: float) -> bool:
        raise KeyError("the caller's own")

    with pytest.raises(KeyError, match="the caller's own"):
        shlight.denoise(noisy["combined"], progress=fails)
