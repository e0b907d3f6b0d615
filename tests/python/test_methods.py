# SPDX-License-Identifier: MIT
"""`method=` and what belongs to it: every method on easy lights, options, seeds, and Monte Carlo pictures."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, lit_floor

import shlight
from shlight import Bsdf
from shlight_tools import methods

AXES = np.array([[0.3, 0.2, 0.9], [-0.6, 0.1, 0.5], [0.2, -0.7, 0.3]])
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)
HALF_ANGLES = np.array([0.3, 0.4, 0.6])
RADII = np.sin(HALF_ANGLES)
QUADS = AXES[:, None] + 0.4 * np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])

COEFFICIENT_METHODS = methods.coefficient_methods()
SHADING_METHODS = methods.shading_methods()
RANDOM = [name for name, method in COEFFICIENT_METHODS.items() if method.random]

Call = Callable[..., Any]


def caps(**given: Any) -> NDArray[Any]:
    return shlight.cap_coefficients(AXES, HALF_ANGLES, given.pop("order", 4), **given)


def polygons(**given: Any) -> NDArray[Any]:
    return shlight.polygon_coefficients(QUADS, given.pop("order", 4), **given)


def shaded(**given: Any) -> Any:
    return shlight.shade_spheres(AXES, RADII, given.pop("bsdf", Bsdf.ggx(0.6, 0.8)), 0.7, **given)


def expect_value_error(name: str, call: Call) -> None:
    with pytest.raises(ValueError, match=f"^{name}"):
        call()


# --- coefficients -------------------------------------------------------------------------------------------------


def test_the_library_comes_first_and_each_method_names_its_source() -> None:
    assert next(iter(COEFFICIENT_METHODS)) == "exact"
    expected = {"exact", "reference", "quadrature", "monte_carlo", "zhou_wei", "snyder", "wang_ramamoorthi"}
    assert expected <= set(COEFFICIENT_METHODS)
    assert {"plain_harmonics", "warped_harmonics", "cubature", "quadrature", "monte_carlo"} <= set(SHADING_METHODS)
    for method in [*COEFFICIENT_METHODS.values(), *SHADING_METHODS.values()]:
        assert method.source


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", sorted(COEFFICIENT_METHODS))
def test_every_method_knows_easy_lights(name: str, dtype: Any) -> None:
    method = COEFFICIENT_METHODS[name]
    assert method.knows_caps or method.knows_polygons
    options: dict[str, Any] = {"samples": 4096} if method.random else {}
    tolerance = 0.2 if method.random else 1e-3 if dtype == np.float32 else 1e-9
    for known, call in [(method.knows_caps, caps), (method.knows_polygons, polygons)]:
        if not known:
            expect_value_error("method", lambda call=call: call(method=name))
            continue
        for clip in (True, False):
            expected = call(method="reference", dtype=np.float64, clip=clip)
            computed = call(method=name, dtype=dtype, clip=clip, **options)
            assert computed.dtype == dtype
            errors = np.abs(computed - expected).max(axis=-1) / expected[..., 0]
            assert (errors <= tolerance).all(), (name, errors)


def test_a_tolerance_is_kept() -> None:
    exact = caps(dtype=np.float64)
    errors = []
    for tolerance in (1e-1, 1e-5):
        rough = caps(method="quadrature", dtype=np.float64, tolerance=tolerance)
        errors.append(np.max(np.abs(rough - exact).max(axis=-1) / exact[:, 0]))
        assert errors[-1] <= tolerance
    assert errors[0] > 10 * errors[1]


@pytest.mark.parametrize("name", RANDOM)
@pytest.mark.parametrize("sampling", ["solid_angle", "area"])
def test_random_coefficients_depend_on_the_seed_only(name: str, sampling: Any) -> None:
    axes = np.tile(AXES, (600, 1))  # more than a thread takes at once
    half_angles = np.tile(HALF_ANGLES, 600)

    def compute(seed: int, threads: int) -> NDArray[Any]:
        options: dict[str, Any] = {"method": name, "sampling": sampling, "samples": 5}
        return shlight.cap_coefficients(axes, half_angles, 2, seed=seed, threads=threads, **options)

    once = compute(1, 1)
    np.testing.assert_array_equal(compute(1, 2), once)
    assert (compute(2, 1) != once).any(axis=-1).all()
    # Each light of a batch has random numbers of its own.
    assert len(np.unique(once[::3, 0] if sampling == "area" else once[::3, 1])) == 600


def test_bad_lights() -> None:
    for name in ("quadrature", "monte_carlo"):
        options: dict[str, Any] = {"method": name}
        expect_value_error("half_angles", lambda: shlight.cap_coefficients(AXES, 0.0, 3, **options))  # noqa: B023
        expect_value_error("axes", lambda: shlight.cap_coefficients([0, 0, 0], 0.2, 3, **options))  # noqa: B023
        expect_value_error("radii", lambda: shlight.sphere_coefficients(AXES, 2.0, 3, **options))  # noqa: B023
        flat = np.zeros((3, 3))
        np.testing.assert_array_equal(shlight.polygon_coefficients(flat, 3, **options), 0)
    expect_value_error(
        "half_angles",
        lambda: shlight.cap_coefficients(AXES, 1.7, 3, method="monte_carlo", sampling="area"),
    )


@pytest.mark.parametrize("call", ["caps", "polygons", "shaded"])
def test_without_the_tools_the_error_says_what_is_missing(call: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compute = globals()[call]
    own = compute()
    monkeypatch.setitem(sys.modules, "shlight_tools", None)
    np.testing.assert_array_equal(compute(), own)
    with pytest.raises(ValueError, match=r"^method must be '\w+': others need .*shlight_tools"):
        compute(method="quadrature")


# --- shading ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(SHADING_METHODS))
def test_every_shading_method_knows_easy_lights(name: str) -> None:
    method = SHADING_METHODS[name]
    options: dict[str, Any] = {}
    if method.harmonic:
        options["order"] = 32
    if method.sampled:
        options["samples"] = 20000 if method.random else 400
    expected = shaded(method="quadrature")
    computed, effort = shaded(method=name, return_effort=True, **options)
    np.testing.assert_allclose(computed, expected, rtol=0, atol=0.02 if method.random else 2e-3)
    assert (effort > 0).all()
    if method.sampled:
        assert (effort <= options["samples"]).all()
    bsdf = Bsdf.ggx(0.6, 0.8)
    np.testing.assert_allclose(
        shlight.shade_polygons(QUADS, bsdf, 0.7, method=name, **options),
        shlight.shade_polygons(QUADS, bsdf, 0.7, method="quadrature"),
        rtol=0,
        atol=0.02 if method.random else 2e-3,
    )


def test_a_lambertian_floor_has_a_closed_form() -> None:
    above = AXES[:, 2] > RADII
    expected = 0.5 * (RADII**2 * AXES[:, 2])[above]
    for options in ({"method": "quadrature"}, {"method": "cubature", "samples": 200}):
        given: dict[str, Any] = options
        computed = shaded(bsdf=Bsdf.lambert(0.5), **given)
        np.testing.assert_allclose(computed[above, 0], expected, rtol=1e-6)


@pytest.mark.parametrize("sampling", ["solid_angle", "area", "bsdf", "mis"])
def test_random_shading_is_right_and_depends_on_the_seed_only(sampling: Any) -> None:
    axes = np.tile(AXES, (600, 1))
    radii = np.tile(RADII, 600)
    bsdf = Bsdf.layer(Bsdf.ggx(0.4, 0.04, ior=1.5), Bsdf.lambert([0.2, 0.4, 0.8]))

    def compute(seed: int, threads: int) -> NDArray[Any]:
        options: dict[str, Any] = {"method": "monte_carlo", "sampling": sampling, "samples": 16}
        return shlight.shade_spheres(axes, radii, bsdf, 0.7, seed=seed, threads=threads, **options)

    once = compute(1, 1)
    np.testing.assert_array_equal(compute(1, 2), once)
    assert (compute(2, 1) != once).any()
    expected = shlight.shade_spheres(AXES, RADII, bsdf, 0.7, method="quadrature").astype(np.float64)
    draws = once.reshape(600, 3, 3).astype(np.float64)
    standard_error = draws.std(axis=0, ddof=1) / np.sqrt(600)
    assert (np.abs(draws.mean(axis=0) - expected) <= 5 * standard_error + 1e-6).all()
    np.testing.assert_array_equal(  # polygons too
        shlight.shade_polygons(QUADS, bsdf, 0.7, method="monte_carlo", sampling=sampling, seed=3),
        shlight.shade_polygons(QUADS, bsdf, 0.7, method="monte_carlo", sampling=sampling, seed=3),
    )


# --- pictures -----------------------------------------------------------------------------------------------------


def test_pictures_agree_with_the_library_and_their_noise_falls_with_the_root_of_samples() -> None:
    scene = lit_floor(bsdf=Bsdf.ggx(0.5, [0.9, 0.6, 0.2]) + Bsdf.lambert(0.3))
    scene.add_mesh(FLOOR / 30 + np.float32([0.2, 0, 0.6]), FACES)
    expected = shlight.render(scene, 8, 6, pixel_samples=256, max_samples=256, shadow_rays=64, max_bounces=0)
    noise = []
    for samples in (16, 256):
        runs = np.array([methods.render_monte_carlo(scene, 8, 6, samples=samples, seed=i) for i in range(10)])
        assert runs.dtype == np.float32
        assert runs.shape == (10, 6, 8, 4)
        np.testing.assert_array_equal(runs[..., 3], 1)
        noise.append(np.sqrt(runs[..., :3].var(axis=0, ddof=1, dtype=np.float64).mean()))
        totals = runs.astype(np.float64).sum(axis=(1, 2))
        standard_error = totals.std(axis=0, ddof=1) / np.sqrt(len(runs))
        off = np.abs(totals.mean(axis=0) - expected.astype(np.float64).sum(axis=(0, 1)))
        assert (off <= 5 * standard_error).all()
    assert (standard_error[:3] <= 0.01 * totals.mean(axis=0)[:3]).all()
    assert noise[0] / noise[1] == pytest.approx(4, rel=0.2)
    assert (runs[0] != runs[1]).any()
