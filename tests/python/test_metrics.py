# SPDX-License-Identifier: MIT
from __future__ import annotations

import numpy as np
import pytest

from shlight import metrics


@pytest.fixture
def reference() -> np.ndarray:
    return np.random.default_rng(3).uniform(0.5, 2.0, (40, 50, 3))


def test_rel_mse_by_hand() -> None:
    reference = np.array([[[1.0, 1.0, 1.0], [3.0, 3.0, 3.0]]])  # mean 2
    image = reference + np.array([[[0.1, 0.0, 0.0], [0.0, -0.2, 0.0]]])
    expected = (0.1**2 / (1 + 0.04) + 0.2**2 / (9 + 0.04)) / 6
    assert metrics.rel_mse(image, reference) == pytest.approx(expected, rel=1e-12)
    with_alpha = [np.concatenate([a, np.full((1, 2, 1), alpha)], axis=-1) for alpha, a in ((9, image), (0, reference))]
    assert metrics.rel_mse(*with_alpha) == pytest.approx(expected, rel=1e-12)


def test_relative_difference_is_the_signed_root(reference: np.ndarray) -> None:
    image = reference * 1.1
    grey = np.full_like(reference, 2.0)
    np.testing.assert_allclose(metrics.relative_difference(grey * 1.1, grey), 0.1 / np.sqrt(1.01), rtol=1e-12)
    assert (metrics.relative_difference(image, reference) > 0).all()
    assert (metrics.relative_difference(reference - 0.1, reference) < 0).all()


def test_mean_ratio(reference: np.ndarray) -> None:
    assert metrics.mean_ratio(0.99 * reference, reference) == pytest.approx(0.99, rel=1e-12)
    assert np.isnan(metrics.mean_ratio(reference, 0 * reference))


def test_noise_of_the_reference_is_found(reference: np.ndarray) -> None:
    rng = np.random.default_rng(4)
    sigma = 0.05
    a, b = (reference + sigma * rng.standard_normal(reference.shape) for _ in range(2))
    error = metrics.standard_error(a, b)
    assert error.shape == reference.shape
    assert np.sqrt(np.mean(error**2)) == pytest.approx(sigma / np.sqrt(2), rel=0.05)
    # The halves predict the score of the truth against the noisy reference.
    truth = metrics.rel_mse(reference, (a + b) / 2)
    assert metrics.reference_rel_mse(a, b) == pytest.approx(truth, rel=0.1)
    assert metrics.share_within(reference, (a + b) / 2, error) > 0.97
    assert metrics.share_within(reference + 0.3, (a + b) / 2, error) < 0.01
    assert metrics.share_within(reference, reference, 0 * error) == 1.0
    border = metrics.standard_error(np.zeros((4, 4, 3)), np.full((4, 4, 3), 0.2))  # of neighbours that there are
    np.testing.assert_allclose(border, 0.1, rtol=1e-12)


@pytest.mark.parametrize("error", [0.0, 0.02])
def test_noise_is_taken_out(reference: np.ndarray, error: float) -> None:
    # Skewed noise, one in all channels of a pixel, whose variance is ten to a hundred times the squared error.
    rng = np.random.default_rng(5)
    image = reference * (1 + error * rng.standard_normal(reference.shape))

    def half() -> np.ndarray:
        return reference * rng.gamma(25, 1 / 25, (*reference.shape[:2], 1))

    halves = [(half(), half()) for _ in range(200)]
    values, errors = np.transpose([metrics.rel_mse_without_noise(image, a, b) for a, b in halves])
    # The spread of the values is what each tells of itself, and their mean is right within it.
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(np.std(values), rel=0.2)
    truth = metrics.rel_mse(image, reference)
    limit = 3 * np.std(values) / np.sqrt(len(values)) + 0.04 * 3 * truth
    assert abs(np.mean(values) - truth) <= limit
    differences = [metrics.rel_mse(image, (a + b) / 2) - metrics.reference_rel_mse(a, b) for a, b in halves]
    assert abs(np.mean(differences) - truth) > limit


def test_faults_are_named(reference: np.ndarray) -> None:
    with pytest.raises(ValueError, match="image and reference differ in size"):
        metrics.rel_mse(reference[:-1], reference)
    with pytest.raises(ValueError, match="reference must have shape"):
        metrics.rel_mse(reference, reference[..., 0])
    with pytest.raises(ValueError, match="reference is black"):
        metrics.rel_mse(reference, 0 * reference)
    broken = reference.copy()
    broken[3, 4, 1] = np.nan
    with pytest.raises(ValueError, match=r"^image\[3, 4, 1\] must be finite"):
        metrics.rel_mse(broken, reference)
    with pytest.raises(ValueError, match="error must have the reference's shape"):
        metrics.share_within(reference, reference, np.zeros((2, 2, 3)))
