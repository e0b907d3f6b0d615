# SPDX-License-Identifier: MIT
"""Pictures that are lit again and again: what Scene.view keeps, and what a change finds anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import shlight

SIZE = (48, 32)
BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.2, 1.2)])
SIDES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [1, 5, 7], [1, 7, 3]]


class Room:
    """A box on a floor, and one light of each kind."""

    def __init__(self, bsdf: shlight.Bsdf | None = None) -> None:
        self.scene = shlight.Scene()
        floor = [[-4.0, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]]
        self.scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], bsdf=bsdf)
        self.box = self.scene.add_mesh(BOX, SIDES, bsdf=shlight.Bsdf.ggx(0.4, (0.9, 0.7, 0.4)))
        add = self.scene
        self.sphere = add.add_sphere_light((1.5, -1, 0.3), 0.5, (6, 7, 9))  # cut by the floor's horizon
        self.panel = add.add_polygon_light([[-1, 1, 2.5], [1, 1, 2.5], [1, 2, 2.5], [-1, 2, 2.5]][::-1], (2, 2, 3))
        self.disk = add.add_disk_light((-2, 0, 2), (0.4, 0, 0), (0, -0.3, 0), (5, 4, 3))
        self.spot = add.add_spot_light((2, 2, 2), (-1, -1, -1), 0.9, 0.3, (5, 5, 1))
        self.sun = add.add_sun_light((0.3, 0.2, -1), 0.1, (0.5, 0.4, 0.3))
        add.set_camera(shlight.look_at((0, -6, 4), (0, 0, 0.5)), 0.9)

    def rendered(self, samples: int = 1, **options: Any) -> NDArray[np.float32]:
        fixed = {"pixel_samples": samples, "max_samples": samples, "noise_threshold": 0, "max_bounces": 0}
        return np.asarray(shlight.render(self.scene, *SIZE, **fixed, **options))

    def change(self) -> None:
        """Moves, dims, brightens, adds and removes."""
        self.sphere.to_world = moved(-0.7, 0.4, 0.2)
        self.panel.radiance = (0.1, 0.3, 0)
        self.disk.radiance = (50, 40, 30)
        self.spot.to_world = moved(0, 0, 0.5)
        self.scene.add_point_light((0, -2, 1), (3, 1, 1))
        self.sun.remove()


def moved(x: float, y: float, z: float) -> NDArray[np.float64]:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def lit(view: shlight.View, **options: Any) -> tuple[NDArray[np.float32], shlight.RenderReport]:
    result = view.relight(**options)
    assert result.report is not None
    return np.asarray(result), result.report


def relative(picture: NDArray[np.float32], truth: NDArray[np.float32]) -> float:
    """The error that RenderReport.noise estimates."""
    scale = truth[..., :3] ** 2 + 0.01 * truth[..., :3].mean() ** 2
    return float(np.sqrt(np.mean((picture[..., :3] - truth[..., :3]) ** 2 / scale)))


@pytest.mark.parametrize("samples", [1, 4])
def test_unshadowed_light_after_changes_is_that_of_a_render(samples: int) -> None:
    room = Room(shlight.Bsdf.ggx(0.5, 0.8))
    view = room.scene.view(*SIZE, order=8, pixel_samples=samples, shadows=False)
    view.relight()
    room.change()
    truth = room.rendered(samples, order=8, shadows=False)
    assert np.abs(np.asarray(view.relight()) - truth).max() <= 1e-6 * truth.max()


def test_with_orders_that_are_chosen_a_view_keeps_to_the_tolerance() -> None:
    room = Room(shlight.Bsdf.ggx(0.3, 0.8))
    view = room.scene.view(*SIZE, shadows=False)
    first = np.asarray(view.relight())
    truth = room.rendered(shadows=False)
    assert np.abs(first - truth).max() <= 1e-6 * truth.max()  # all light is found anew, and as exactly
    room.change()
    assert relative(np.asarray(view.relight()), room.rendered(shadows=False)) <= shlight.DEFAULT_TOLERANCE


def test_the_noise_that_is_told_is_true() -> None:
    room = Room()
    view = room.scene.view(*SIZE)
    view.relight()
    room.change()
    picture, report = lit(view)
    truth = room.rendered(shadow_rays=4096)
    error = relative(picture, truth)
    assert error <= 2 * report.noise
    assert report.noise <= 3 * error
    better, report = lit(view, noise_threshold=0.01)
    assert report.noise <= 0.01
    assert relative(better, truth) <= 0.02


def test_one_changed_light_sends_rays_alone() -> None:
    room = Room()
    view = room.scene.view(*SIZE)
    whole = lit(view)[1]
    room.sphere.to_world = moved(0.1, 0, 0)
    one = lit(view)[1]
    room.panel.radiance = (1, 1, 0.5)
    none = lit(view)[1]
    assert 0 < one.shadow_rays <= 0.5 * whole.shadow_rays
    assert none.shadow_rays <= 0.05 * whole.shadow_rays  # but for a few pixels that are looked at first


def test_pictures_are_the_same_for_any_number_of_threads() -> None:
    pictures = []
    for threads in (1, 3):
        room = Room()
        view = room.scene.view(*SIZE, threads=threads, pixel_samples=2)
        view.relight()
        room.change()
        pictures.append(np.asarray(view.relight(noise_threshold=0.02)))
    assert np.array_equal(*pictures)


@pytest.mark.parametrize("change", ["mesh", "material", "sky", "lamp in view", "mirrored lamp"])
def test_what_camera_rays_meet_may_change(change: str) -> None:
    room = Room(shlight.Bsdf.ggx(0, 0.9) if change == "mirrored lamp" else None)
    place = (1, -1, 2) if change == "lamp in view" else (1.5, 3, 2.3)
    lamp = room.scene.add_sphere_light(place, 0.3, (1, 2, 3), camera=change == "lamp in view")
    view = room.scene.view(*SIZE, order=8, shadows=False)
    before = np.asarray(view.relight())
    if change == "mesh":
        room.box.to_world = moved(1, -1, 0)
    elif change == "material":
        room.box.set_bsdf(shlight.Bsdf.lambert((0.2, 0.9, 0.1)))
    elif change == "sky":
        room.scene.set_environment((0.2, 0.3, 0.5))
    else:
        lamp.to_world = moved(0.5, 0, 0.2)
    after = np.asarray(view.relight())
    truth = room.rendered(order=8, shadows=False)
    assert np.abs(after - truth).max() <= 1e-6 * truth.max()
    assert np.abs(after - before).max() > 0.01 * truth.max()


def test_many_lights_are_kept_together() -> None:
    room = Room()
    rng = np.random.default_rng(1)
    places = np.column_stack([rng.uniform(-3, 3, (100, 2)), rng.uniform(0.2, 2, 100)])
    lamps = [room.scene.add_sphere_light(place, 0.05, rng.uniform(1, 5, 3)) for place in places]
    view = room.scene.view(*SIZE, order=6, shadow_rays=16)
    view.relight()
    for lamp in lamps[::30]:
        lamp.to_world = moved(0, 0, 0.3)
    picture, report = lit(view, noise_threshold=0.02)
    assert report.noise <= 0.02
    assert relative(picture, room.rendered(order=6, shadow_rays=1024)) <= 0.03


def test_it_can_be_cancelled_and_needs_a_camera() -> None:
    room = Room()
    view = room.scene.view(*SIZE)
    with pytest.raises(shlight.RenderCancelled):
        view.relight(progress=lambda _: False)
    assert np.array_equal(np.asarray(view.relight()), np.asarray(room.scene.view(*SIZE).relight()))
    with pytest.raises(ValueError, match=r"^scene has no camera"):
        shlight.Scene().view(8, 8)
