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


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_rays_in_a_furnace_see_each_bounce(bounces: int) -> None:
    """Walls of albedo 0.5 that emit 1: n reflections add 1/2 + 1/4 + ... of it."""
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[side[0], *pair] for side in sides for pair in (side[1:3], side[2:])]
    scene = shlight.Scene()
    scene.add_mesh(corners, faces, bsdf=Bsdf.lambert(0.5), emission=[1, 1, 1])
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


@pytest.mark.parametrize("method", ["intersect", "radiance"])
def test_batches_may_be_empty(method: str) -> None:
    answer = getattr(lit_scene(), method)(np.zeros((0, 3)), np.zeros((0, 3)))
    assert len(answer) == 0


@pytest.mark.parametrize("method", ["intersect", "radiance"])
@pytest.mark.parametrize(
    ("origins", "directions", "message"),
    [
        ([[0, 0, 0], [0, np.nan, 0]], [0, 0, 1], r"origins\[1\] contains a number that is not finite"),
        ([[0, 0, 0]] * 3, [[0, 0, 1], [0, 0, 1], [0, 0, 0]], r"directions\[2\] has length 0"),
        ([0, 0, 0], [0, np.inf, 0], "directions contains a number that is not finite"),
        ([0, 2e10, 0], [0, 0, 1], "origins: a scene reaches"),
        ([0, 0], [0, 0, 1], r"origins must have shape \(n, 3\)"),
        ([[0, 0, 0]] * 3, [[0, 0, 1]] * 2, "directions must have as many rows as origins"),
    ],
)
def test_wrong_rays_are_named(method: str, origins: Any, directions: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        getattr(lit_scene(), method)(origins, directions)
