# SPDX-License-Identifier: MIT
"""Passes and light groups of shlight.render: against closed forms, against renders of fewer lights, and their sums."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, SQUARE, from_above, lit_floor

import shlight
from shlight import nodes
from shlight.images import write_layers
from shlight.metrics import rel_mse

Array = NDArray[np.float64]
WIDTH, HEIGHT, FOV = 24, 16, 0.9


def rotation(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def looking_down(scene: shlight.Scene) -> Array:
    """Sets a perspective camera; returns directions (height, width, 3) through the pixels' middles, not normalized."""
    to_world = np.eye(4)
    to_world[:3, :3] = rotation(1.2)
    to_world[:3, 3] = 0.0, -5.0, 3.5
    scene.set_camera(to_world, FOV)
    half = math.tan(FOV / 2)
    x = half * ((np.arange(WIDTH) + 0.5) * 2 / WIDTH - 1)
    y = -half * HEIGHT / WIDTH * ((np.arange(HEIGHT) + 0.5) * 2 / HEIGHT - 1)
    local = np.stack([*np.meshgrid(x, y), np.full((HEIGHT, WIDTH), -1.0)], axis=-1)
    return np.asarray(local @ to_world[:3, :3].T)


def ball(center: Any, radius: float, steps: int = 16) -> tuple[Array, NDArray[np.int64], Array]:
    theta, phi = np.linspace(0, np.pi, steps + 1), np.linspace(0, 2 * np.pi, 2 * steps, endpoint=False)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    normals = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(steps), np.arange(2 * steps), indexing="ij")
    a, b = (i * 2 * steps + j).ravel(), (i * 2 * steps + (j + 1) % (2 * steps)).ravel()
    faces = np.concatenate([np.stack([a, a + 2 * steps, b], 1), np.stack([b, a + 2 * steps, b + 2 * steps], 1)])
    return radius * normals + center, faces, normals


def test_places_of_a_floor_are_those_of_rays_through_the_middles() -> None:
    scene = lit_floor(uvs=FLOOR[:, :2] / 18 + 0.5, object_indices=7, material_pass_indices=[5])
    directions = looking_down(scene)
    names = ["depth", "position", "normal", "uv", "object_index", "material_index", "mist"]
    passes = shlight.render(scene, WIDTH, HEIGHT, max_samples=1, passes=names, mist=(4.0, 8.0, 2.0), max_bounces=0)
    along = -3.5 / directions[..., 2]
    position = np.array([0.0, -5.0, 3.5]) + along[..., None] * directions
    on_floor = (along > 0) & (np.abs(position[..., :2]) < 9).all(axis=-1)
    assert on_floor.any()
    assert not on_floor.all()
    distance = np.linalg.norm(position - [0.0, -5.0, 3.5], axis=-1)
    expected = {
        "depth": np.where(on_floor, along, 1e10)[..., None],
        "position": np.where(on_floor[..., None], position, 0.0),
        "normal": np.where(on_floor[..., None], [0.0, 0.0, 1.0], 0.0),
        "uv": np.where(on_floor[..., None], position / 18 + [0.5, 0.5, 1.0], 0.0),
        "object_index": np.where(on_floor, 7.0, 0.0)[..., None],
        "material_index": np.where(on_floor, 5.0, 0.0)[..., None],
        "mist": np.where(on_floor, np.clip((distance - 4) / 8, 0, 1) ** 2, 1.0)[..., None],
    }
    assert list(passes.layers) == ["combined", *names]
    for name, values in expected.items():
        np.testing.assert_allclose(passes[name], values, rtol=1e-5, atol=1e-5, err_msg=name)


def test_places_go_on_across_a_wide_picture() -> None:
    """Wider than what the core takes at once."""
    passes = shlight.render(lit_floor(), 2500, 2, pixel_samples=1, passes=["position"], max_bounces=0)
    steps = np.diff(passes["position"][..., 0], axis=1)
    np.testing.assert_allclose(steps, steps[0, 0], rtol=1e-2)


def all_kinds_of_light(far: bool) -> shlight.Scene:
    """Varying, mixed and transparent materials, and every way in which light reaches them.

    far: also 400 dim lights, which share shadow rays.
    """
    scene = shlight.Scene()
    scene.add_mesh(FLOOR / 3, FACES, bsdf=nodes.oren_nayar((0.5, 0.4, 0.3), 0.3))
    vertices, faces, normals = ball([-1.0, 0.0, 0.8], 0.7)
    shiny = nodes.lambert((0.8, 0.2, 0.1)) + nodes.emission(0.02)
    if not far:
        shiny = nodes.principled((0.8, 0.2, 0.1), roughness=0.6, several_bounces=True, emission_strength=0.02)
    scene.add_mesh(vertices, faces, normals=normals, bsdf=shiny, group="ball")
    scene.add_mesh(
        SQUARE + np.array([0.5, -1.0, 1.2]), FACES, bsdf=nodes.mix(nodes.transparent((0.9, 0.5, 0.6)), shiny, 0.4)
    )
    vertices, faces, _ = ball([1.2, 0.5, 0.6], 0.4)
    scene.add_mesh(vertices, faces, emission=(2.0, 1.0, 0.5), group="lantern")
    scene.add_mesh(0.3 * SQUARE + np.array([-2.0, 1.5, 0.5]), FACES, emission=(0.0, 3.0, 3.0), group="sheet")
    scene.add_sphere_light([2, -2, 4], 0.3, (60, 50, 40), group="key", camera=True)
    scene.add_polygon_light(0.5 * SQUARE[::-1] + np.array([0.0, 2.0, 3.0]), (5, 5, 9), group="fill", spread=1.5)
    scene.add_spot_light([0, 2, 3], (0, -0.5, -1), 0.8, 0.3, (3, 3, 1), group="spot")
    scene.add_sun_light([0.3, 0.2, -1], 0.02, (0.5, 0.3, 0.3))
    sky = np.random.default_rng(0).random((8, 16, 3)).astype(np.float32) * 0.3
    scene.set_environment(sky, group="sky")
    random = np.random.default_rng(4)
    for i in range(400 if far else 0):
        place = random.normal(size=3)
        place *= 1000.0 / np.linalg.norm(place)
        place[2] = abs(place[2])
        scene.add_point_light(place, random.uniform(500, 2000, 3), group=f"far {i % 3}")
    return scene


def groups_of(passes: dict[str, Any]) -> dict[str, Array]:
    return {
        name.removeprefix("combined_"): light.astype(np.float64)
        for name, light in passes.items()
        if name.startswith("combined_")
    }


@pytest.mark.parametrize("bounces", [0, 2])
@pytest.mark.parametrize("far", [False, True])
def test_parts_of_the_light_add_up_to_the_picture_and_do_not_change_it(far: bool, bounces: int) -> None:
    scene = all_kinds_of_light(far)
    scene.add_mesh(
        SQUARE @ rotation(-1.3).T + np.array([-0.5, 1.5, 1.0]), FACES, bsdf=shlight.Bsdf.ggx(0, (0.9, 0.8, 0.7))
    )
    vertices, faces, normals = ball([0.3, -1.8, 0.5], 0.5)
    scene.add_mesh(vertices, faces, normals=normals, bsdf=nodes.glass((0.9, 1.0, 0.8), 0.1, 1.4))
    pane = nodes.mix(nodes.refraction(0.7, 0.0, 1.2), nodes.translucent(0.6), 0.5)
    scene.add_mesh(0.5 * SQUARE @ rotation(0.6).T + np.array([1.6, 1.5, 1.5]), FACES, bsdf=pane)
    looking_down(scene)
    kinds_of_light = ("diffuse", "glossy", "transmission")
    names = [f"{kind}_{part}" for kind in kinds_of_light for part in ("direct", "indirect", "color")]
    names += ["emission", "environment"]
    options: dict[str, Any] = {"max_samples": 16, "pixel_filter": "blackman_harris", "max_bounces": bounces}
    options["tolerance"] = 0.01
    passes = shlight.render(scene, WIDTH, HEIGHT, passes=names, groups=True, **options)
    picture = shlight.render(scene, WIDTH, HEIGHT, **options)
    np.testing.assert_array_equal(passes["combined"], picture)
    groups = groups_of(passes)
    expected = {"", "ball", "lantern", "sheet", "key", "fill", "spot", "sky"}
    assert set(groups) == (expected | {"far 0", "far 1", "far 2"} if far else expected)
    assert all(light.max() > 0 for light in groups.values())
    largest = float(picture[..., :3].max())
    direct, indirect = (
        {kind: passes[f"{kind}_{part}"] * passes[f"{kind}_color"] for kind in kinds_of_light}
        for part in ("direct", "indirect")
    )
    kinds = sum([*direct.values(), *indirect.values(), passes["emission"], passes["environment"]])
    assert np.abs(kinds - picture[..., :3]).max() <= 2e-6 * largest
    assert all((light.max() > 0) == (bounces > 0) for light in [*indirect.values(), direct["transmission"]])
    assert np.abs(sum(groups.values()) - picture[..., :3]).max() <= 2e-6 * largest


def test_direct_passes_do_not_change_when_light_bounces() -> None:
    """A room with a mirror, gloss and diffuse surfaces: what direct light gives there stays in its passes."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR / 4, FACES, bsdf=shlight.Bsdf.lambert((0.7, 0.6, 0.5)))
    for side, alpha in ((-1.2, 0.0), (1.2, 0.3)):
        wall = SQUARE @ rotation(-1.3).T + np.array([side, 1.0, 0.9])
        scene.add_mesh(wall, FACES, bsdf=shlight.Bsdf.ggx(alpha, (0.9, 0.9, 0.9)))
    vertices, faces, _ = ball([0.0, -0.5, 0.5], 0.5)
    scene.add_mesh(vertices, faces, bsdf=shlight.Bsdf.lambert((0.2, 0.4, 0.8)))
    scene.add_polygon_light(0.5 * SQUARE[::-1] + np.array([0.0, 0.0, 3.0]), (9, 9, 9), camera=True)
    scene.set_environment((0.1, 0.2, 0.3))
    looking_down(scene)
    names = [f"{kind}_{part}" for kind in ("diffuse", "glossy") for part in ("direct", "indirect")]
    options: dict[str, Any] = {"passes": names, "noise_threshold": 0, "max_samples": 256}
    direct, bounced = (shlight.render(scene, WIDTH, HEIGHT, max_bounces=bounces, **options) for bounces in (0, 2))
    for kind in ("diffuse", "glossy"):
        assert rel_mse(bounced[f"{kind}_direct"], direct[f"{kind}_direct"]) <= 1e-3, kind
        assert not direct[f"{kind}_indirect"].any()
        assert bounced[f"{kind}_indirect"].max() > 0.05


@pytest.mark.slow
def test_a_group_has_the_light_of_its_lamps_after_all_bounces() -> None:
    """Each group's light differs from a render of its lamps alone by no more than renders of other seeds do."""

    def scene_of(groups: tuple[str, ...]) -> shlight.Scene:
        scene = shlight.Scene()
        for place, turn, bsdf in (
            ((0, 0, 0), 0.0, nodes.lambert((0.7, 0.6, 0.5))),
            ((0, 2, 1), np.pi / 2, nodes.lambert((0.3, 0.7, 0.4)) + nodes.ggx(0.3, (0.1, 0.1, 0.1))),
        ):
            scene.add_mesh(3 * SQUARE @ rotation(turn).T + np.array(place), FACES, bsdf=bsdf)
        mirror = SQUARE @ rotation(1.2).T + np.array([-1.5, 1.2, 1.0])
        scene.add_mesh(mirror, FACES, bsdf=shlight.Bsdf.ggx(0, (0.9, 0.8, 0.7)))
        for place, bsdf in (
            ([0.4, -0.6, 0.6], nodes.glass((0.9, 1.0, 0.8), 0.0, 1.4)),
            ([1.7, 0.5, 0.6], nodes.lambert((0.8, 0.3, 0.2))),
        ):
            vertices, faces, normals = ball(place, 0.6)
            scene.add_mesh(vertices, faces, normals=normals, bsdf=bsdf)
        vertices, faces, _ = ball([-0.6, 0.6, 0.5], 0.3)
        scene.add_mesh(vertices, faces, emission=(3, 2, 1) if "lantern" in groups else None, group="lantern")
        if "key" in groups:
            scene.add_sphere_light([2, -2, 3], 0.3, (30, 25, 20), group="key", camera=True)
        if "fill" in groups:
            corners = 0.5 * SQUARE[::-1] + np.array([-1.5, 0.0, 3.0])
            scene.add_polygon_light(corners, (3, 4, 6), group="fill", camera=True)
        if "dim" in groups:  # in front of one another: they share shadow rays
            for side in (-1.0, 1.0):
                scene.add_sphere_light([1.5 * side, 1.0, 2.5], 0.1, (3, 3, 1), group="dim")
        if "point" in groups:
            scene.add_point_light([0, -1, 2], (0.3, 0.6, 0.3), group="point")
        if "sky" in groups:
            scene.set_environment((0.1, 0.15, 0.2), group="sky")
        looking_down(scene)
        return scene

    names = ("lantern", "key", "fill", "dim", "point", "sky")
    options: dict[str, Any] = {"noise_threshold": 0.01, "max_samples": 64, "max_bounces": 3}
    groups = groups_of(shlight.render(scene_of(names), WIDTH, HEIGHT, groups=True, **options))
    picture = sum(groups.values())
    scale = picture + 0.1 * picture.mean()
    for name in names:
        alone = [shlight.render(scene_of((name,)), WIDTH, HEIGHT, seed=i, **options)[..., :3] for i in range(3)]
        mean = np.mean(alone, axis=0, dtype=np.float64)
        error, *errors = (float(np.mean(((image - mean) / scale) ** 2)) for image in (groups[name], *alone))
        total, *totals = (abs(image.mean() / mean.mean() - 1) for image in (groups[name], *alone))
        print(f"{name}: {error:.1e} of {np.mean(errors):.1e}, {total:.1e} of {np.max(totals):.1e}")
        # The group's noise is that of the picture, whose threshold is 1e-2; the mean of the renders has some too.
        assert error <= 4 * np.mean(errors) + 2.5e-5, name
        assert total <= 3 * np.max(totals) + 1e-3, name


def test_a_picture_without_time_lies_between_the_pixels_that_it_has() -> None:
    """Passes too, whose sum it stays; the denoiser's guides are those of each pixel's own middle."""
    scene = shlight.Scene()
    scene.add_mesh(
        4 * FLOOR, FACES, bsdf=nodes.lambert(0.5 + 0.4 * nodes.values.operation("sine", 9.0 * nodes.position().x))
    )
    scene.add_sphere_light([0, 0, 3], 1.0, (5, 5, 5), group="lamp")
    from_above(scene, 6.0)
    names = ["diffuse_direct", "diffuse_color", "denoising_albedo", "denoising_normal"]
    options: dict[str, Any] = {"passes": names, "groups": True, "max_bounces": 0, "min_samples": 1, "max_samples": 4}
    whole = shlight.render(scene, 128, 128, **options)
    early = shlight.render(scene, 128, 128, **options, time_limit=1e-9)
    assert len(np.unique(early["combined"][..., 0])) > 8000, "most pixels have a colour of their own"
    for image in (early["diffuse_direct"] * early["diffuse_color"], groups_of(early)["lamp"]):
        np.testing.assert_allclose(image, early["combined"][..., :3], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(early["denoising_normal"], whole["denoising_normal"], atol=1e-6)
    middles = 12 * (np.arange(128) + 0.5) / 128 - 6
    albedo = np.broadcast_to(0.5 + 0.4 * np.sin(9 * middles), (128, 128))
    np.testing.assert_allclose(early["denoising_albedo"][..., 1], albedo, atol=1e-4)


def test_light_on_a_colour_without_green_is_the_mean_of_the_others() -> None:
    """Cycles gives a channel whose colour is 0 the mean of the light in the other channels."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, bsdf=shlight.Bsdf.lambert([0.8, 0.0, 0.4]))
    scene.add_sphere_light([0, 0, 2], 0.5, [4, 3, 2])
    passes = shlight.render(from_above(scene), 4, 4, passes=["diffuse_direct"], max_samples=1, max_bounces=0)
    red, green, blue = np.moveaxis(passes["diffuse_direct"], -1, 0)
    np.testing.assert_allclose(red, 2 * blue, rtol=1e-5)
    np.testing.assert_allclose(green, (red + blue) / 2, rtol=1e-5)


def test_far_lights_are_told_apart() -> None:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES)
    for side in (-1, 1):
        for i in range(200):
            angle = 2 * np.pi * i / 200
            place = [600 * side, 5 * np.cos(angle), 400 + 5 * np.sin(angle)]
            scene.add_point_light(place, (100, 100, 100), group=str(side))
    scene.add_mesh(SQUARE @ [[0, 0, 1], [0, 1, 0], [1, 0, 0]] + [0.5, 0, 1], FACES)
    from_above(scene)
    passes = shlight.render(scene, 16, 16, groups=True, max_samples=16, tolerance=0.05, max_bounces=0)
    groups = groups_of(passes)
    way = np.array([600.0, 0.0, 400.0])
    irradiance = 200 * 100 * way[2] / np.linalg.norm(way) ** 3 / np.pi * 0.8
    # Left of the wall the lights of the right are hidden, and those of the left shine.
    np.testing.assert_allclose(groups["-1"][8, 7], irradiance * np.ones(3), rtol=0.03)
    assert groups["1"][8, 7].max() <= 0.02 * irradiance


def test_cryptomatte_names_things_and_shares_pixels() -> None:
    from shlight._core import cryptomatte_hash

    # https://en.wikipedia.org/wiki/MurmurHash lists these for the seed 0.
    assert [cryptomatte_hash(text) for text in ("", "test", "Hello, world!")] == [0, 0xBA6BD213, 0xC0363E43]
    scene = shlight.Scene()
    left = SQUARE + np.array([-1, 0, 0])
    both = np.stack([np.eye(4), np.eye(4)])
    both[1, 0, 3] = 2.0
    scene.add_mesh(
        left, FACES, transforms=both, object_names=["left", "right"], asset_names="pair", material_names=["matt"]
    )
    from_above(scene, 4.0)
    names = [f"cryptomatte_{kind}" for kind in ("object", "material", "asset")]
    passes = shlight.render(
        scene, 15, 15, passes=names, cryptomatte_levels=3, noise_threshold=0, max_samples=64, max_bounces=0
    )
    identity = {name: np.uint32(cryptomatte_hash(name)).view(np.float32) for name in ("left", "right", "pair", "matt")}
    mattes = {name: passes[name].reshape(15, 15, 4, 2) for name in names}
    middle = mattes["cryptomatte_object"][7, 7]  # half of each
    assert set(middle[:2, 0]) == {identity["left"], identity["right"]}
    np.testing.assert_allclose(middle[:, 1], [0.5, 0.5, 0, 0], atol=1e-6)
    for kind in ("asset", "material"):
        np.testing.assert_allclose(
            mattes[f"cryptomatte_{kind}"][7, 7, 0], [identity["pair" if kind == "asset" else "matt"], 1]
        )
    shares = mattes["cryptomatte_object"][..., 1]
    np.testing.assert_allclose(shares.sum(axis=-1), passes["combined"][..., 3], atol=1e-6)
    assert (np.diff(shares, axis=-1) <= 0).all()


def test_aovs_are_what_materials_say() -> None:
    scene = shlight.Scene()
    place = nodes.position()
    scene.add_mesh(
        FLOOR / 9, FACES, bsdf=nodes.lambert(0.5).with_aovs({"height": 3.0 + place.x, "tint": (1.0, 0.5, 0.25)})
    )
    from_above(scene, 1.0)
    passes = shlight.render(scene, 4, 4, aovs=True, max_samples=1, max_bounces=0)
    x = np.broadcast_to([[-0.75, -0.25, 0.25, 0.75]], (4, 4))
    np.testing.assert_allclose(passes["aov_height"][..., 0], 3.0 + x, atol=1e-6)
    np.testing.assert_allclose(passes["aov_tint"], np.broadcast_to([1.0, 0.5, 0.25, 1.0], (4, 4, 4)))


def test_passes_see_through_what_lets_light_through() -> None:
    scene = lit_floor(object_indices=1)
    veil = nodes.mix(nodes.transparent(), nodes.lambert(0.5), 0.25)
    scene.add_mesh(SQUARE + np.array([0, 0, 1]), FACES, bsdf=veil, object_indices=2, object_names="veil")
    options: dict[str, Any] = {"passes": ["depth", "object_index", "cryptomatte_object"], "max_samples": 1}
    through = shlight.render(scene, 8, 8, **options, max_bounces=0)
    kept = shlight.render(scene, 8, 8, alpha_threshold=0.2, **options, max_bounces=0)
    assert through["depth"][4, 4, 0] == pytest.approx(10.0, abs=1e-5)
    assert kept["depth"][4, 4, 0] == pytest.approx(9.0, abs=1e-5)
    assert (through["object_index"] == 1).all()
    assert set(np.unique(kept["object_index"])) == {1, 2}
    assert kept["cryptomatte_object"][4, 4, 1] == pytest.approx(0.25)


def test_passes_as_a_file_have_blenders_names(tmp_path: Path) -> None:
    oiio = pytest.importorskip("OpenImageIO")
    scene = lit_floor(object_names="floor", bsdf=nodes.lambert(0.5).with_aovs({"half": 0.5}))
    scene.set_environment((1, 1, 1), group="sky")
    names = ["depth", "normal", "diffuse_direct", "cryptomatte_object"]
    passes = shlight.render(
        scene, 8, 4, passes=names, groups=True, aovs=True, max_samples=1, cryptomatte_levels=4, max_bounces=0
    )
    write_layers(tmp_path / "layers.exr", passes)
    file = oiio.ImageInput.open(str(tmp_path / "layers.exr"))
    channels, pixels = list(file.spec().channelnames), file.read_image("float")
    file.close()
    expected = {
        "Combined.A": passes["combined"][..., 3],
        "Depth.Z": passes["depth"][..., 0],
        "Normal.Y": passes["normal"][..., 1],
        "DiffDir.G": passes["diffuse_direct"][..., 1],
        "CryptoObject01.g": passes["cryptomatte_object"][..., 5],
        "Combined_sky.R": passes["combined_sky"][..., 0],
        "half.X": passes["aov_half"][..., 0],
    }
    for name, values in expected.items():
        np.testing.assert_array_equal(pixels[..., channels.index(f"ViewLayer.{name}")], values, err_msg=name)
    with pytest.raises(ValueError, match=r"^passes must"):
        write_layers(tmp_path / "none.exr", {})
