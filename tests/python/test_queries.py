# SPDX-License-Identifier: MIT
"""What rays through a scene meet and see, and the light at points of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, SQUARE

import shlight
from shlight import Bsdf

Floats = NDArray[np.float64]

TURNED = np.array([[0.8, -0.6, 0, 0.2], [0.6, 0.8, 0, 0], [0, 0, 1.5, -0.3], [0, 0, 0, 1]])
NEAR = np.array([[1, 0, 0, 0], [0, 0, -2, 0.5], [0, 1, 0, 0], [0, 0, 0, 1.0]])


def triangles_of(meshes: list[tuple[Floats, Floats]]) -> tuple[Floats, NDArray[np.int64]]:
    """Corners (k, 3, 3) in the world, and of each the mesh, its instance and its own number."""
    corners, numbers = [], []
    for mesh, (vertices, transforms) in enumerate(meshes):
        for instance, to_world in enumerate(transforms):
            placed = vertices @ to_world[:3, :3].T + to_world[:3, 3]
            corners.append(placed.reshape(-1, 3, 3))
            numbers += [(mesh, instance, triangle) for triangle in range(len(vertices) // 3)]
    return np.concatenate(corners), np.array(numbers)


def nearest(corners: Floats, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.int64], Floats]:
    """For each ray, by Möller and Trumbore 1997, the distance and number of the nearest triangle and (u, v) on it."""
    a, b, c = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(directions[:, None], c)
    off = origins[:, None] - a
    determinant = (b * p).sum(-1)
    u = (off * p).sum(-1) / determinant
    q = np.cross(off, b)
    v = (directions[:, None] * q).sum(-1) / determinant
    t = (c * q).sum(-1) / determinant
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), t, np.inf)
    first = t.argmin(-1)
    rows = np.arange(len(origins))
    return t[rows, first], first, np.stack([u[rows, first], v[rows, first]], axis=-1)


def test_rays_meet_what_a_search_of_all_triangles_finds() -> None:
    rng = np.random.default_rng(1)
    meshes = [
        (rng.uniform(-1, 1, (60, 3)), np.array([TURNED])),
        (rng.uniform(-1, 1, (15, 3)), np.array([np.eye(4)])),
        (rng.uniform(-1, 1, (30, 3)), np.array([NEAR, TURNED])),
    ]
    scene = shlight.Scene()
    added = []
    for vertices, transforms in meshes:
        uvs = np.tile([[0.0, 0], [1, 0], [0, 1]], (len(vertices) // 3, 1))
        faces = np.arange(len(vertices)).reshape(-1, 3)
        added.append(scene.add_mesh(vertices, faces, uvs=uvs, transforms=transforms))
    assert [mesh.index for mesh in added] == [0, 1, 2]
    added[1].remove()
    corners, numbers = triangles_of(meshes)
    kept = numbers[:, 0] != 1
    corners, numbers = corners[kept], numbers[kept]
    origins = rng.uniform(-3, 3, (4000, 3))
    directions = rng.uniform(-1, 1, (4000, 3)) - 0.4 * origins
    units = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    distance, first, uv = nearest(corners, origins, units)

    hits = scene.intersect(origins, directions)
    met = np.isfinite(distance)
    assert 1000 < np.count_nonzero(met) < 3000
    np.testing.assert_array_equal(hits.valid, met)
    np.testing.assert_allclose(hits.distance[met], distance[met], rtol=0, atol=1e-5)
    np.testing.assert_allclose(hits.position[met], (origins + distance[:, None] * units)[met], rtol=0, atol=1e-5)
    np.testing.assert_array_equal(np.stack([hits.mesh, hits.instance, hits.triangle], -1)[met], numbers[first][met])
    np.testing.assert_allclose(hits.uv[met], uv[met], rtol=0, atol=1e-3)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[first]
    normals = across / np.linalg.norm(across, axis=-1, keepdims=True)
    normals *= -np.sign((normals * units).sum(-1, keepdims=True))
    np.testing.assert_allclose(hits.normal[met], normals[met], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(hits.shading_normal, hits.normal)
    for array, empty in [(hits.mesh, -1), (hits.instance, -1), (hits.triangle, -1), (hits.distance, np.inf)]:
        assert np.all(array[~met] == empty)
    for zeros in (hits.position, hits.normal, hits.shading_normal, hits.uv):
        assert np.all(zeros[~met] == 0)


def test_smooth_normals_are_turned_to_the_ray() -> None:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, normals=[[1, 0, 1]] * 4)
    hits = scene.intersect([[0, 0, 1], [0, 0, -1]], [[0, 0, -1], [0, 0, 1]])
    np.testing.assert_allclose(hits.shading_normal, np.sqrt([[0.5, 0, 0.5]] * 2) * [[1], [-1]], rtol=0, atol=1e-7)
    np.testing.assert_array_equal(hits.normal, [[0, 0, 1], [0, 0, -1]])


def lit_scene() -> shlight.Scene:
    """A square light over a floor, half hidden by a wall, and a lamp that is seen."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, bsdf=Bsdf.lambert([0.7, 0.5, 0.3]))
    scene.add_mesh([[0, -2, 0.5], [0, 2, 0.5], [0, 2, 1], [0, -2, 1]], FACES, bsdf=Bsdf.ggx(0.4, 0.5))
    scene.add_mesh(SQUARE[::-1] * 0.5 + [0, 0, 2], FACES, emission=[3, 2, 1])
    scene.add_sphere_light([1, 1, 1.5], 0.2, [0, 3, 6], camera=True)
    return scene


def rays_of_picture(size: int) -> tuple[Floats, Floats, Floats]:
    """The camera's matrix, and origin and directions of the rays through the middles of its pixels."""
    to_world = np.eye(4)
    to_world[:3, 3] = [0.3, 0.2, 6]
    step = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(step, -step)
    return to_world, to_world[:3, 3], np.stack([x, y, np.full_like(x, -2)], axis=-1).reshape(-1, 3)


def test_a_ray_sees_what_a_pixel_shows() -> None:
    scene = lit_scene()
    to_world, origin, directions = rays_of_picture(32)
    scene.set_camera(to_world, 2 * np.arctan(0.5))
    given: dict[str, Any] = {"max_samples": 1, "shadow_rays": 4096, "max_bounces": 0}
    both = shlight.render(scene, 32, 32, passes=["emission"], **given)
    pixels = both["combined"].reshape(-1, 4)[:, :3]
    seen = scene.radiance(origin, directions, noise_threshold=0.002)
    scale = pixels.mean()
    assert np.sqrt(np.mean((seen - pixels) ** 2)) <= 2e-3 * scale
    assert np.sqrt(np.mean((scene.radiance(origin, directions) - pixels) ** 2)) <= 1e-2 * scale
    reflected = scene.radiance(origin, directions, noise_threshold=0.002, lights=False)
    assert np.sqrt(np.mean((reflected + both["emission"].reshape(-1, 3) - pixels) ** 2)) <= 2e-3 * scale
    assert both["emission"].max() > 1


def test_rays_see_the_environment_where_the_camera_does() -> None:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES, bsdf=Bsdf.lambert(0.5))
    down_and_up = [[0, 0, -1], [0, 0, 3]]
    scene.set_environment([2, 4, 6])
    np.testing.assert_allclose(scene.radiance([0, 0, 1], down_and_up), [[1, 2, 3], [2, 4, 6]], rtol=1e-5)
    np.testing.assert_allclose(scene.radiance([0, 0, 1], down_and_up, lights=False)[1], 0)
    scene.set_environment([2, 4, 6], visible=False)
    np.testing.assert_allclose(scene.radiance([0, 0, 1], down_and_up), [[1, 2, 3], [0, 0, 0]], rtol=1e-5)


def furnace() -> shlight.Scene:
    """A cube whose walls have the albedo 0.5 and emit 1."""
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[side[0], *pair] for side in sides for pair in (side[1:3], side[2:])]
    scene = shlight.Scene()
    scene.add_mesh(corners, faces, bsdf=Bsdf.lambert(0.5), emission=[1, 1, 1])
    return scene


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_rays_in_a_furnace_see_each_bounce(bounces: int) -> None:
    """n reflections add 1/2 + 1/4 + ... of what walls emit."""
    scene = furnace()
    directions = np.random.default_rng(2).normal(size=(50, 3))
    reflected = sum(0.5**n for n in range(1, bounces + 2))
    given: dict[str, Any] = {"max_bounces": bounces, "noise_threshold": 0, "max_samples": 256}
    seen = scene.radiance([0.2, 0.1, 0], directions, **given)
    np.testing.assert_allclose(seen, 1 + reflected, rtol=0.02)
    seen = scene.radiance([0.2, 0.1, 0], directions, lights=False, **given)
    np.testing.assert_allclose(seen, reflected, rtol=0.03)


def test_answers_do_not_depend_on_threads_and_have_the_type_of_the_question() -> None:
    scene = lit_scene()
    _, origin, directions = rays_of_picture(40)
    one = scene.radiance(origin, directions, threads=1)
    np.testing.assert_array_equal(one, scene.radiance(origin, directions, threads=3))
    assert one.dtype == np.float64
    singles = scene.radiance(origin.astype(np.float32), directions.astype(np.float32))
    assert singles.dtype == np.float32
    assert scene.intersect(origin.astype(np.float32), directions.astype(np.float32)).position.dtype == np.float32
    assert scene.intersect(origin.astype(np.float32), directions).position.dtype == np.float64


OF_RAYS = ["intersect", "radiance"]
OF_POINTS: dict[str, tuple[int, ...]] = {"irradiance": (), "light_coefficients": (3,)}  # and what else they take


@pytest.mark.parametrize("method", [*OF_RAYS, *OF_POINTS])
def test_batches_may_be_empty(method: str) -> None:
    answer = getattr(lit_scene(), method)(np.zeros((0, 3)), np.zeros((0, 3)), *OF_POINTS.get(method, ()))
    assert len(answer) == 0


LAMP = SQUARE[::-1] * 0.5 + [0.1, 0, 2]  # shines down
WALL = np.array([[-0.6, -0.4, 1.0], [0.3, -0.4, 1.0], [0.3, 0.5, 1.2], [-0.6, 0.5, 1.2]])
RADIANCE = np.array([3.0, 2.0, 1.0])


def half_hidden() -> shlight.Scene:
    """A square lamp over a floor, and a plate between."""
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES)
    scene.add_mesh(WALL, FACES)
    scene.add_polygon_light(LAMP, RADIANCE)
    return scene


def lamp_samples(points: Floats, count: int = 6400) -> tuple[Floats, Floats]:
    """Directions to so many points of the lamp, spread evenly (Roberts 2018), from each point, and the solid angle of a
    share of the lamp where nothing is between.
    """
    share = np.arange(count)[:, None] * [0.7548776662466927, 0.5698402909980532, 0] % 1
    places = LAMP.mean(axis=0) + np.where([True, True, False], share - 0.5, 0)
    ways = places - points[:, None]
    distance = np.linalg.norm(ways, axis=-1)
    directions = ways / distance[..., None]
    corners = WALL[np.array(FACES)]
    hidden = np.isfinite(nearest(corners, np.repeat(points, count, axis=0), directions.reshape(-1, 3))[0])
    angles = directions[..., 2] / distance**2 / count
    return directions, np.where(hidden.reshape(angles.shape), 0, angles)


def floor_points(count: int, seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    points = np.concatenate([rng.uniform(-1.5, 1.5, (count, 2)), np.zeros((count, 1))], axis=-1)
    return points, rng.normal(size=(count, 3)) * 0.3 + [0, 0, 1]


def unit(vectors: Floats) -> Floats:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@pytest.mark.parametrize("count", [200, 4000])
def test_irradiance_is_that_of_the_part_of_a_lamp_that_is_seen(count: int) -> None:
    points, normals = floor_points(count, seed=3)
    found, error = half_hidden().irradiance(points, normals, return_error=True)
    some = slice(0, count, count // 100)
    directions, angles = lamp_samples(points[some])
    cosines = np.maximum((directions * unit(normals)[some, None]).sum(-1), 0)
    true = (angles * cosines).sum(-1)[:, None] * RADIANCE
    off = np.sqrt(np.mean((found[some] - true) ** 2))
    assert off <= 0.02 * true.mean()
    assert off / 3 <= np.sqrt(np.mean(error[some] ** 2)) <= 3 * off
    many = half_hidden().irradiance(points[some], normals[some], rays=4096)
    np.testing.assert_allclose(many, true, rtol=0, atol=2e-3 * true.max())


def test_irradiance_without_shadows_is_exact() -> None:
    scene = half_hidden()
    scene.add_sun_light([0, 0, -1], 0.0, [1, 0, 0])
    scene.add_point_light([0, 0, 2], [0, 1, 0])
    scene.add_sphere_light([1, 0, 3], 0.5, [0, 0, 2])
    scene.add_sphere_light([0, 0, 3], 0.5, [5, 5, 5], diffuse=False)
    scene.set_environment([0.1, 0.2, 0.3])
    points, normals = [[0.2, 0.1, 0]], [[0, 0, 5]]
    corners = unit(np.asarray(LAMP) - points)
    after = np.roll(corners, -1, axis=0)
    edges = unit(np.cross(corners, after))[:, 2] * np.arccos((corners * after).sum(-1))  # Lambert 1760
    lamp = abs(edges.sum()) / 2 * RADIANCE
    lengths = np.linalg.norm([[-0.2, -0.1, 2], [0.8, -0.1, 3]], axis=-1)
    others = np.array([1, 2 / lengths[0] ** 3, 2 * np.pi * 0.25 * 3 / lengths[1] ** 3])
    sky = np.pi * np.array([0.1, 0.2, 0.3])
    found, error = scene.irradiance(points, normals, rays=0, return_error=True)
    np.testing.assert_allclose(found[0], lamp + others + sky, rtol=1e-5)
    np.testing.assert_array_equal(error, 0)


def test_points_on_a_surface_are_not_in_its_shadow() -> None:
    """Also on a large, slanted one, whose points are rounded far off its plane."""
    rng = np.random.default_rng(4)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    to_world = np.eye(4)
    to_world[:3, :3] = turn * 3000
    scene = shlight.Scene()
    scene.add_mesh(SQUARE, FACES, transforms=[to_world])
    scene.set_environment([1, 1, 1])
    points = rng.uniform(-2000, 2000, (500, 2)) @ turn[:, :2].T
    for normal in (turn[:, 2], -turn[:, 2]):
        np.testing.assert_allclose(scene.irradiance(points, normal), np.pi, rtol=1e-4)


def of_region(name: str, **region: Any) -> Floats:
    coefficients: Floats = getattr(shlight, name)(**region, order=5, dtype=np.float64)
    return coefficients


# Functions that add a light to a scene, and that find its coefficients of radiance 1 by two functions that take points
# and vectors to the frame.
LIGHTS: dict[str, tuple[Any, Any]] = {
    "sphere": (
        lambda scene: scene.add_sphere_light([0.3, 0.2, 2], 0.4, RADIANCE),
        lambda place, _: of_region("sphere_coefficients", centers=place([0.3, 0.2, 2]), radii=0.4),
    ),
    "polygon": (
        lambda scene: scene.add_polygon_light(LAMP, RADIANCE),
        lambda place, _: of_region("polygon_coefficients", vertices=place(LAMP)),
    ),
    "disk": (
        lambda scene: scene.add_disk_light([0, 0, 2], [0.5, 0, 0], [0, -0.3, 0.1], RADIANCE),
        lambda place, turn: of_region(
            "disk_coefficients",
            centers=place([0, 0, 2]),
            half_axes_u=turn([0.5, 0, 0]),
            half_axes_v=turn([0, -0.3, 0.1]),
        ),
    ),
    "faces": (
        lambda scene: scene.add_mesh(LAMP, FACES, emission=RADIANCE),
        lambda place, _: of_region("polygon_coefficients", vertices=place(LAMP)),
    ),
    "sun": (
        lambda scene: scene.add_sun_light([0.2, 0.1, -1], 0.3, RADIANCE * np.pi * np.sin(0.15) ** 2),
        lambda _, turn: of_region("cap_coefficients", axes=turn([-0.2, -0.1, 1]), half_angles=0.15),
    ),
    "point": (
        lambda scene: scene.add_point_light([0.3, 0.2, 2], RADIANCE),
        lambda place, _: (
            shlight.sh_basis(place([0.3, 0.2, 2]), 5, dtype=np.float64)
            * (place([0.3, 0.2, 2])[2] > 0)
            / (place([0.3, 0.2, 2]) ** 2).sum()
        ),
    ),
    "sky": (
        lambda scene: scene.set_environment(RADIANCE),
        lambda _place, _turn: of_region("cap_coefficients", axes=[0, 0, 1.0], half_angles=np.pi / 2),
    ),
}


@pytest.mark.parametrize(("add", "region"), LIGHTS.values(), ids=LIGHTS)
def test_coefficients_without_shadows_are_those_of_the_light(add: Any, region: Any) -> None:
    scene = shlight.Scene()
    scene.add_mesh(WALL, FACES)
    add(scene)
    points, normals = floor_points(20, seed=5)
    frames = shlight.shading_frames(normals)
    found = scene.light_coefficients(points, normals, 5, shadows=False)
    for i in range(20):
        true = region(lambda w, i=i: (w - points[i]) @ frames[i], lambda w, i=i: np.asarray(w) @ frames[i])
        np.testing.assert_allclose(found[i], true[:, None] * RADIANCE, rtol=0, atol=1e-6 * np.abs(true).max())


def test_lights_that_are_summed_have_the_coefficients_of_their_radiance() -> None:
    """A spot with an extent, against an even sum over its surface."""
    middle, radius, rim = np.array([0.3, 0.2, 2]), 0.3, np.cos(0.6)
    scene = shlight.Scene()
    scene.add_spot_light(middle, [0, 0, -1], 1.2, 0.5, RADIANCE, radius=radius)
    points, normals = floor_points(5, seed=6)
    frames = shlight.shading_frames(normals)
    found = scene.light_coefficients(points, normals, 4, shadows=False)
    outwards = unit(np.random.default_rng(7).normal(size=(400_000, 3)))
    for i in range(5):
        ways = middle + radius * outwards - points[i]
        distance = np.linalg.norm(ways, axis=-1)
        angles = 4 * radius**2 * np.maximum(-(ways * outwards).sum(-1), 0) / distance**3 / len(outwards)
        fade = np.clip((ways[:, 2] / distance - rim) / ((1 - rim) * 0.5), 0, 1)
        local = ways @ frames[i]
        weights = angles / radius**2 * fade**2 * (3 - 2 * fade) * (local[:, 2] > 0)
        true = weights @ shlight.sh_basis(local, 4, dtype=np.float64)
        np.testing.assert_allclose(found[i], true[:, None] * RADIANCE, rtol=0, atol=0.05 * np.abs(true).max())


def test_coefficients_with_shadows_are_those_of_what_is_seen() -> None:
    points, normals = floor_points(60, seed=8)
    frames = shlight.shading_frames(normals)
    directions, angles = lamp_samples(points)
    local = np.einsum("nrj,njk->nrk", directions, frames)
    basis = shlight.sh_basis(local, 4, dtype=np.float64)
    true = np.einsum("nr,nrk->nk", angles * (local[..., 2] > 0), basis)[..., None] * RADIANCE
    scene = half_hidden()
    scale = true[:, 0].mean()
    off = scene.light_coefficients(points, normals, 4) - true
    assert np.sqrt(np.mean(off**2)) <= 0.03 * scale
    off = np.mean([scene.light_coefficients(points, normals, 4, rays=16, seed=s) for s in range(64)], axis=0) - true
    assert np.sqrt(np.mean(off**2)) <= 0.015 * scale  # one alone is 0.09: no bias
    seen = scene.light_coefficients(points, normals, 4)
    scene.add_sphere_light([0, 0, 3], 0.1, [1, 1, 1], shadows=False)
    place = np.einsum("nj,njk->nk", [0, 0, 3] - points, frames)
    sphere = shlight.sphere_coefficients(place, 0.1, 4, dtype=np.float64)
    np.testing.assert_allclose(
        scene.light_coefficients(points, normals, 4) - seen, sphere[..., None] * [1, 1, 1], atol=1e-7
    )


def test_coefficients_times_the_cosine_are_irradiance() -> None:
    scene = half_hidden()
    scene.set_environment(np.random.default_rng(9).uniform(0, 1, (8, 16, 3)))
    points, normals = floor_points(30, seed=10)
    light = scene.light_coefficients(points, normals, 8, rays=1024)
    cosine = Bsdf.lambert(1.0).coefficients(1.0, 8)
    reflected = np.einsum("nkc,k->nc", light, np.asarray(cosine)[..., 0] if cosine.ndim > 1 else cosine)
    irradiance = scene.irradiance(points, normals, rays=4096)
    np.testing.assert_allclose(np.pi * reflected, irradiance, rtol=0, atol=0.02 * irradiance.mean())


def test_frames_are_orthonormal_and_turn_gradually() -> None:
    rng = np.random.default_rng(11)
    normals = np.concatenate([rng.normal(size=(100, 3)), [[0, 0, 2], [0, 0, -1], [1e-9, 0, -1], [1e-200, 0, 0]]])
    tangents = rng.normal(size=normals.shape)
    for given in (None, tangents):
        frames = shlight.shading_frames(normals, given)
        np.testing.assert_allclose(np.swapaxes(frames, 1, 2) @ frames, np.tile(np.eye(3), (104, 1, 1)), atol=1e-14)
        np.testing.assert_allclose(np.linalg.det(frames), 1, atol=1e-14)
        np.testing.assert_allclose(frames[:-1, :, 2], unit(normals[:-1]), atol=1e-15)
    np.testing.assert_allclose((frames[:, :, 1] * tangents).sum(-1), 0, atol=1e-14)
    assert np.all((frames[:, :, 0] * tangents).sum(-1) > 0)
    around = np.linspace(0, 2 * np.pi, 1000)
    for z in (-0.9, 0.0, 0.9):
        circle = shlight.shading_frames(np.stack([np.cos(around), np.sin(around), np.full(1000, z)], axis=-1))
        assert np.abs(np.diff(circle, axis=0)).max() <= 0.02
    np.testing.assert_array_equal(shlight.shading_frames([0, 0, 1]), np.eye(3))
    assert shlight.shading_frames(np.float32([[0, 0, 1]])).dtype == np.float32
    with pytest.raises(ValueError, match=r"^normals\[1\] has length 0"):
        shlight.shading_frames([[0, 0, 1], [0, 0, 0]])
    with pytest.raises(ValueError, match=r"^tangents\[0\] is parallel to its normal"):
        shlight.shading_frames([[0, 0, 1]], [[0, 0, 2]])


def test_light_at_points_does_not_depend_on_threads() -> None:
    scene = half_hidden()
    points, normals = floor_points(3000, seed=12)
    np.testing.assert_array_equal(
        scene.irradiance(points, normals, threads=1), scene.irradiance(points, normals, threads=3)
    )
    np.testing.assert_array_equal(
        scene.light_coefficients(points, normals, 3, threads=1),
        scene.light_coefficients(points, normals, 3, threads=3),
    )


@pytest.mark.parametrize("bounces", [1, 3])
def test_points_in_a_furnace_get_each_bounce(bounces: int) -> None:
    points, normals = np.random.default_rng(13).uniform(-0.9, 0.9, (2, 40, 3))
    points[:10, 2] = -1  # on a wall
    normals[:10] = [0, 0, 1]
    whole = sum(0.5**n for n in range(bounces + 1))
    given: dict[str, Any] = {"max_bounces": bounces, "return_error": True}
    found, error = furnace().irradiance(points, normals, **given)
    np.testing.assert_allclose(found, np.pi * whole, rtol=0, atol=5 * error.max() + 1e-3)
    assert error.max() <= 0.1
    found, error = furnace().light_coefficients(points, normals, 3, **given)
    true = of_region("cap_coefficients", axes=[0, 0, 1.0], half_angles=np.pi / 2)[:9, None] * whole
    assert np.sqrt(np.mean((found - true) ** 2)) <= 2 * np.sqrt(np.mean(error**2)) + 1e-3
    assert np.sqrt(np.mean(error**2)) <= 0.1


def wall_patches(count: int = 200) -> tuple[Floats, Floats]:
    """The middles of so many times so many patches of WALL, and their normal times their area."""
    share = (np.arange(count) + 0.5) / count
    u, v = np.meshgrid(share, share, indexing="ij")
    a, b = WALL[1] - WALL[0], WALL[3] - WALL[0]
    places = WALL[0] + u.reshape(-1, 1) * a + v.reshape(-1, 1) * b
    return places, np.cross(a, b) / count**2


POINT_LIGHT = np.array([0.2, -0.1, 0.1])


def test_light_that_a_wall_reflects_is_that_of_its_patches() -> None:
    albedo = np.array([0.9, 0.6, 0.3])
    scene = shlight.Scene()
    scene.add_mesh(WALL, FACES, bsdf=Bsdf.lambert(albedo))
    scene.add_point_light(POINT_LIGHT, RADIANCE)
    points, normals = floor_points(50, seed=14)
    frames = shlight.shading_frames(normals)
    places, area = wall_patches()
    to_light = POINT_LIGHT - places
    side = -area if area @ (POINT_LIGHT - WALL[0]) < 0 else area
    lit = np.maximum(unit(to_light) @ unit(side), 0) / (to_light**2).sum(-1)
    ways = places - points[:, None]
    angles = np.maximum(-(unit(ways) @ side), 0) / (ways**2).sum(-1) * lit  # times radiance
    local = np.einsum("nrj,njk->nrk", unit(ways), frames)
    color = albedo / np.pi * RADIANCE
    cosines = np.maximum(local[..., 2], 0)
    true = (angles * cosines).sum(-1)[:, None] * color
    given: dict[str, Any] = {"bounce_rays": 1024, "return_error": True}
    found, error = scene.irradiance(points, normals, max_bounces=1, **given)
    off = found - scene.irradiance(points, normals) - true
    assert np.sqrt(np.mean(off**2)) <= 0.06 * true.mean()
    assert 0.05 <= np.sqrt(np.mean(off**2) / np.mean(error**2)) <= 1.2  # rays are spread more evenly than random ones
    basis = shlight.sh_basis(local, 4, dtype=np.float64)
    true = np.einsum("nr,nrk->nk", angles * (local[..., 2] > 0), basis)[..., None] * color
    found, error = scene.light_coefficients(points, normals, 4, max_bounces=1, **given)
    off = found - scene.light_coefficients(points, normals, 4) - true
    assert np.sqrt(np.mean(off**2)) <= 0.05 * np.sqrt(np.mean(true[:, 0] ** 2))
    assert 0.05 <= np.sqrt(np.mean(off**2) / np.mean(error**2)) <= 1.2


def test_errors_of_coefficients_are_those_that_shadow_rays_leave() -> None:
    points, normals = floor_points(60, seed=15)
    scene = half_hidden()
    true = scene.light_coefficients(points, normals, 3, rays=4096)
    found, error = scene.light_coefficients(points, normals, 3, rays=32, return_error=True)
    assert error.shape == found.shape
    np.testing.assert_array_equal(error[np.abs(found - true).max(axis=(1, 2)) < 1e-12], 0)
    ratio = np.sqrt(np.mean((found - true) ** 2) / np.mean(error**2))
    assert 0.5 <= ratio <= 2
    with pytest.raises(ValueError, match=r"^rays must be 0 or at least 2"):
        scene.light_coefficients(points, normals, 3, rays=1, return_error=True)


LONG: dict[str, dict[str, Any]] = {
    "irradiance": {"bounce_rays": 1024},
    "light_coefficients": {"order": 6, "bounce_rays": 1024},
    "radiance": {"noise_threshold": 0, "max_samples": 256},
}


@pytest.mark.parametrize("method", LONG)
def test_long_queries_tell_their_progress_and_can_be_cancelled(method: str) -> None:
    points, normals = floor_points(20_000, seed=16)
    scene = lit_scene()
    query = getattr(scene, method)
    given: dict[str, Any] = {"max_bounces": 1, **LONG[method]}
    shares: list[float] = []

    def count(share: float) -> None:
        shares.append(share)

    query(points[:2000], normals[:2000], progress=count, **given)
    assert shares == sorted(shares)
    assert shares[-1] == 1
    assert len(shares) > 2
    shares.clear()

    def end(share: float) -> bool:
        shares.append(share)
        return len(shares) < 3

    with pytest.raises(shlight.RenderCancelled):
        query(points, normals, progress=end, **given)
    assert shares[-1] < 1

    def fail(share: float) -> bool:
        raise KeyError("stop")

    with pytest.raises(KeyError):
        query(points, normals, progress=fail, **given)
