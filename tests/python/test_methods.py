# SPDX-License-Identifier: MIT
"""`method=` and what belongs to it: every method on easy lights, options and seeds."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

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
Floats = NDArray[np.float64]


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


# Random caps: axes and half angles.
CapDraw = Callable[[np.random.Generator, int], tuple[Floats, Floats]]
LOBES = np.array([[0.62439210145170621, 0.56876027650862593, 0.53539354825264152], [0.2450696662018568,
    -0.96949406431895579, -0.0047029733173043643]])  # fmt: skip  # of tools/methods/lobe_directions.cpp
DEGREE = np.pi / 180


def at_tilt(rng: np.random.Generator, tilt: Any) -> Floats:
    phi = rng.uniform(0, 2 * np.pi, np.shape(tilt))
    return np.stack([np.sin(tilt) * np.cos(phi), np.sin(tilt) * np.sin(phi), np.cos(tilt)], axis=-1)


def log_uniform(rng: np.random.Generator, low: float, high: float, shape: Any = None) -> Any:
    return np.exp(rng.uniform(np.log(low), np.log(high), shape))


def easy(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    """10° and more from tangency, and the centre as far from the horizon."""
    half = rng.uniform(0.2, 1, 20 * count)
    tilt = rng.uniform(0, np.pi / 2 + half - 10 * DEGREE)
    kept = (np.abs(tilt - np.pi / 2) >= 10 * DEGREE) & (np.abs(tilt - np.pi / 2 + half) >= 10 * DEGREE)
    axes = log_uniform(rng, 0.1, 10, (count, 1)) * at_tilt(rng, tilt[kept][:count])
    return axes, half[kept][:count]


def anywhere(low: float, high: float) -> CapDraw:
    return lambda rng, count: (at_tilt(rng, np.arccos(rng.uniform(-1, 1, count))), rng.uniform(low, high, count))


def at_horizon(low: float, high: float, offset: Callable[..., Any]) -> CapDraw:
    """The centre `offset` half angles below it."""

    def draw(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
        half = log_uniform(rng, low, high, count)
        return at_tilt(rng, np.pi / 2 + half * offset(rng, count)), half

    return draw


def along_a_lobe(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    """Places a cap so that the height over a lobe of zonal harmonics is the same all along its edge."""
    return rng.choice([-1, 1], (count, 1)) * rng.choice(LOBES, count), rng.uniform(0.3, 3, count)


def upright(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    return rng.choice(np.concatenate([np.eye(3), -np.eye(3)]), count), rng.uniform(0.3, 3, count)


def near_tangency(rng: np.random.Generator, count: int) -> Any:
    return rng.choice([-1, 1], count) * (1 - log_uniform(rng, 1e-7, 1e-2, count))


ZONAL: dict[str, CapDraw] = {
    "easy": easy, "wide": anywhere(0.5 * np.pi, 0.97 * np.pi), "along a lobe": along_a_lobe, "upright": upright,
}  # fmt: skip
CAPS: dict[str, CapDraw] = {
    "anywhere": anywhere(0.05, 1.5),
    "across the horizon": at_horizon(0.05, 1.5, lambda rng, count: rng.uniform(-1, 1, count)),
    "near tangency": at_horizon(0.05, 1.4, near_tangency),
    "axis near the horizon": at_horizon(0.05, 1.5, lambda rng, count: rng.uniform(-1, 1, count) * 1e-6),
    "small": at_horizon(1e-5, 0.05, lambda rng, count: rng.uniform(-1, 1, count)),
    "beyond a hemisphere": anywhere(1.6, 3.1),
}


def star(rng: np.random.Generator, center: Floats, normal: Floats, corners: int, inner: float, half: float) -> Floats:
    """A plane polygon around `center`, whose odd corners are at `inner` of the distance if that is less than 0.4."""
    u = np.cross(rng.normal(size=3), normal)
    u /= np.linalg.norm(u)
    v = np.cross(normal / np.linalg.norm(normal), u)
    angles = 2 * np.pi * (np.arange(corners) + rng.uniform(0, 0.7, corners)) / corners
    radii = np.where((np.arange(corners) % 2 == 1) & (inner < 0.4), inner, rng.uniform(0.6, 1, corners))
    return center + half * (radii * np.cos(angles))[:, None] * u + half * (radii * np.sin(angles))[:, None] * v


def facing(corners: int, inner: float, low: float, high: float, turned: float = 0.98) -> Callable[..., Floats]:
    """Draws polygons of such half sizes relative to the distance, turned away by up to about 80°."""

    def draw(rng: np.random.Generator) -> Floats:
        direction = at_tilt(rng, rng.uniform(0, 1.3))
        way, distance = rng.normal(size=3), log_uniform(rng, 0.1, 10)
        normal = direction + turned * way / np.linalg.norm(way)
        return star(rng, distance * direction, normal, corners, inner, distance * log_uniform(rng, low, high))

    return draw


def near_contact(rng: np.random.Generator) -> Floats:
    normal = at_tilt(rng, rng.uniform(0, 1.3))
    return star(rng, log_uniform(rng, 1e-6, 1e-2) * normal, normal, 5, 0.6, 1.0)


def wall(rng: np.random.Generator) -> Floats:
    """It stands on the horizon's plane."""
    foot = at_tilt(rng, np.pi / 2) * [1, 1, 0]
    side = rng.uniform(0.3, 1) * np.cross([0, 0, 1], foot)
    up = [0, 0, rng.uniform(0.3, 2)]
    return np.array([foot - side, foot + side, foot + side + up, foot - side + up])


EASY_POLYGONS = {"quads": facing(4, 0.6, 0.3, 1, 0.8), "concave": facing(8, 0.3, 0.5, 0.8, 0.0), "walls": wall}
POLYGONS = {
    "plain": facing(4, 0.6, 0.01, 1), "concave": facing(8, 0.3, 0.01, 1), "small": facing(3, 0.6, 1e-3, 0.03),
    "large": facing(5, 0.6, 1, 30), "near contact": near_contact, "walls": wall,
}  # fmt: skip
# Bounds at orders, in float64 and in float32.
CAPS_UP_TO_TEN = {1: (1e-14, 3e-6), 2: (1e-12, 1e-4), 3: (1e-12, 1e-3), 10: (1e-10, 1e-2)}
POLYGONS_UP_TO_TEN = {1: (1e-13, 3e-5), 2: (1e-11, 3e-3), 3: (1e-11, 3e-3), 10: (1e-11, 1e-2)}
HIGH = {31: (1e-10, 1e-1), 32: (1e-10, 1e-1)}
HELD = {4: (1e-12, 1e-5), 9: (1e-12, 1e-5), 16: (1e-12, 1e-5)}
AGAINST_REFERENCE = [
    *(("zhou_wei", name, draw, CAPS_UP_TO_TEN | HIGH) for name, draw in ZONAL.items()),
    *(("snyder", name, draw, CAPS_UP_TO_TEN) for name, draw in ZONAL.items()),
    *(("wang_ramamoorthi", name, draw, POLYGONS_UP_TO_TEN | HIGH) for name, draw in EASY_POLYGONS.items()),
    *(("quadrature", name, draw, HELD) for name, draw in (CAPS | POLYGONS).items() if name != "near tangency"),
    # Preparing a light in double loses digits if the gap between its rim and the horizon is 1e-7: 2^-52 ÷ 1e-7 × order.
    ("quadrature", "near tangency", CAPS["near tangency"], dict.fromkeys(HELD, (4e-8, 1e-5))),
]


def errors_of(
    method: str, lights: list[Any], orders: Any, dtype: Any, *, clip: bool = True, **options: Any
) -> list[Floats]:
    """For each order the largest error of the coefficients of caps or of a polygon in the type, relative to L_00."""
    function = shlight.cap_coefficients if len(lights) == 2 else shlight.polygon_coefficients
    rounded = [np.asarray(array, dtype) for array in lights]
    exact = function(*(array.astype(float) for array in rounded), max(orders), method="reference", clip=clip)
    made = [function(*rounded, order, method=method, dtype=dtype, clip=clip, **options) for order in orders]
    errors = [np.abs(found - exact[..., : found.shape[-1]]).max(axis=-1) for found in made]
    return [np.divide(error, exact[..., 0], out=np.zeros_like(error), where=error > 0) for error in errors]


@pytest.mark.parametrize(("method", "name", "draw", "bounds"), AGAINST_REFERENCE)
def test_random_lights_against_the_reference(method: str, name: str, draw: Any, bounds: dict[int, Any]) -> None:
    rng = np.random.default_rng(700)
    batches = [[draw(rng)] for _ in range(12)] if name in EASY_POLYGONS | POLYGONS else [draw(rng, 12), draw(rng, 12)]
    if name == "concave" and method == "wang_ramamoorthi":
        batches = [[draw(rng)[::-1]] for _ in range(12)]  # wound the other way
    for i, lights in enumerate(batches):
        for dtype, per_order in zip((np.float64, np.float32), zip(*bounds.values(), strict=True), strict=True):
            found = errors_of(method, list(lights), bounds, dtype, clip=i % 4 != 1)
            for order, errors, bound in zip(bounds, found, per_order, strict=True):
                assert (errors <= bound).all(), (order, dtype, errors)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-8])
def test_quadrature_keeps_its_tolerance(tolerance: float) -> None:
    rng = np.random.default_rng(1)
    for lights in ([POLYGONS["plain"](rng)], list(CAPS["across the horizon"](rng, 12))):
        for errors in errors_of("quadrature", lights, (2, 6, 12), np.float64, tolerance=tolerance):
            assert (errors <= tolerance).all()


def test_quadrature_knows_spheres_in_contact_and_the_whole_sphere() -> None:
    center = np.array([0.36, 0.48, 0.8])  # of length 1
    for gap in (0.0, 1e-9, 1e-3):
        given = {"centers": center, "radii": 1 - gap, "order": 8, "dtype": np.float64}
        exact = shlight.sphere_coefficients(**given, method="reference")
        np.testing.assert_allclose(shlight.sphere_coefficients(**given, method="quadrature"), exact, atol=1e-12)
    whole = shlight.cap_coefficients([0, 0, 1], np.pi, 8, method="quadrature", dtype=np.float64, clip=False)
    np.testing.assert_allclose(whole, [np.sqrt(4 * np.pi), *[0] * 63], atol=1e-13)


@pytest.mark.parametrize("method", ["wang_ramamoorthi", "zhou_wei", "snyder"])
def test_zonal_methods_see_nothing_below_the_horizon_or_edge_on(method: str) -> None:
    if method == "wang_ramamoorthi":
        for vertices in ([[1, 0, -1], [0, 1, -1], [-1, -1, -1]], [[1, 0, 0], [2, 0, 0], [2, 0, 1]],
                         [[1, 0, 1], [2, 0, 1], [1, 0, 1]], [[1, 0, 0], [2, 0, 1], [3, 0, 0]]):  # fmt: skip
            assert not shlight.polygon_coefficients(vertices, 8, method=method, dtype=np.float64).any()
    else:
        below = [[0, 0, -1], [0.2, 0.1, -0.7]]
        assert not shlight.cap_coefficients(below, 0.5, 8, method=method, dtype=np.float64).any()


@pytest.mark.parametrize(("order", "loss"), [(8, 0.03), (16, 0.1)])
def test_zonal_methods_lose_in_float32_where_the_edge_cancels(order: int, loss: float) -> None:
    """For half of these lights; the library's own keep 1e-4 for all."""
    rng = np.random.default_rng(720)
    whole = at_tilt(rng, rng.uniform(0, 1.5, 40)), log_uniform(rng, 1e-3, 1e-2, 40)
    cut = at_horizon(1e-3, 1e-2, lambda rng, count: rng.uniform(-0.8, 0.8, count))(rng, 40)
    setting = at_horizon(0.02, 0.05, lambda rng, count: rng.uniform(0.8, 0.99, count))(rng, 40)
    for lights, least in ((whole, loss), (cut, loss), (setting, loss / 10)):
        assert np.median(errors_of("zhou_wei", list(lights), [order], np.float32)) >= least
        assert np.max(errors_of("exact", list(lights), [order], np.float32)) <= 1e-4


@pytest.mark.parametrize("clip", [True, False])
@pytest.mark.parametrize("sampling", ["solid_angle", "area"])
def test_monte_carlo_is_unbiased(clip: bool, sampling: Any) -> None:
    """Means over many lights of a batch, which differ in their random numbers, within five standard errors."""
    axis = np.array([0.5, -0.3, 0.2])
    tiny = [[0.5, -0.3, 2e-6], [0.50001, -0.3, -3e-6], [0.5, -0.29999, 7e-6]]
    quad = [[-0.2, 0.5, -0.3], [0.9, 0.5, -0.2], [0.9, 0.6, 0.9], [-0.2, 0.6, 0.8]]
    concave = [[-0.5, 0.5, 1], [0, 0.1, 1], [0.5, 0.5, 1], [0, -0.5, 1]]
    radii = np.sin([1e-5, 0.7]) * np.linalg.norm(axis)
    kinds: list[tuple[Any, ...]] = [
        *((shlight.cap_coefficients, axis, half) for half in (1e-5, 0.7, *([2.5] if sampling != "area" else []))),
        *((shlight.sphere_coefficients, axis, radius) for radius in radii),
        *((shlight.polygon_coefficients, vertices) for vertices in (quad, tiny, concave)),
    ]
    for function, first, *rest in kinds:
        exact = function(first, *rest, 4, method="reference", dtype=np.float64, clip=clip)
        batch = np.broadcast_to(first, (400, *np.shape(first)))
        options = {"method": "monte_carlo", "sampling": sampling, "samples": 64, "seed": 3}
        found = function(batch, *rest, 4, dtype=np.float64, clip=clip, **options)
        error = found.std(axis=0, ddof=1) / np.sqrt(400)
        assert (np.abs(found.mean(axis=0) - exact) <= 5 * error + 1e-9 * exact[0]).all(), (function, rest)
        assert (error <= 0.2 * exact[0]).all()


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
@pytest.mark.parametrize("roughness", [0.3, 0.7])
def test_random_shading_is_right_and_depends_on_the_seed_only(roughness: float, sampling: Any) -> None:
    bsdf = Bsdf.layer(Bsdf.ggx(roughness, 0.04, ior=1.5), Bsdf.lambert([0.2, 0.4, 0.8]))
    cut = [[-0.9, 0.5, -0.3], [0.2, 0.5, -0.2], [0.2, 0.6, 0.9], [-0.9, 0.6, 0.8]]
    concave = [[-0.9, 0.5, 1], [-0.4, 0.1, 1], [0.1, 0.5, 1], [-0.4, -0.5, 1]]
    kinds: list[tuple[Any, ...]] = [(shlight.shade_spheres, AXES, RADII)]
    kinds.append((shlight.shade_polygons, np.array([cut, concave, QUADS[0]])))
    for shade, *lights in kinds:
        many = [np.tile(array, (600, *[1] * (array.ndim - 1))) for array in lights]

        def compute(seed: int, threads: int, shade: Any = shade, many: Any = many) -> NDArray[Any]:
            options: dict[str, Any] = {"method": "monte_carlo", "sampling": sampling, "samples": 16}
            return shade(*many, bsdf, 0.7, seed=seed, threads=threads, **options)

        once = compute(1, 1)
        np.testing.assert_array_equal(compute(1, 2), once)
        assert (compute(2, 1) != once).any()
        expected = shade(*lights, bsdf, 0.7, method="quadrature").astype(np.float64)
        draws = once.reshape(600, 3, 3).astype(np.float64)
        standard_error = draws.std(axis=0, ddof=1) / np.sqrt(600)
        assert (np.abs(draws.mean(axis=0) - expected) <= 5 * standard_error + 1e-6).all()
