# SPDX-License-Identifier: MIT
"""Materials of one's own: functions, tables, and files of measured BRDFs."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from strategies import Floats

import shlight
from shlight import Bsdf
from shlight_tools import methods

PI = math.pi
Function = Callable[[Floats, Floats], Floats]


def direction(theta: Floats | float, phi: Floats | float) -> Floats:
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def ashikhmin_shirley(nu: float, nv: float, specular: float = 0.2, diffuse: float = 0.3) -> Function:
    """Ashikhmin & Shirley 2000, "An Anisotropic Phong BRDF Model"."""

    def f(view: Floats, light: Floats) -> Floats:
        half = view + light
        half = half / np.linalg.norm(half, axis=-1, keepdims=True)
        along = (light * half).sum(axis=-1)
        cos_i, cos_o = light[..., 2], view[..., 2]
        across = np.maximum(1 - half[..., 2] ** 2, 1e-30)
        exponent = (nu * half[..., 0] ** 2 + nv * half[..., 1] ** 2) / across
        peak = math.sqrt((nu + 1) * (nv + 1)) / (8 * PI) * half[..., 2] ** exponent
        fresnel = specular + (1 - specular) * (1 - along) ** 5
        grazing = (1 - (1 - cos_i / 2) ** 5) * (1 - (1 - cos_o / 2) ** 5)
        matte = 28 * diffuse / (23 * PI) * (1 - specular) * grazing
        return np.asarray(peak * fresnel / (along * np.maximum(cos_i, cos_o)) + matte)

    return f


def hemisphere(count: int) -> tuple[Floats, Floats]:
    """Directions (n, 3) and solid angles over the upper hemisphere; Gauss points in θ."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    theta = (nodes + 1) * PI / 4
    phi = (np.arange(4 * count) + 0.5) * (PI / 2 / count)
    solid = np.repeat(weights * PI / 4 * np.sin(theta), len(phi)) * (PI / 2 / count)
    return direction(np.repeat(theta, len(phi)), np.tile(phi, len(theta))), solid


def over_sphere(f: Function, view: Floats, center: Floats, radius: float, count: int = 160) -> Floats:
    """∫ f·cos over the part of a sphere light above the horizon, by a product rule over its cap."""
    distance = float(np.linalg.norm(center))
    axis = center / distance
    nodes, weights = np.polynomial.legendre.leggauss(count)
    height = 1 - math.sqrt(1 - (radius / distance) ** 2)
    drop = height * (nodes + 1) / 2
    phi = (np.arange(2 * count) + 0.5) * (PI / count)
    u = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.9 else [0, 1.0, 0])
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    sine = np.sqrt(drop * (2 - drop))
    light = (1 - drop)[:, None, None] * axis + sine[:, None, None] * (
        np.cos(phi)[:, None] * u + np.sin(phi)[:, None] * v
    )
    flat = light.reshape(-1, 3)
    above = flat[:, 2] > 0
    solid = np.repeat(weights * height / 2, len(phi)) * (PI / count)
    values = f(np.broadcast_to(view, flat[above].shape), flat[above])
    weighted = (solid * flat[:, 2])[above]
    return np.asarray((weighted * values.T).sum(axis=-1))


ISOTROPIC = ashikhmin_shirley(20, 20)
ANISOTROPIC = ashikhmin_shirley(5, 40)


@pytest.fixture(scope="module")
def isotropic() -> Bsdf:
    return Bsdf.from_function(ISOTROPIC)


@pytest.fixture(scope="module")
def anisotropic() -> Bsdf:
    return Bsdf.from_function(ANISOTROPIC, isotropic=False)


@pytest.mark.parametrize(("cosine", "phi"), [(0.3, 0.7), (0.7, 2.0), (0.95, 4.0)])
@pytest.mark.parametrize("which", ["isotropic", pytest.param("anisotropic", marks=pytest.mark.slow)])
def test_a_function_is_reflected_within_twice_its_residual(
    which: str, cosine: float, phi: float, request: pytest.FixtureRequest
) -> None:
    f = ISOTROPIC if which == "isotropic" else ANISOTROPIC
    bsdf = request.getfixturevalue(which)
    view = direction(math.acos(cosine), phi)
    light, solid = hemisphere(60)
    truth = f(np.broadcast_to(view, light.shape), light) * light[:, 2]
    norm = math.sqrt((solid * truth**2).sum())
    lookup = math.sqrt((solid * (bsdf.evaluate(light, view) - truth) ** 2).sum()) / norm
    assert lookup <= 0.03
    for order in (4, 8, 16):
        expansion = shlight.evaluate(bsdf.coefficients(cosine, order, phi).astype(np.float64), light)
        error = math.sqrt((solid * (expansion - truth) ** 2).sum()) / norm
        residual = float(bsdf.residual(cosine, order, phi))
        assert error <= 2 * residual
        assert residual <= 2 * error + 0.01


def test_a_table_is_printed_as_one_lobe() -> None:
    angles = {"theta_in": [0.0, 1], "phi_in": [0.0], "theta_out": [0.0, 1], "phi_out": [0.0]}
    grey, colored = (Bsdf.from_table(np.ones((2, 1, 2, 1, *channels)), **angles) for channels in ((), (3,)))
    assert repr(colored * [0.5, 1, 2]) == "Bsdf(table * (0.5, 1, 2))"
    assert repr(grey + Bsdf.lambert(0.5) + colored + colored) == (
        "Bsdf(table * (1, 1, 1) + lambert * (0.5, 0.5, 0.5) + table * (1, 1, 1) + table * (1, 1, 1))"
    )


@pytest.mark.parametrize("which", ["isotropic", pytest.param("anisotropic", marks=pytest.mark.slow)])
def test_lights_under_a_function(which: str, request: pytest.FixtureRequest) -> None:
    f = ISOTROPIC if which == "isotropic" else ANISOTROPIC
    bsdf = request.getfixturevalue(which)
    rng = np.random.default_rng(3)
    light, solid = hemisphere(40)
    for _ in range(12):
        cosine, phi = rng.uniform(0.1, 1), rng.uniform(0, 2 * PI)
        view = direction(math.acos(cosine), phi)
        center = rng.normal(size=3) + np.array([0, 0, 0.5])
        center *= 2 / np.linalg.norm(center)
        radius = rng.uniform(0.05, 1.5)
        albedo = (solid * light[:, 2] * f(np.broadcast_to(view, light.shape), light)).sum()
        truth = over_sphere(f, view, center, radius)
        norm = math.sqrt((solid * (light[:, 2] * f(np.broadcast_to(view, light.shape), light)) ** 2).sum())
        size = math.sqrt(2 * PI * (1 - math.sqrt(1 - (radius / 2) ** 2)))
        shaded = shlight.shade_spheres(center, radius, bsdf, cosine, phi_o=phi, order="auto")
        assert abs(shaded[0] - truth) <= 5e-3 * albedo
        harmonics = shlight.shade_spheres(center, radius, bsdf, cosine, phi_o=phi, order=16)
        plain = float((shlight.sphere_coefficients(center, radius, 16) * bsdf.coefficients(cosine, 16, phi)).sum())
        bound = 2 * float(bsdf.residual(cosine, 16, phi)) * norm * size  # Cauchy–Schwarz
        assert abs(plain - truth) <= bound
        if which == "anisotropic":  # interpolated between views
            assert abs(harmonics[0] - max(plain, 0)) <= 5e-3 * albedo


def test_polygons_and_disks_turn_with_the_view() -> None:
    anisotropic = Bsdf.from_function(ANISOTROPIC, isotropic=False, order=16, samples=16)
    center, u, v = np.array([0.6, 0.3, 1.0]), np.array([0.4, 0, 0.1]), np.array([0, 0.5, 0])
    corners = np.stack([center - u - v, center + u - v, center + u + v, center - u + v])
    phi = 1.1
    for order in ("auto", 16):
        whole = shlight.shade_polygons(corners, anisotropic, 0.7, phi_o=phi, order=order)
        halves = np.stack([corners[[0, 1, 2]], corners[[0, 2, 3]]])
        parts = shlight.shade_polygons(halves, anisotropic, 0.7, phi_o=[phi, phi], order=order)
        np.testing.assert_allclose(parts.sum(axis=0), whole, rtol=2e-3)
        # A disk is a polygon of many corners.
        around = np.linspace(0, 2 * PI, 400, endpoint=False)[:, None]
        polygon = shlight.shade_polygons(
            center + np.cos(around) * u + np.sin(around) * v, anisotropic, 0.7, phi_o=phi, order=order
        )
        disk = shlight.shade_disks(center, u, v, anisotropic, 0.7, phi_o=phi, order=order)
        np.testing.assert_allclose(disk, polygon, rtol=3e-3)


def test_an_isotropic_material_does_not_mind_how_it_lies(isotropic: Bsdf) -> None:
    center, phi = np.array([-0.7, 0.4, 0.8]), 2.2
    turned = [
        center[0] * math.cos(phi) - center[1] * math.sin(phi),
        center[0] * math.sin(phi) + center[1] * math.cos(phi),
        center[2],
    ]
    expected = shlight.shade_spheres(center, 0.3, isotropic, 0.6)
    np.testing.assert_allclose(shlight.shade_spheres(turned, 0.3, isotropic, 0.6, phi_o=phi), expected, rtol=1e-5)


def test_lambert_as_a_function_and_as_a_table() -> None:
    theta, phi = np.linspace(0, PI / 2, 10), np.linspace(0, 2 * PI, 24, endpoint=False)
    matte = Bsdf.lambert(0.6)
    for own in (
        Bsdf.from_function(lambda view, light: np.full(len(view), 0.6 / PI)),
        Bsdf.from_table(np.full((10, 24, 10, 24), 0.6 / PI), theta, phi, theta, phi),
        Bsdf.from_table(np.full((10, 1, 10, 24), 0.6 / PI), theta, [0.0], theta, phi),
    ):
        for order in ("auto", 3):
            shaded = shlight.shade_spheres([0.5, 0.2, 1.0], 0.4, own, 0.6, order=order)
            np.testing.assert_allclose(
                shaded, shlight.shade_spheres([0.5, 0.2, 1.0], 0.4, matte, 0.6, order=order), rtol=2e-4
            )


def synthetic(theta_in: Floats, phi_in: Floats, theta_out: Floats, phi_out: Floats, f: Function) -> Floats:
    grids = np.meshgrid(theta_in, phi_in, theta_out, phi_out, indexing="ij")
    light, view = direction(grids[0], grids[1]), direction(grids[2], grids[3])
    return f(view.reshape(-1, 3), light.reshape(-1, 3)).reshape(grids[0].shape)


def test_a_table_is_linear_between_its_angles() -> None:
    rng = np.random.default_rng(0)
    theta, phi = np.array([0.1, 0.5, 1.1, PI / 2]), np.linspace(0, 2 * PI, 7)[:-1] + 0.1
    values = rng.uniform(0, 1, (4, 6, 4, 6, 3))
    bsdf = Bsdf.from_table(values, theta, phi, theta, phi, order=4)
    assert bsdf.is_anisotropic
    for i in np.ndindex(3, 6, 3, 6):
        wi, wo = direction(theta[i[0]], phi[i[1]]), direction(theta[i[2]], phi[i[3]])
        np.testing.assert_allclose(bsdf.evaluate(wi, wo), values[i] * wi[2], rtol=1e-5)
    middle = bsdf.evaluate(direction(0.8, phi[1]), direction(0.5, phi[5] + PI / 6)) / math.cos(0.8)
    corners = [values[i, 1, 1, k] for i in (1, 2) for k in (5, 0)]
    np.testing.assert_allclose(middle, np.mean(corners, axis=0), rtol=1e-5)


def test_half_a_circle_of_an_isotropic_table_is_mirrored() -> None:
    theta, half = np.linspace(0, 1.5, 12), np.linspace(0, PI, 13)
    whole = np.linspace(0, 2 * PI, 25)
    tables = [
        Bsdf.from_table(synthetic(theta, np.zeros(1), theta, phi, ISOTROPIC), theta, [0.0], theta, phi)
        for phi in (half, whole)
    ]
    light, _ = hemisphere(9)
    view = direction(0.7, 0.4)
    assert not tables[0].is_anisotropic
    np.testing.assert_allclose(tables[0].evaluate(light, view), tables[1].evaluate(light, view), rtol=1e-5)


@pytest.mark.parametrize("order", ["auto", 16])
def test_energy_of_a_table(anisotropic: Bsdf, order: int | str) -> None:
    """A light all around reflects the albedo."""
    light, solid = hemisphere(60)
    for cosine, phi in ((0.2, 1.0), (0.8, 3.0)):
        view = direction(math.acos(cosine), phi)
        albedo = (solid * anisotropic.evaluate(light, view)).sum()
        dome = shlight.shade_spheres([0.0, 0.0, 1e-3], 1e-3, anisotropic, cosine, phi_o=phi, order=order)
        np.testing.assert_allclose(dome, albedo, rtol=5e-3)


def write_merl(path: Path, f: Function) -> None:
    theta_h = (np.arange(90) / 90) ** 2 * PI / 2
    theta_d, phi_d = np.radians(np.arange(90)), np.radians(np.arange(180))
    h, d, p = np.meshgrid(theta_h, theta_d, phi_d, indexing="ij")
    half, along, beside = direction(h, 0.0), direction(h + PI / 2, 0.0), np.array([0.0, 1.0, 0.0])
    away = np.cos(p)[..., None] * along + np.sin(p)[..., None] * beside
    light = np.cos(d)[..., None] * half + np.sin(d)[..., None] * away
    view = np.cos(d)[..., None] * half - np.sin(d)[..., None] * away
    with np.errstate(all="ignore"):
        values = f(view.reshape(-1, 3), light.reshape(-1, 3)).reshape(h.shape)
    seen = (light[..., 2] > 0) & (view[..., 2] > 0)
    channels = [np.where(seen, values / scale * 1500, -1.0) for scale in (1.0, 1.15, 1.66)]
    with path.open("wb") as file:
        np.array([90, 90, 180], "<i4").tofile(file)
        np.stack(channels).astype("<f8").tofile(file)


def test_merl(tmp_path: Path) -> None:
    path = tmp_path / "own.binary"
    write_merl(path, ISOTROPIC)
    bsdf = Bsdf.read(path)
    assert not bsdf.is_anisotropic
    light, solid = hemisphere(30)
    view = direction(0.8, 0.3)
    truth = ISOTROPIC(np.broadcast_to(view, light.shape), light) * light[:, 2]
    for channel in range(3):
        error = (solid * (bsdf.evaluate(light, view)[:, channel] - truth) ** 2).sum() / (solid * truth**2).sum()
        assert math.sqrt(error) <= 0.02


@pytest.mark.slow
def test_a_metal_takes_cubature(tmp_path: Path) -> None:
    """Sixteen bands do not hold its peak; harmonics in the boost of its width, and cubature, do."""
    f = ashikhmin_shirley(3000, 3000, 0.9, 0.0)
    path = tmp_path / "metal.binary"
    write_merl(path, f)
    bsdf = Bsdf.read(path)
    assert bsdf.residual(0.8, 16) > 0.5
    view = direction(math.acos(0.8), 0.0)
    light, solid = hemisphere(200)
    albedo = (solid * bsdf.evaluate(light, view)[:, 0]).sum()
    for center, radius in (([-0.7, 0.05, 0.8], 0.06), ([-0.5, 0.2, 0.9], 0.5), ([-1.0, 0.3, 0.5], 0.3)):
        shaded = shlight.shade_spheres(center, radius, bsdf, 0.8)
        truth = over_sphere(lambda v, w: bsdf.evaluate(w, v) / w[:, 2:], view, np.array(center), radius)
        np.testing.assert_allclose(shaded, truth, atol=5e-3 * albedo)


def write_utia(path: Path, values: Floats) -> None:
    np.moveaxis(values, -1, 0).astype("<f8").tofile(path)


def fabric() -> Floats:
    """A BRDF (6, 48, 6, 48, 3) with threads along x and y."""
    theta, phi = np.radians(15.0 * np.arange(6)), np.radians(7.5 * np.arange(48))
    warp = synthetic(theta, phi, theta, phi, ashikhmin_shirley(3, 30, 0.1, 0.2))
    weft = synthetic(theta, phi, theta, phi, ashikhmin_shirley(30, 3, 0.1, 0.2))
    return np.stack([warp, weft, (warp + weft) / 2], axis=-1)


@pytest.fixture(scope="module")
def woven(tmp_path_factory: pytest.TempPathFactory) -> Bsdf:
    """The fabric, read from a file."""
    path = tmp_path_factory.mktemp("woven") / "fabric.bin"
    write_utia(path, fabric())
    return Bsdf.read(str(path), order=16)


def test_utia(woven: Bsdf) -> None:
    bsdf, values = woven, fabric()
    assert bsdf.is_anisotropic
    theta, phi = np.radians(15.0 * np.arange(6)), np.radians(7.5 * np.arange(48))
    for i in ((0, 0, 3, 5), (2, 7, 4, 40), (5, 47, 5, 0)):
        wi, wo = direction(theta[i[0]], phi[i[1]]), direction(theta[i[2]], phi[i[3]])
        np.testing.assert_allclose(bsdf.evaluate(wi, wo), values[i] * wi[2], rtol=1e-5)
    # Beyond 75° the last step goes on, but not below 0.
    wi, wo = direction(math.radians(90 - 1e-6), phi[3]), direction(theta[2], phi[5])
    beyond = np.maximum(2 * values[5, 3, 2, 5] - values[4, 3, 2, 5], 0)
    np.testing.assert_allclose(bsdf.evaluate(wi, wo) / wi[2], beyond, rtol=1e-3)


def fabric_ball(bsdf: Bsdf) -> shlight.Scene:
    scene = shlight.Scene()
    count = 96
    phi, theta = np.meshgrid(np.linspace(0, 2 * PI, count + 1), np.linspace(0, PI, count // 2 + 1))
    points = direction(theta, phi).reshape(-1, 3)
    i, k = (n.ravel() for n in np.meshgrid(np.arange(count // 2), np.arange(count), indexing="ij"))
    a = i * (count + 1) + k
    b = a + count + 1
    scene.add_mesh(
        points, np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)]), normals=points, bsdf=bsdf
    )
    for center, radius, radiance in (
        ([3, -2, 3], 1.0, [8, 7, 6]),
        ([-3, -3, 1], 0.6, [5, 8, 9]),
        ([0, -4, -2], 0.3, [9, 9, 9]),
    ):
        scene.add_sphere_light(center, radius, radiance)
    camera = np.array([[1.0, 0, 0, 0], [0, 0, -1, -4], [0, 1, 0, 0], [0, 0, 0, 1]])
    scene.set_camera(camera, 0.6)
    return scene


def test_a_ball_of_fabric_against_monte_carlo(woven: Bsdf) -> None:
    scene = fabric_ball(woven)
    image = shlight.render(scene, 16, 16, order=16, max_bounces=0, shadows=False, min_samples=64, max_samples=64)
    truth = methods.render_monte_carlo(scene, 16, 16, samples=1024)
    seen = truth[..., 3] > 0.999
    error = (image[seen][:, :3] - truth[seen][:, :3]) ** 2 / (
        truth[seen][:, :3] ** 2 + 1e-2 * truth[seen][:, :3].mean() ** 2
    )
    assert error.mean() <= 1e-3


def test_pickles_and_copies() -> None:
    light, _ = hemisphere(5)
    for bsdf in (
        Bsdf.from_function(ISOTROPIC, order=8, samples=8) * [1, 0.5, 0.2],
        Bsdf.from_function(ANISOTROPIC, isotropic=False, order=8, samples=8) + Bsdf.lambert(0.1),
    ):
        for other in (pickle.loads(pickle.dumps(bsdf)), copy.deepcopy(bsdf)):
            np.testing.assert_array_equal(other.evaluate(light, [0, 0.6, 0.8]), bsdf.evaluate(light, [0, 0.6, 0.8]))
            if not bsdf.is_anisotropic:  # which takes seconds before it shades
                lit = [shlight.shade_spheres([0, 0.3, 1.0], 0.3, b, 0.8, order=8) for b in (bsdf, other)]
                np.testing.assert_array_equal(*lit)


def test_only_order() -> None:
    bsdf = Bsdf.from_function(ISOTROPIC, order=8, samples=16)
    _, effort = shlight.shade_spheres([-0.4, 0, 1.0], 0.9, bsdf, 0.9, tolerance=0.05, return_effort=True)
    assert effort == 8


@pytest.mark.parametrize(
    ("f", "message"),
    [
        (lambda view, light: -light[:, 2], r"f must return numbers in 0 … 1e10"),
        (lambda view, light: light[:, 2] * np.nan, r"f must return numbers in 0 … 1e10"),
        (lambda view, light: light[:5, 2], r"f must return an array"),
        (lambda view, light: "x", r"f must return real numbers"),
        (lambda view, light: np.ones(len(view)) + light[:, 0], r"f must return the same for directions"),
        (lambda view, light: 1 + np.cross(view, light)[:, 2], r"f must return the same for .* mirrored"),
    ],
)
def test_functions_that_are_refused(f: Function, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Bsdf.from_function(f, samples=8)


def test_files_that_are_refused(tmp_path: Path) -> None:
    empty, short, nan, negative, other = (
        tmp_path / f"{name}.bin" for name in ("empty", "short", "nan", "negative", "other")
    )
    empty.touch()
    short.write_bytes(b"x" * 1000)
    values = fabric()
    values[0, 0, 0, 0, 0] = np.nan
    write_utia(nan, values)
    values[0, 0, 0, 0, 0] = -1
    write_utia(negative, values)
    with other.open("wb") as file:
        np.array([2**31 - 1, 2**31 - 1, 2**31 - 1], "<i4").tofile(file)
        file.truncate(12 + 3 * 90 * 90 * 180 * 8)
    for path, message in (
        (empty, "has 0 bytes"),
        (short, "has 1000 bytes"),
        (nan, "not finite"),
        (negative, "negative"),
        (other, "begins with"),
    ):
        with pytest.raises(ValueError, match=f"{path}.*{message}"):
            Bsdf.read(path)
    with pytest.raises(FileNotFoundError):
        Bsdf.read(tmp_path / "missing.bin")


def test_a_method_of_an_anisotropic_material_is_refused(anisotropic: Bsdf) -> None:
    with pytest.raises(ValueError, match="method must be 'auto' for an anisotropic bsdf"):
        shlight.shade_spheres([0, 0, 1.0], 0.2, anisotropic, 0.5, method="monte_carlo")


def sky() -> Floats:
    """A lat-long picture (16, 32, 3): a gradient, a bright window that is no square, and a sun of one texel."""
    picture = np.linspace(0.2, 1, 32)[None, :, None] * np.linspace(1, 0.3, 16)[:, None, None] * [1.0, 0.9, 0.7]
    picture[3:6, 5:12] = [6.0, 7, 8]
    picture[4, 26] = [400.0, 300, 200]
    return picture.astype(np.float32)


def radiance_of(picture: Floats, directions: Floats) -> Floats:
    """Bilinear between the centres of texels, and along a meridian constant beyond the outermost ones."""
    height, width = picture.shape[:2]
    column = (0.5 - np.arctan2(directions[:, 1], directions[:, 0]) / (2 * PI)) * width - 0.5
    row = np.clip(np.arccos(directions[:, 2]) / PI * height - 0.5, 0, height - 1)
    left, top = np.floor(column).astype(int), np.minimum(np.floor(row).astype(int), height - 2)
    s, t = (column - left)[:, None], (row - top)[:, None]
    upper, lower = ((1 - s) * picture[top + i, left % width] + s * picture[top + i, (left + 1) % width] for i in (0, 1))
    return np.asarray((1 - t) * upper + t * lower)


@pytest.fixture(scope="module")
def threads() -> Bsdf:
    """A table of directions, whose harmonics stay in the frame of the tangent."""
    angles = np.radians(15.0 * np.arange(6)), np.radians(7.5 * np.arange(48))
    return Bsdf.from_table(fabric()[..., 0], *angles, *angles)


@pytest.mark.parametrize("which", [pytest.param("anisotropic", marks=pytest.mark.slow), "threads"])
@pytest.mark.parametrize("wall", [False, True])
def test_a_picture_around_the_scene_lights_it(which: str, wall: bool, request: pytest.FixtureRequest) -> None:
    bsdf = request.getfixturevalue(which)
    turn = 0.4  # of the tangent about the normal
    floor = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    u = floor @ [math.cos(turn), math.sin(turn), 0]
    v = floor @ [-math.sin(turn), math.cos(turn), 0]
    scene = shlight.Scene()
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], uvs=np.stack([u, v], axis=-1), bsdf=bsdf)
    if wall:
        tall = np.array([[0.3, -1e4, -1e-3], [0.3, 1e4, -1e-3], [0.3, 1e4, 1e4], [0.3, -1e4, 1e4]])
        scene.add_mesh(tall, [[0, 1, 2], [0, 2, 3]], bsdf=Bsdf.lambert(0))
    scene.set_environment(sky())
    light, solid = hemisphere(250)
    incident = radiance_of(sky(), _about_z(light, turn)) * solid[:, None]
    if wall:
        incident[_about_z(light, turn)[:, 0] > 0] = 0
    views = np.stack([direction(tilt, phi) for tilt, phi in ((0.3, 4.0), (0.8, 2.2), (1.2, 3.0), (1.3, 1.9))])
    towards = _about_z(views, turn)
    expected = np.stack([bsdf.evaluate(light, view) @ incident for view in views])
    count = 64 if wall else 1
    asked = {"max_bounces": 0, "min_samples": count, "max_samples": count, "shadow_rays": 256}
    seen = scene.radiance(0.2 * towards, -towards, **asked)
    np.testing.assert_allclose(seen, expected, rtol=0.02 if wall else 5e-3)
    scene.set_camera(shlight.look_at(0.2 * towards[1], [0, 0, 0]), 1e-3)
    image = shlight.render(scene, 1, 1, **asked)
    np.testing.assert_allclose(image[0, 0, :3], expected[1], rtol=0.02 if wall else 5e-3)


def test_a_picture_tints_a_material(isotropic: Bsdf, threads: Bsdf) -> None:
    """Away from the edges of the tint, a pixel is the untinted one times the colour there."""
    checks = np.random.default_rng(4).uniform(0.1, 1, (4, 4, 3)).astype(np.float32)
    tint = shlight.nodes.image(checks, interpolation="closest", extension="extend")
    floor = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    for bsdf in (isotropic * [1, 0.5, 0.2] + Bsdf.lambert(0.1), threads, Bsdf.layer(Bsdf.ggx(0.4, 0.3), threads)):
        images = []
        for material in (bsdf, tint * bsdf):
            scene = shlight.Scene()
            scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], uvs=floor[:, :2] / 2 + 0.5, bsdf=material)
            scene.add_sphere_light((0.5, -0.4, 1), 0.3, 1)
            scene.set_environment(sky())
            scene.set_camera_window(shlight.look_at((0, 0, 3), (0, 0, 0), (0, 1, 0)), -1, 1, -1, 1, orthographic=True)
            images.append(shlight.render(scene, 12, 12, max_bounces=0, min_samples=4, max_samples=4)[1::3, 1::3, :3])
        np.testing.assert_allclose(images[1], images[0] * checks, rtol=1e-3)
    with pytest.raises(ValueError, match=r"factor must lie in \[0, 1e\+10\]"):
        shlight.nodes.scaled(threads, -1.0)


def _about_z(directions: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(directions @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]]))
