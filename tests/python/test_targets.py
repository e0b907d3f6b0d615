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
        vertices = inputs.quads(40).vertices
        values = shlight.polygon_coefficients(vertices, ORDER, dtype=dtype)
        true = shlight.polygon_coefficients(vertices, ORDER, dtype=np.float64, method="reference")
        whole = shlight.polygon_coefficients(vertices, 1, dtype=np.float64, method="reference", clip=False)
    else:
        lights = inputs.spheres(kind, 40)
        values = shlight.sphere_coefficients(lights.centers, lights.radii, ORDER, dtype=dtype)
        true = shlight.sphere_coefficients(lights.centers, lights.radii, ORDER, dtype=np.float64, method="reference")
        whole = shlight.sphere_coefficients(lights.centers, lights.radii, 1, method="reference", clip=False)
    assert (abs(values - true).max(axis=1) / whole[:, 0]).max() <= tolerance


@pytest.mark.usefixtures("target")
@pytest.mark.parametrize("order", [1, 2, 8, 9, 20])
@pytest.mark.parametrize("kind", ["clipped", "whole", "quads"])
def test_contraction_is_that_of_the_coefficients(kind: str, order: int) -> None:
    terms = inputs.lobe_terms(order)
    if kind == "quads":
        vertices = inputs.quads(100).vertices
        sums = _core.contract_polygons(vertices, terms, order, 1)
        coefficients = shlight.polygon_coefficients(vertices, order, dtype=np.float64)
        whole = shlight.polygon_coefficients(vertices, 1, dtype=np.float64, clip=False)
    else:
        lights = inputs.spheres(kind, 100)
        sums = _core.contract_spheres(lights.centers, lights.radii, terms, order, 1)
        coefficients = shlight.sphere_coefficients(lights.centers, lights.radii, order, dtype=np.float64)
        whole = shlight.sphere_coefficients(lights.centers, lights.radii, 1, dtype=np.float64, clip=False)
    columns = [band * band + band + m for band in range(order) for m in range(band + 1)]
    # A float rounds each of the order² products of about whole · |term| a few times.
    error = abs(sums - coefficients[:, columns] @ terms.astype(np.float64)) / whole[:, 0]
    assert error.max() <= 1e-5 * np.linalg.norm(terms)


@pytest.mark.usefixtures("target")
def test_basis_is_orthonormal() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    azimuth = 2 * np.pi * np.arange(2 * ORDER) / (2 * ORDER)
    sine = np.sqrt(1 - nodes**2)[:, None]
    z = np.broadcast_to(nodes[:, None], (ORDER, 2 * ORDER))
    directions = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], axis=-1).reshape(-1, 3)
    basis = shlight.sh_basis(directions, ORDER, np.float64)
    gram = basis.T @ (basis * np.repeat(weights * np.pi / ORDER, 2 * ORDER)[:, None])
    np.testing.assert_allclose(gram, np.eye(ORDER**2), atol=1e-13)


@pytest.mark.usefixtures("target")
def test_results_do_not_depend_on_threads() -> None:
    lights, quads = inputs.spheres("mixed", 3000), inputs.quads(1500)
    metal, views = shlight.Bsdf.ggx(0.3, 1.0), np.linspace(0.05, 1, 3000)
    for one, two in zip(
        *(
            (
                shlight.sphere_coefficients(lights.centers, lights.radii, ORDER, threads=threads),
                shlight.polygon_coefficients(quads.vertices, ORDER, threads=threads),
                shlight.shade_spheres(lights.centers, lights.radii, metal, views, threads=threads),
                shlight.shade_polygons(quads.vertices, metal, 0.5, order=8, threads=threads),
            )
            for threads in (1, 2)
        ),
        strict=True,
    ):
        np.testing.assert_array_equal(one, two)


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


def test_an_unknown_target_is_named() -> None:
    with pytest.raises(ValueError, match=r"^target: this build has .* for this machine, not MMX$"):
        _core.force_kernel_target("MMX")
