# SPDX-License-Identifier: MIT
"""A mesh that shines like a sphere against the sphere, however many faces it has."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import shlight
from shlight.bench.mesh_emitter import icosphere
from shlight.charts.scenes import look_at
from shlight.metrics import mean_ratio, rel_mse

CENTER, RADIUS, RADIANCE = (0.9, -0.6, 2.4), 0.4, (10.0, 10.0, 10.0)
CAMERA = look_at((0.0, -6.0, 3.0), (0.0, 0.0, 0.5)), 0.7


def things(bsdf: shlight.Bsdf) -> shlight.Scene:
    """A ball on a floor. The camera does not see what lights them."""
    scene = shlight.Scene()
    floor = 4 * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    scene.add_mesh(floor, np.array([[0, 1, 2], [0, 2, 3]]), bsdf=bsdf)
    normals, faces = icosphere(4)
    scene.add_mesh(0.8 * normals + (0, 0, 0.8), faces, bsdf=bsdf, normals=normals)
    scene.set_camera(*CAMERA)
    return scene


def of_equal_area(subdivisions: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """An icosphere that emits as much as the sphere does: a mesh within it is smaller."""
    vertices, faces = icosphere(subdivisions)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=-1).sum() / 2
    return vertices * np.sqrt(4 * np.pi / area), faces


@pytest.mark.parametrize("shadow_rays", [0, 16])
@pytest.mark.parametrize("bsdf", [shlight.Bsdf.lambert(0.8), shlight.Bsdf.ggx(0.5, 0.9)], ids=["matt", "glossy"])
def test_icosphere_gives_the_picture_of_the_sphere(bsdf: shlight.Bsdf, shadow_rays: int) -> None:
    under_sphere = things(bsdf)
    under_sphere.add_sphere_light(CENTER, RADIUS, RADIANCE)
    expected = shlight.render(under_sphere, 64, 48, shadow_rays=shadow_rays)[..., :3]
    for subdivisions in (1, 2, 3, 4, 7):  # 80 … 327680 faces
        scene = things(bsdf)
        vertices, faces = of_equal_area(subdivisions)
        scene.add_mesh(RADIUS * vertices + CENTER, faces, emission=RADIANCE)
        image = shlight.render(scene, 64, 48, shadow_rays=shadow_rays)[..., :3]
        below = slice(20, None)  # without the lamp
        assert rel_mse(image[below], expected[below]) <= 1e-3
        # Each picture draws shadow rays of its own, and 80 faces show more to some sides than to others.
        most = 3e-3 if shadow_rays else 2e-3 if subdivisions == 1 else 1e-3
        assert abs(mean_ratio(image[below], expected[below]) - 1) <= most
