# SPDX-License-Identifier: MIT
"""The examples that optimise with gradients."""

from __future__ import annotations

import importlib.util
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import shlight

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_lamps_and_roughness_are_found_from_what_they_light() -> None:
    example = runpy.run_path(str(EXAMPLES / "find_lamps.py"))
    points, truth = example["floor_points"](), example["unknowns"](example["LAMPS"], example["ROUGHNESS"])
    exact, jacobian = example["floor_radiance"](points, example["LAMPS"], example["ROUGHNESS"])
    assert jacobian.shape == (len(points), truth.size)
    start = example["unknowns"](np.array([[-0.3, 0.0, 1.5], [0.3, 0.3, 1.5]]), 0.7)
    result = example["find"](points, exact, start)
    np.testing.assert_allclose(result.x, truth, atol=2e-3)


def test_the_torch_function_sums_what_moves_a_loss() -> None:
    example = runpy.run_path(str(EXAMPLES / "torch_shading.py"))
    rng = np.random.default_rng(1)
    centers, radii = rng.normal(size=(5, 3)) + np.array([0.0, 0, 3]), rng.uniform(0.1, 0.4, 5)
    bsdf, weights = shlight.Bsdf.ggx(0.5, (0.2, 0.5, 0.8)), rng.normal(size=(5, 3))
    value, gradient = example["forward"](centers, radii, bsdf, np.array(0.8))
    assert value.shape == (5, 3)
    by_centers, by_radii = example["backward"](gradient, weights)
    for i in range(5):
        expected = sum(weights[i, c] * gradient.center[i, c] for c in range(3))
        np.testing.assert_allclose(by_centers[i], expected, rtol=1e-12)
    np.testing.assert_allclose(by_radii, (weights * gradient.radius).sum(axis=1), rtol=1e-12)


def test_the_torch_example_runs_or_says_what_it_lacks() -> None:
    run = subprocess.run([sys.executable, EXAMPLES / "torch_shading.py"], capture_output=True, text=True, timeout=300)
    if importlib.util.find_spec("torch") is None:
        assert run.returncode == 1
        assert "pip install torch" in run.stderr
        pytest.skip("torch is not installed")
    assert run.returncode == 0, run.stderr
