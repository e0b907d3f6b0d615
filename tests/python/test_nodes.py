# SPDX-License-Identifier: MIT
"""Shader programs: what varies equals what is constant there."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import nodes
from shlight.nodes import energy
from shlight.nodes.values import in_order, number
from shlight_tools.energy import TABLES

STRIPS = np.linspace(0.05, 1.0, 6)


def floor(bsdf: Any, light: str, indices: Any = None, strips: Any = STRIPS) -> Any:
    """A floor of strips with a material or a texture coordinate each, under one light without shadows."""
    count = len(strips)
    left = -2 + 4 * np.arange(count) / count
    x = np.stack([left, left + 4 / count, left + 4 / count, left], axis=1).ravel()
    vertices = np.stack([x, np.tile([-2.0, -2.0, 2.0, 2.0], count), np.zeros(4 * count)], axis=1)
    first = 4 * np.arange(count)[:, None]
    triangles = np.concatenate([np.add(first, [0, 1, 2]), np.add(first, [0, 2, 3])], axis=1).reshape(-1, 3)
    uvs = np.stack([np.repeat(strips, 4), np.zeros(4 * count)], axis=1)
    scene = shlight.Scene()
    scene.add_mesh(vertices, triangles, uvs=uvs, bsdf=bsdf, material_indices=indices)
    if light == "sphere":
        scene.add_sphere_light((0.3, 1, 1.5), 0.4, (5, 5, 5))
    elif light == "polygon":
        scene.add_polygon_light([[-1, 2, 0.5], [1, 2, 0.5], [1, 2, 2], [-1, 2, 2]], (5, 4, 3))
    elif light == "point":
        scene.add_point_light((0, 1, 1), (3, 3, 3))
    else:
        scene.set_environment(np.random.default_rng(1).uniform(0, 1, (16, 32, 3)))
    pose = np.eye(4)
    pose[1:3, 1:3] = [[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]]
    pose[:3, 3] = 0, -5, 3.2
    scene.set_camera(pose, 0.8)
    return shlight.render(scene, 48, 32, pixel_samples=4, max_samples=4, shadow_rays=0, max_bounces=0)


@pytest.mark.parametrize(
    ("light", "ior"),
    [
        *itertools.product(["sphere", "polygon", "point"], [None, 1.5]),
        pytest.param("environment", None, marks=pytest.mark.slow),
        ("environment", 1.5),
    ],
)
def test_a_width_that_varies(light: str, ior: float | None) -> None:
    base = shlight.Bsdf.lambert((0.1, 0.2, 0.3))
    f0 = (0.5, 0.3, 0.1)
    strips = STRIPS[1::2] if light == "environment" else STRIPS  # which is blurred for each, and that takes seconds
    materials = [shlight.Bsdf.ggx(float(r), f0, ior=ior) + base for r in strips]
    constant = floor(materials, light, np.repeat(np.arange(len(strips)), 2), strips)
    varying = floor(nodes.ggx(nodes.uv().x, f0, ior=ior) + nodes.lambert((0.1, 0.2, 0.3)), light, strips=strips)
    error = np.abs(varying - constant)[..., :3] / (constant[..., :3] + 0.1 * constant[..., :3].mean())
    # Environments are blurred for steps of the width, between which they are linear.
    assert error.max() <= (2e-3 if light == "environment" else 1e-3)


@pytest.mark.parametrize("light", ["sphere", "polygon"])
def test_a_lobe_that_only_some_hits_have(light: str) -> None:
    base = shlight.Bsdf.lambert((0.1, 0.2, 0.3))
    f0 = (0.5, 0.3, 0.1)
    glossy = [shlight.Bsdf.ggx(float(r), f0) + base if r > 0.5 else base for r in STRIPS]
    constant = floor(glossy, light, np.repeat(np.arange(len(STRIPS)), 2))
    u = nodes.uv().x
    varying = floor(nodes.ggx(u, f0) * (u > 0.5) + nodes.lambert((0.1, 0.2, 0.3)), light)
    error = np.abs(varying - constant)[..., :3] / (constant[..., :3] + 0.1 * constant[..., :3].mean())
    assert error.max() <= 2e-3  # the tolerance of either picture


def test_a_program_is_as_long_as_what_varies() -> None:
    half = nodes.values.number(0.5)
    assert nodes.lambert(nodes.mix_color((1, 0, 0), (0, 1, 0), half * half, "overlay")).operation_count == 0
    u = nodes.uv().x
    assert nodes.lambert(u * 2.0 + u * 2.0).operation_count == 2
    deep = u
    for _ in range(5000):
        deep = deep + 1.0
    assert nodes.lambert(deep).operation_count == 5000


@pytest.mark.parametrize("picture", [False, True])
def test_values_that_are_bent_again_and_again_share_what_is_below_them(picture: bool) -> None:
    """Each asks for what it bends without footprints, of which there is one copy, however many ask."""
    value = nodes.image(np.eye(4, dtype=np.float32)[..., None].repeat(3, axis=2)).x if picture else nodes.noise().x
    lengths = []
    for _ in range(12):
        value = value + nodes.map_range(value, 0.2, 0.9)
        lengths.append(len(list(in_order([value.step]))))
    assert np.ptp(np.diff(lengths)[1:]) == 0


def test_another_normal_counts_in_lobes_and_expressions() -> None:
    tilted = nodes.values.normalize(nodes.Vector(0.3, 0.2, 1.0))

    def shader(normal: nodes.Vector, at: nodes.Vector | None) -> Any:
        return nodes.glossy(0.6, 0.5, at=at) + nodes.emission(normal * 0.5 + 0.5)

    own = shader(nodes.normal(), None).with_normal(tilted)
    np.testing.assert_array_equal(floor(own, "polygon"), floor(shader(tilted, tilted), "polygon"))


@pytest.mark.parametrize("rule", ["ggx", "cubic"])
@pytest.mark.parametrize("degrees", [20, -15, -35, -60])
def test_bumps_shadow_themselves(rule: Any, degrees: float) -> None:
    """A small light, whose cosine counts at the bump's normal and not at the smooth one."""
    bump, light = (np.array([np.sin(np.radians(a)), 0, np.cos(np.radians(a))]) for a in (degrees, 50))
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)

    def pixel(bsdf: Any) -> float:
        scene = shlight.Scene()
        scene.add_mesh(square, [[0, 1, 2], [0, 2, 3]], bsdf=bsdf)
        scene.add_sphere_light(100 * light, 0.05, (1e6, 1e6, 1e6))
        pose = np.eye(4)
        pose[2, 3] = 5
        scene.set_camera(pose, 0.1)
        return float(shlight.render(scene, 1, 1, pixel_samples=1, max_bounces=0)[0, 0, 0])

    own = nodes.lambert(0.8, nodes.Vector(*map(nodes.values.number, bump))).with_bump_shadow(rule)
    smooth, leaning = light[2], bump @ light
    if rule == "ggx":
        alpha2 = min(np.tan(np.radians(degrees)) ** 2 / 8, 1)
        share = 2 / (1 + np.sqrt(1 + alpha2 * (1 / smooth**2 - 1)))
    else:
        g = np.clip(smooth / (leaning * bump[2]), 0, 1)
        share = g + g**2 - g**3
    expected = max(leaning, 0) * share / smooth * pixel(nodes.lambert(0.8))
    assert abs(pixel(own) - expected) <= 1e-3 * expected


def test_light_that_passes_through() -> None:
    # A lamp above a pane that passes a quarter of red and all of green, over a floor.
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float) * 3
    faces = [[0, 1, 2], [0, 2, 3]]

    def lit(pane: Any) -> Any:
        scene = shlight.Scene()
        scene.add_mesh(square, faces, bsdf=shlight.Bsdf.lambert(0.8))
        if pane is not None:
            scene.add_mesh(np.add(square, (0, 0, 1)), faces, bsdf=pane)
        scene.add_sphere_light((0, 0, 3), 0.3, (5, 5, 5))
        pose = np.eye(4)
        pose[:3, 3] = 0, 0, 0.8
        scene.set_camera(pose, 1.0)
        return shlight.render(scene, 8, 8, pixel_samples=1, max_bounces=0)

    np.testing.assert_allclose(
        lit(nodes.transparent((0.25, 1.0, 0.0)))[..., :3], lit(None)[..., :3] * (0.25, 1.0, 0.0), rtol=1e-4, atol=1e-7
    )


def test_the_surface_behind_the_last_that_light_passes_shines() -> None:
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    scene = shlight.Scene()
    green, red = (0.5, 1.0, 0.5), (1.0, 0.5, 0.5)
    for height, bsdf in ((0, nodes.emission((1, 2, 3))), (1, nodes.transparent(green)), (2, nodes.transparent(red))):
        scene.add_mesh(square * 3 + (0, 0, height), [[0, 1, 2], [0, 2, 3]], bsdf=bsdf)
    scene.set_camera(shlight.look_at((0, 0, 5), (0, 0, 0), up=(0, 1, 0)), fov_x=0.5)
    for passed, expected in ((0, (0, 0, 0)), (1, (0.5, 1.0, 0.75)), (2, (0.5, 1.0, 0.75))):
        image = shlight.render(scene, 4, 4, max_samples=1, max_bounces=0, transparent_bounces=passed)
        np.testing.assert_allclose(image[..., :3], np.broadcast_to(expected, (4, 4, 3)), rtol=1e-6)


def test_a_cut_out_picture_is_as_bright_from_afar() -> None:
    """Leaves whose picture is black where there is no leaf."""
    is_leaf = np.random.default_rng(4).uniform(size=(64, 64, 1)) < 0.25
    picture = nodes.image(np.repeat(is_leaf, 4, axis=2).astype(np.uint8) * 255, interpolation="closest")
    leaves = nodes.mix(nodes.transparent(), nodes.lambert(picture), picture.alpha)

    def mean_of(bsdf: Any) -> Any:
        scene = shlight.Scene()
        square = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
        uvs = [[0, 0], [4, 0], [4, 4], [0, 4]]
        scene.add_mesh(square, [[0, 1, 2], [0, 2, 3]], uvs=uvs, bsdf=bsdf)
        scene.add_sphere_light((0, 0, 9), 0.3, (5, 5, 5))
        pose = np.eye(4)
        pose[2, 3] = 2
        scene.set_camera(pose, 0.8)
        return shlight.render(scene, 16, 16, pixel_samples=16, max_samples=16, noise_threshold=0, max_bounces=0).mean(
            axis=(0, 1)
        )

    # A quarter of 4096 rays see a leaf: their number has a standard deviation of 2.7 %.
    np.testing.assert_allclose(mean_of(leaves), 0.25 * mean_of(nodes.lambert(1.0)), rtol=0.08)


@pytest.mark.parametrize("extension", ["repeat", "extend", "clip", "mirror"])
def test_a_picture_far_away_is_its_mean(extension: str) -> None:
    pixels = np.random.default_rng(2).uniform(0, 1, (13, 21, 3)).astype(np.float32)
    texture = nodes.image(pixels, extension=extension).x.step.data.core
    found = texture.sample(0.5, 0.5, (1.0, 0.0, 0.0, 1.0))
    if extension in ("repeat", "mirror"):
        np.testing.assert_allclose(found[:3], pixels.mean(axis=(0, 1)), rtol=0.1)
    assert np.isfinite(found).all()
    for place in (np.nan, np.inf, -1e30, 1e9):
        assert np.isfinite(texture.sample(place, 0.2, (0.0, 0.0, 0.0, 0.0))).all()
    # Without a footprint it is bilinear between the centres of texels.
    x, y = 4.25, 6.5
    found = texture.sample(x / 21, y / 13, (0.0, 0.0, 0.0, 0.0))
    rows = pixels[::-1]
    expected = 0.25 * rows[6, 3] + 0.75 * rows[6, 4]
    np.testing.assert_allclose(found[:3], expected, rtol=1e-5)


@pytest.mark.parametrize("texels", [2, 5, 11])
def test_beyond_an_extended_edge_a_picture_is_that_edge_from_afar(texels: int) -> None:
    size = 32
    pixels = np.ones((size, size, 1), np.float32)
    pixels[:, -1], pixels[-1] = 0.25, 0.5  # the edges u = 1 and v = 0
    texture = nodes.image(pixels, extension="extend").x.step.data.core
    footprint = (texels / size, 0.1 / size, 0.0, texels / size)
    for place, edge in (((1.4, 0.5), 0.25), ((0.5, -0.4), 0.5), ((2.5, -1.4), 0.5)):
        np.testing.assert_allclose(texture.sample(*place, footprint)[:3], edge, rtol=1e-5)


@pytest.mark.parametrize("interpolation", ["closest", "linear", "cubic"])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_a_picture_is_as_bright_from_afar(kind: type[np.generic], encoding: str, interpolation: str) -> None:
    """White noise, the worst case, against the mean of what is shown close up."""
    size, places = 16, 12  # places: of a texel, along each side
    pixels = np.random.default_rng(3).integers(0, np.iinfo(kind).max, (size, size), endpoint=True).astype(kind)
    texture = nodes.image(pixels, encoding=encoding, interpolation=interpolation).x.step.data.core
    near = (np.arange(size * places) + 0.5) / (size * places)
    mean = np.mean([texture.sample(u, v, (0.0, 0.0, 0.0, 0.0))[0] for u in near for v in near])
    # Simpson's rule sees little of the fourth power in a cubic spline's cell.
    tolerance = 3e-3 if (encoding, interpolation) == ("srgb", "cubic") else 1e-3
    far = (np.arange(2 * size) + 0.5) / (2 * size)
    for texels in (4, 8, 15):
        found = [texture.sample(u, v, (texels / size, 0.0, 0.0, texels / size))[0] for u in far for v in far]
        np.testing.assert_allclose(np.mean(found), mean, rtol=tolerance)


@pytest.mark.parametrize(
    ("extension", "reaches_over"), [("repeat", True), ("extend", False), ("clip", False), ("mirror", False)]
)
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_border_from_afar_holds_the_other_border_only_where_the_picture_repeats(
    interpolation: str, extension: str, reaches_over: bool
) -> None:
    pixels = np.zeros((8, 16, 3), dtype=np.uint8)
    pixels[:, 8:] = 255
    texture = nodes.image(pixels, encoding="srgb", interpolation=interpolation, extension=extension).x.step.data.core
    dark, light = (texture.sample(u, 0.5, (2 / 16, 0.0, 0.0, 2 / 8))[0] for u in (1.5 / 16, 14.5 / 16))
    assert (dark > 0.02) == reaches_over
    assert (light < 0.98) == reaches_over


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float16, np.float32])
def test_numbers_of_a_picture_keep_their_type(kind: type[np.generic]) -> None:
    random = np.random.default_rng(5)
    if np.issubdtype(kind, np.integer):
        pixels = random.integers(0, np.iinfo(kind).max, (4, 8, 3), endpoint=True).astype(kind)
        values, step = pixels / np.iinfo(kind).max, 0.5 / np.iinfo(kind).max
    else:
        pixels = (random.normal(0, 1, (4, 8, 3)) * 10.0 ** random.integers(-4, 4, (4, 8, 3))).astype(kind)
        pixels[0, 0] = np.nan, np.inf, -np.inf
        largest = min(float(np.finfo(kind).max), float(np.float32(1e15)))  # which bounds radiance
        values, step = np.nan_to_num(pixels.astype(float), nan=0.0, posinf=largest, neginf=-largest), 0.0
    texture = nodes.image(pixels, interpolation="closest").x.step.data.core
    bytes_of_means = max(pixels.itemsize, 2)
    size = 3 * (32 * pixels.itemsize + (8 + 2 + 1) * bytes_of_means)
    assert nodes.textures.texture_pixels(pixels).size_in_bytes == size

    def at(x: float, y: float, wide: float) -> Any:
        return texture.sample(x / 8, y / 4, (wide / 8, 0.0, 0.0, wide / 4))[:3]

    for row, column in np.ndindex(4, 8):
        found = at(column + 0.5, 3 - row + 0.5, 0.0)
        np.testing.assert_allclose(found, values[row, column], rtol=1e-7, atol=1e-7 * float(step > 0))
    # The second level rounds means of four to its type.
    block = values[2:, 2:4].mean(axis=(0, 1))
    rounding = 0.0 if step else float(np.finfo(kind).eps)
    np.testing.assert_allclose(
        at(3.0, 1.0, 2.0), block, rtol=rounding + 1e-6, atol=step + 1e-6 * abs(values[2:, 2:4]).max()
    )


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if "interface" in name else ()) for name in TABLES]
)
def test_kept_energies_are_what_computing_them_gives(name: str) -> None:
    np.testing.assert_allclose(energy.tables()[name].values, TABLES[name](), rtol=1e-6, atol=1e-7)


def test_operators_give_what_python_gives() -> None:
    numbers = (-1.5, 0.0, 0.25, 2.0)
    for a, b in itertools.product(numbers, numbers):
        u, v = number(a), number(b)
        for made, expected in (
            (u < v, a < b),
            (u <= b, a <= b),
            (a > v, a > b),
            (u >= v, a >= b),
            (nodes.equal(u, b), a == b),
        ):
            assert made.constant == float(expected)
        if b in (0.0, 2.0) or a > 0:
            assert (u**b).constant == pytest.approx(a**b, rel=1e-6)
            assert (a**v).constant == pytest.approx(a**b, rel=1e-6)
    assert (nodes.Vector(1, 2, 3) ** 2).constant == (1.0, 4.0, 9.0)
    assert (np.array([1.0, 2.0, 3.0]) * nodes.Vector(1, 2, 3)).constant == (1.0, 4.0, 9.0)
    assert (np.float64(2.0) - number(0.5)).constant == (np.array(2.0) - number(0.5)).constant == 1.5


def test_an_array_times_a_shader_is_a_shader() -> None:
    factor = np.array([0.25, 0.5, 1.0])
    assert (factor * nodes.lambert(0.5)).lobes[0].weight.constant == (0.125, 0.25, 0.5)


U = nodes.uv().x
REFUSED: dict[str, Any] = {
    "bool": lambda: bool(U > 0.5),
    "bool of a vector": lambda: bool(nodes.position()),
    "if": lambda: 1.0 if U > 0.5 else 0.0,
    "max": lambda: max(U, 0.5),
    "min": lambda: min(0.5, U),
    "chained": lambda: 0.2 < U < 0.5,
    "not": lambda: not U,
    "in": lambda: U in (0.5, 1.0),
    "==": lambda: U == 0.5,
    "!=": lambda: U != 0.5,
    "== of a vector": lambda: nodes.position() == 0,
    "array": lambda: np.ones(3) * U,
    "ufunc": lambda: np.sin(U),
    "vector < vector": lambda: nodes.position() > U,
}


@pytest.mark.parametrize("what", REFUSED)
def test_expressions_refuse_what_python_cannot_say(what: str) -> None:
    with pytest.raises(TypeError) as caught:
        REFUSED[what]()
    text = str(caught.value)
    assert "nodes." in text or what in ("array", "ufunc", "vector < vector")
