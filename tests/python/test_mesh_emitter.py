# SPDX-License-Identifier: MIT
"""A mesh that shines like a sphere against the sphere, however many faces it has."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import shlight
from shlight import nodes
from shlight.metrics import mean_ratio, rel_mse
from shlight_tools.bench.lamps import CENTER, RADIANCE, RADIUS, ball_on_floor, icosphere, under_mesh
from shlight_tools.charts.scenes import ball


def of_equal_area(subdivisions: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """An icosphere that emits as much as the sphere does: a mesh within it is smaller."""
    vertices, faces = icosphere(subdivisions)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=-1).sum() / 2
    return vertices * np.sqrt(4 * np.pi / area), faces


@pytest.mark.parametrize(
    ("bsdf", "shadow_rays"), [(shlight.Bsdf.lambert(0.8), 0), (shlight.Bsdf.ggx(0.5, 0.9), 16)], ids=["matt", "glossy"]
)
def test_icosphere_gives_the_picture_of_the_sphere(bsdf: shlight.Bsdf, shadow_rays: int) -> None:
    under_sphere = ball_on_floor(bsdf)
    under_sphere.add_sphere_light(CENTER, RADIUS, RADIANCE)
    expected = shlight.render(under_sphere, 32, 24, shadow_rays=shadow_rays, max_bounces=0)[..., :3]
    for subdivisions in (1, 6):  # 80 and 81920 faces
        image = shlight.render(
            under_mesh(of_equal_area(subdivisions), bsdf), 32, 24, shadow_rays=shadow_rays, max_bounces=0
        )[..., :3]
        below = slice(10, None)  # without the lamp, which the camera sees if it is a mesh
        assert rel_mse(image[below], expected[below]) <= 1e-3
        # Each picture draws shadow rays of its own, and 80 faces show more to some sides than to others.
        most = 3e-3 if shadow_rays else 2e-3 if subdivisions == 1 else 1e-3
        assert abs(mean_ratio(image[below], expected[below]) - 1) <= most


def test_what_is_not_opaque_shines_through_itself() -> None:
    """A ray to a closed emitter sees the near side, and through it the far one."""
    share = 0.5
    bsdf = shlight.Bsdf.lambert(0.8)
    ball = icosphere(3)
    expected = share * (2 - share) * shlight.render(under_mesh(ball, bsdf), 32, 24, max_bounces=0)[..., :3]
    scene = ball_on_floor(bsdf)
    vertices, faces = ball
    radiance = share * np.asarray(RADIANCE)
    veil = nodes.mix(nodes.transparent(), nodes.emission(RADIANCE), share)
    scene.add_mesh(RADIUS * vertices + CENTER, faces, bsdf=veil, emission=radiance)
    image = shlight.render(scene, 32, 24, max_bounces=0)[..., :3]
    below = slice(10, None)
    assert rel_mse(image[below], expected[below]) <= 1e-3
    assert abs(mean_ratio(image[below], expected[below]) - 1) <= 5e-3


def test_a_closed_emitter_of_two_colours_may_be_wound_either_way() -> None:
    vertices, faces = icosphere(2)
    upper = vertices[faces].mean(axis=1)[:, 2] > 0
    images = []
    for wound in (faces, faces[:, ::-1]):
        scene = ball_on_floor(shlight.Bsdf.lambert(0.8))
        scene.add_mesh(
            RADIUS * vertices + CENTER, wound, emission=[(4, 0.1, 0), (0.1, 4, 0)], material_indices=upper.astype(int)
        )
        images.append(shlight.render(scene, 32, 24, max_bounces=0)[..., :3])
    # Shadow rays go to other points of faces whose corners come in another order.
    assert rel_mse(*images) <= 1e-3
    assert abs(mean_ratio(*images) - 1) <= 3e-3


def test_a_ring_of_negative_radiance_takes_light_away() -> None:
    around, across = (np.linspace(0, 2 * np.pi, count, endpoint=False) for count in (24, 12))
    x, y = (values.ravel() for values in np.meshgrid(around, across, indexing="ij"))
    width = 0.6 + 0.2 * np.cos(y)
    vertices = np.stack([width * np.cos(x), width * np.sin(x), 0.2 * np.sin(y)], axis=1) + CENTER
    first = np.arange(24 * 12).reshape(24, 12)
    right, up = np.roll(first, -1, axis=0), np.roll(first, -1, axis=1)
    corner = np.roll(right, -1, axis=1)
    faces = np.concatenate(
        [np.stack(face, axis=-1).reshape(-1, 3) for face in ((first, right, corner), (first, corner, up))]
    )
    images = []
    for radiance in (4.0, 0.0, -4.0):
        scene = ball_on_floor(shlight.Bsdf.lambert(0.8))
        scene.set_environment((2, 2, 2))
        scene.add_mesh(vertices, faces, emission=(radiance,) * 3)
        # The same camera rays in all three, as edges differ by up to the noise threshold where they do.
        rays = {"min_samples": 4, "max_samples": 4, "noise_threshold": 0}
        images.append(shlight.render(scene, 64, 48, shadow_rays=0, max_bounces=0, **rays)[20:, :, :3])
    more, none, less = images
    assert (more - none).mean() >= 0.01 * none.mean()
    np.testing.assert_allclose(none - less, more - none, atol=3e-3 * none.mean())


def dome(side: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A sheet that bends away from +z everywhere."""
    x, y = np.meshgrid(*[np.linspace(-1.0, 1.0, side + 1)] * 2)
    vertices = np.stack([x, y, -(x**2 + y**2) / 4], axis=-1).reshape(-1, 3)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    lower, upper = (first, first + 1, first + side + 2), (first, first + side + 2, first + side + 1)
    return vertices, np.concatenate([np.stack(lower, axis=1), np.stack(upper, axis=1)])


@pytest.mark.parametrize("form", ["dome", "uneven ball"])
def test_a_surface_that_bends_away_throws_no_light_on_itself(form: str) -> None:
    """Rounding must not put a face before the point that lies on it."""
    if form == "uneven ball":
        made = ball((0.3, 0.1, -0.2), 1.0)
        vertices, faces = made.vertices, made.triangles
    else:
        vertices, faces = dome(5)
    scene = shlight.Scene()
    scene.add_mesh(vertices, faces, emission=(2.0, 2.0, 2.0))
    a, b, c = np.moveaxis(np.asarray(vertices)[np.asarray(faces)[::7]], 1, 0)
    normals = np.cross(b - a, c - a)
    has_area = np.linalg.norm(normals, axis=-1) > 1e-9
    found = scene.irradiance(((a + b + c) / 3)[has_area], normals[has_area], rays=16)
    assert np.abs(found).max() <= 1e-3  # of 2π if all above shone


def lamps(shapes: list[Any], radiance: NDArray[np.float64], **options: Any) -> NDArray[np.float32]:
    """A floor under meshes that shine."""
    scene = shlight.Scene()
    for (vertices, faces), color in zip(shapes, radiance, strict=True):
        scene.add_mesh(vertices, faces, emission=color, bsdf=shlight.Bsdf.lambert(0))
    floor = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]
    bsdf = shlight.Bsdf.principled((0.6, 0.5, 0.7), roughness=0.4)
    scene.add_mesh(floor, [(0, 1, 2), (0, 2, 3)], bsdf=bsdf)
    scene.set_camera(shlight.look_at((0, -4, 1.2), (0, 0, 0.2)), 0.8)
    return shlight.render(scene, 32, 24, max_bounces=0, **options)[8:, :, :3]


@pytest.mark.parametrize("shape", ["squares", "balls in a dome"])
def test_many_meshes_give_the_light_of_each(shape: str) -> None:
    """A picture under more emitters than are looked at one by one is the sum of pictures under fewer."""
    random, numbers = np.random.default_rng(4), np.arange(150)
    # Squares that face down from one height do not block each other, and the balls' picture has no shadows.
    place = np.column_stack([0.3 * (numbers // 13) - 1.7, 0.3 * (numbers % 13) - 1.8, np.full(150, 1.5)])
    size, radiance = random.uniform(0.02, 0.1, (150, 1, 1)), random.uniform(2, 60, (150, 3))
    square = np.array([(-1, -1, 0), (-1, 1, 0), (1, 1, 0), (1, -1, 0)]), [(0, 1, 2), (0, 2, 3)]
    vertices, faces = square if shape == "squares" else icosphere(1)
    shapes = [(corners, faces) for corners in place[:, None] + size * vertices]
    if shape != "squares":
        ball, around = icosphere(2)
        shapes[0], radiance[0] = (8 * ball, around), (4, 2, 8)
    options = {"shadows": shape == "squares", "noise_threshold": 0.01}
    parts = [slice(first, first + 25) for first in range(0, 150, 25)]
    expected = np.sum([lamps(shapes[part], radiance[part], **options) for part in parts], axis=0)
    image = lamps(shapes, radiance, **options)
    # The threshold bounds the error of what is summed up over faces.
    assert rel_mse(image, expected) <= options["noise_threshold"] ** 2
    assert abs(mean_ratio(image, expected) - 1) <= options["noise_threshold"]
