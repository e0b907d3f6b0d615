# SPDX-License-Identifier: MIT
"""The kernels on each instruction set of this machine, through Python; tests/core/test_targets.cpp has the rest."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

import shlight
from shlight import _core
from shlight.bench import inputs

ORDER = 9


@pytest.fixture(params=_core.kernel_targets())
def target(request: pytest.FixtureRequest) -> Iterator[str]:
    """Forced as long as the test runs."""
    before = _core.kernel_target()
    _core.force_kernel_target(request.param)
    yield request.param
    _core.force_kernel_target(before)


@pytest.mark.usefixtures("target")
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float32, 1e-4), (np.float64, 1e-12)])
@pytest.mark.parametrize("kind", ["clipped", "whole", "quads"])
def test_coefficients_agree_with_the_reference(kind: str, dtype: type, tolerance: float) -> None:
    if kind == "quads":
        vertices = inputs.quads(40)
        values = shlight.polygon_coefficients(vertices, ORDER, dtype=dtype)
        true = shlight.polygon_coefficients(vertices, ORDER, dtype=np.float64, method="reference")
        whole = shlight.polygon_coefficients(vertices, 1, dtype=np.float64, method="reference", clip=False)
    else:
        lights = inputs.spheres(kind, 40)
        values = shlight.sphere_coefficients(lights.centers, lights.radii, ORDER, dtype=dtype)
        true = shlight.sphere_coefficients(lights.centers, lights.radii, ORDER, dtype=np.float64, method="reference")
        whole = shlight.sphere_coefficients(lights.centers, lights.radii, 1, method="reference", clip=False)
    assert (abs(values - true).max(axis=1) / whole[:, 0]).max() <= tolerance


def test_the_best_target_is_in_use_unless_another_is_forced() -> None:
    def printed(**variables: str) -> subprocess.CompletedProcess[str]:
        environment = {key: value for key, value in os.environ.items() if key != "SHLIGHT_KERNEL_TARGET"}
        path = os.pathsep.join(part for part in sys.path if part)
        return subprocess.run(
            [sys.executable, "-c", "from shlight import _core; print(_core.kernel_target())"],
            env={**environment, "PYTHONPATH": path, **variables},
            capture_output=True,
            text=True,
            check=False,
        )

    targets = _core.kernel_targets()
    assert printed().stdout.strip() == targets[0]
    for name in targets:
        assert printed(SHLIGHT_KERNEL_TARGET=name).stdout.strip() == name
    named = f"SHLIGHT_KERNEL_TARGET: this build has {', '.join(targets)} for this machine, not MMX"
    assert named in printed(SHLIGHT_KERNEL_TARGET="MMX").stderr
