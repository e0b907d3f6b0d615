# SPDX-License-Identifier: MIT
"""Pictures by Monte Carlo: their mean is what the library renders, within their own standard error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, SQUARE, from_above

import shlight
from shlight import Bsdf, Scene
from shlight_tools.methods import render_monte_carlo

SIZE = 8
WALL = np.array([[-1, 1.5, -1], [-1, 1.5, 1], [1, 1.5, 1], [1, 1.5, -1]])
STAR = np.array([[-1, 0.5, 1.5], [0, 0.1, 1.5], [1, 0.5, 1.5], [0, -0.8, 1.5]])
GLOWING = np.array([[1.2, -1, 0.1], [1.2, 1, 0.1], [1.2, 1, 0.9], [1.2, -1, 0.9]])
LIGHTS: dict[str, list[Callable[[Scene], Any]]] = {
    "spheres": [
        lambda scene: scene.add_sphere_light([0.5, 0.25, 1.5], 0.5, [4, 2, 1]),
        lambda scene: scene.add_sphere_light([-1, -0.5, 0.8], 0.4, [1, 2, 4], facing_disk=True),
    ],
    "inside": [lambda scene: scene.add_sphere_light([0, 0, 0], 1.2, [1, 1, 1])],  # most of what is seen lies within
    "polygons": [
        lambda scene: scene.add_polygon_light(STAR, [-1, 2, 3]),
        lambda scene: scene.add_polygon_light(WALL, [2, 1, 0.5]),
        lambda scene: scene.add_polygon_light(WALL[::-1], [2, 1, 0.5]),
    ],
    "disks": [
        lambda scene: scene.add_disk_light([0.3, 0.2, 1.4], [0.1, 0.5, 0.1], [0.8, -0.1, 0], [1, 2, 3]),
        # Through the floor, and close to it.
        lambda scene: scene.add_disk_light([0.2, 1.5, 0.1], [1, 0, 0.2], [0, 0.1, 0.7], [3, 2, 1], spread=2.0),
        lambda scene: scene.add_disk_light([-1.3, -0.5, 0.15], [0, 0.6, 0], [0.6, 0, 0.05], [1, 1, 1]),
    ],
    "faces": [lambda scene: scene.add_mesh(GLOWING, FACES, bsdf=Bsdf.lambert(0), emission=[3, 3, 3])],
}
GOLD = [0.9, 0.6, 0.2]
MATERIALS = {
    "lambert": Bsdf.lambert(0.5),
    "gold": Bsdf.ggx(0.3, GOLD),
    "plastic": Bsdf.layer(Bsdf.ggx(0.25, 0.04, ior=1.45), Bsdf.lambert([0.1, 0.5, 0.8])),
    "mirror": Bsdf.ggx(0, GOLD) + Bsdf.lambert(0.1),
}
OUTSIDE = ("spheres", "polygons", "disks", "faces")


@pytest.mark.parametrize(
    ("material", "kinds"),
    [
        *(("lambert", (kind,)) for kind in LIGHTS),
        ("gold", ("polygons", "faces")),
        *(pytest.param("gold", (kind,), marks=pytest.mark.slow) for kind in ("spheres", "inside", "disks")),
        *(("plastic", OUTSIDE), ("mirror", OUTSIDE)),
    ],
)
def test_their_mean_is_what_the_library_renders(material: str, kinds: tuple[str, ...]) -> None:
    scene = Scene()
    scene.add_mesh(3 * SQUARE, FACES, bsdf=MATERIALS[material])
    scene.add_mesh(0.4 * SQUARE + [0, 0, 0.5], FACES)
    for kind in kinds:
        for add in LIGHTS[kind]:
            add(scene)
    scene.set_camera(shlight.look_at((0.5, -3, 2.5), (0, 0, 0.2)), 0.9)
    # Diffuse pictures have the least noise, so that what rays leave of edges counts most in them.
    count = 256 if material == "lambert" else 64
    fine = {"min_samples": count, "max_samples": count, "noise_threshold": 0, "shadow_rays": 16, "tolerance": 1e-4}
    expected = np.asarray(shlight.render(scene, SIZE, SIZE, max_bounces=0, **fine)).sum(axis=(0, 1), dtype=float)
    runs = [render_monte_carlo(scene, SIZE, SIZE, samples=128, seed=50 + i) for i in range(10)]
    totals = np.sum(runs, axis=(1, 2), dtype=float)
    error = totals.std(axis=0, ddof=1) / np.sqrt(10)
    assert (np.abs(totals.mean(axis=0) - expected) <= 5 * error).all()
    assert (error <= 0.03 * np.abs(expected)).all()


def test_their_noise_falls_with_the_root_of_samples_and_is_of_a_seed_and_a_pixel() -> None:
    scene = Scene()
    scene.add_mesh(9 * SQUARE, FACES, bsdf=Bsdf.lambert(0.5))
    scene.add_sphere_light([0, 0, 0], 50, [1, 1, 1])  # all pixels see the same
    scene = from_above(scene, 1.0)
    runs = {n: [render_monte_carlo(scene, SIZE, SIZE, samples=n, seed=i) for i in (1, 2)] for n in (64, 1024)}
    assert all(picture.dtype == np.float32 for picture in runs[64])
    few, many = (np.std(np.asarray(pictures)[..., 0] - 0.5) for pictures in runs.values())
    assert few / many == pytest.approx(4, rel=0.2)
    assert many <= 0.02
    for first, second in runs.values():
        assert len(np.unique(first[..., 0])) >= SIZE**2 - 3
        assert (first[..., 0] != second[..., 0]).sum() >= SIZE**2 - 3


def below(scene: Scene) -> NDArray[np.float32]:
    """The floor, seen from a height of 1."""
    to_world = np.eye(4)
    to_world[2, 3] = 1
    scene.set_camera_window(to_world, -1, 1, -1, 1, orthographic=True)
    return render_monte_carlo(scene, SIZE, SIZE, samples=512)


def test_a_lamp_is_not_blocked_by_what_it_is_mounted_on() -> None:
    """Tilted, so that neither the mesh's float vertices nor the rays lie in the lamp's plane exactly."""
    along = np.array([1, 0.3, 0.2])
    across = np.cross([0.1, 0.2, 1], along)
    along, across = along / np.linalg.norm(along), across / np.linalg.norm(across)
    corners = np.array([-along - across, -along + across, along + across, along - across])
    scene = Scene()
    scene.add_mesh(3 * SQUARE, FACES)
    scene.add_polygon_light(0.5 * corners + [0.1, -0.2, 3], [3, 3, 3])
    free = below(scene)
    assert free[..., 0].min() > 0.01
    scene.add_mesh(2 * corners + [0.1, -0.2, 3], FACES)
    np.testing.assert_array_equal(below(scene), free)


def test_no_light_is_black_and_nothing_is_transparent() -> None:
    scene = Scene()
    scene.add_mesh(SQUARE, FACES)
    image = render_monte_carlo(from_above(scene), SIZE, SIZE, samples=64)
    assert not image[..., :3].any()
    assert image[..., 3].mean() == pytest.approx(0.25, abs=1e-6)  # its edges lie between pixels
