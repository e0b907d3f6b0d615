# SPDX-License-Identifier: MIT
"""shlight.Scene and shlight.render from Python: closed forms, conventions, arguments, progress, cancelling, threads."""

from __future__ import annotations

import itertools
import os
import signal
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_cases import FACES, FLOOR, from_above, lit_floor

import shlight
from shlight import nodes
from shlight_tools import methods
from shlight_tools.bench.picture_scenes import lamp_at
from shlight_tools.charts.scenes import ball


def floor_points(size: int, half_size: float = 2.0) -> NDArray[np.float64]:
    centers = (2 * (np.arange(size) + 0.5) / size - 1) * half_size
    x, y = np.meshgrid(centers, -centers)
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


@pytest.mark.parametrize("facing_disk", [False, True])
def test_lambert_floor_under_a_sphere_light(facing_disk: bool) -> None:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR, FACES)
    scene.add_sphere_light([0.5, 0.25, 1.5], 0.5, [4, 2, 1], facing_disk=facing_disk)
    image = shlight.render(from_above(scene), 16, 16, pixel_samples=1, max_bounces=0)
    way = np.array([0.5, 0.25, 1.5]) - floor_points(16)
    distance = np.linalg.norm(way, axis=-1)
    square = 0.25 / (distance**2 + 0.25 * facing_disk)  # of the sine of half the angle that the light fills
    expected = 0.8 * square * way[..., 2] / distance
    assert image.dtype == np.float32
    assert image.shape == (16, 16, 4)
    assert image.flags.c_contiguous
    # Float rounding of hits and coefficients.
    np.testing.assert_allclose(image[..., :3], expected[..., None] * [4, 2, 1], rtol=0, atol=1e-5)
    np.testing.assert_array_equal(image[..., 3], 1)


def test_report_of_a_picture_that_is_not_square() -> None:
    image, report = shlight.render(
        lit_floor(), 32, 16, pixel_samples=2, max_samples=2, threads=2, return_report=True, max_bounces=0
    )
    assert image.shape == (16, 32, 4)
    assert report.hits == 32 * 16 * 2
    assert report.order_shares == {2: 1.0}
    assert report.over_tolerance == 0
    assert report.shadow_rays == 16 * report.hits
    assert list(report.stage_seconds) == ["camera rays", "views", "light", "shadows", "shadow rays", "pixels"]
    assert all(seconds > 0 for seconds in report.stage_seconds.values())
    assert sum(report.stage_seconds.values()) <= 2 * report.render_seconds


def test_pixels_that_have_enough_are_left_as_they_are() -> None:
    """A floor whose only edges are those of its shadow: three of four pixels end with their first ray."""
    scene = lit_floor()
    scene.add_mesh(FLOOR / 90 + np.array([0.2, 0.2, 0.5]), FACES)
    _, report = shlight.render(scene, 64, 64, min_samples=1, max_samples=4, return_report=True, max_bounces=0)
    assert report.passes <= 8  # one for each level, and for what neighbours suppose
    assert report.hits <= 2 * 64 * 64


def test_no_lights_is_black_and_background_is_transparent() -> None:
    scene = shlight.Scene()
    scene.add_mesh(FLOOR[:, :] / 18, FACES)  # x and y from -0.5 to 0.5
    from_above(scene, 1.0)
    image = shlight.render(scene, 8, 8, pixel_samples=1, max_bounces=0)
    np.testing.assert_array_equal(image[..., :3], 0)
    expected = np.zeros((8, 8))
    expected[2:6, 2:6] = 1
    np.testing.assert_array_equal(image[..., 3], expected)


def test_emission_per_material_and_instances() -> None:
    scene = shlight.Scene()
    transforms = np.array([np.eye(4), np.eye(4)])
    transforms[:, :3, :3] /= 18
    transforms[0, :3, 3] = [-1, 0, 0]
    transforms[1, :3, 3] = [1, 0, 0]
    transforms[1, 0, 0] *= -1  # mirrored
    scene.add_mesh(
        FLOOR,
        FACES,
        bsdf=[shlight.Bsdf.lambert(0.5), shlight.Bsdf.lambert(0.1)],
        emission=[[1, 0, 0], [0, 1, 0]],
        material_indices=[0, 1],
        transforms=transforms,
    )
    from_above(scene)
    image = shlight.render(scene, 64, 64, pixel_samples=1, max_bounces=0)
    # Triangle 0 lies to the lower right of the diagonal, in the mirrored instance to the lower left.
    assert image[36, 64 // 4 + 4, 0] == 1
    assert image[27, 64 // 4 - 4, 1] == 1
    assert image[36, 3 * 64 // 4 - 4, 0] == 1
    assert image[27, 3 * 64 // 4 + 4, 1] == 1


@pytest.mark.parametrize("radiance", [1e-39, 1e-44])
def test_a_light_too_dim_for_its_inverse_to_be_a_float_is_drawn(radiance: float) -> None:
    scene = lit_floor()
    scene.add_mesh(FLOOR / 18 + [0, 0, 0.5], FACES, emission=[radiance] * 3)
    image = shlight.render(scene, 16, 16, pixel_samples=1, shadow_rays=1, max_bounces=0)
    assert np.isfinite(image).all()


@pytest.mark.parametrize("mirrored", [False, True])
def test_each_side_emits_as_a_lamp_that_shines_there(mirrored: bool) -> None:
    square = np.array([[0, -0.5, 0.2], [0, 0.5, 0.2], [0, 0.5, 1], [0, -0.5, 1]])  # whose front is at x > 0
    front, back = np.array([4, 2, 1]), np.array([0, 1, 3])
    glowing, lamps = (shlight.Scene() for _ in range(2))
    for scene in (glowing, lamps):
        scene.add_mesh(FLOOR, FACES)
        from_above(scene)
    transform = np.diag([1, -1 if mirrored else 1, 1, 1])
    black = shlight.Bsdf.lambert(0.0)
    glowing.add_mesh(square, FACES, bsdf=black, emission=[[front, back]], transforms=[transform])
    lamps.add_mesh(square, FACES, bsdf=black)
    away = np.array([1e-6, 0, 0])
    lamps.add_polygon_light(square + away, front, camera=False)
    lamps.add_polygon_light(square[::-1] - away, back, camera=False)
    images = [shlight.render(scene, 32, 32, pixel_samples=1, max_bounces=0) for scene in (glowing, lamps)]
    np.testing.assert_allclose(*images, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("index", [np.int32, np.int64, np.uint32])
def test_array_types_do_not_matter(dtype: Any, index: Any) -> None:
    scene = shlight.Scene()
    # Fortran order and a strided view as well.
    scene.add_mesh(np.asfortranarray(FLOOR.astype(dtype)), np.repeat(FACES, 2, axis=1)[:, ::2].astype(index))
    scene.add_sphere_light((0.5, 0.25, 1.5), 0.5, np.array([4, 2, 1], dtype=dtype))
    from_above(scene)
    np.testing.assert_array_equal(
        shlight.render(scene, 8, 8, max_bounces=0), shlight.render(lit_floor(), 8, 8, max_bounces=0)
    )


def test_normals_per_vertex_and_per_corner_agree() -> None:
    normals = np.array([[1, 0, 2], [0, 1, 2], [-1, 0, 2], [0, -1, 2]], dtype=np.float32)
    by_vertex = shlight.render(lit_floor(normals=normals), 8, 8, max_bounces=0)
    by_corner = shlight.render(lit_floor(normals=normals[FACES]), 8, 8, max_bounces=0)
    np.testing.assert_array_equal(by_vertex, by_corner)
    assert np.abs(by_vertex - shlight.render(lit_floor(), 8, 8, max_bounces=0)).max() > 1e-3


def test_what_was_built_is_kept_until_something_is_added() -> None:
    scene = lit_floor()
    _, first = shlight.render(scene, 4, 4, return_report=True, max_bounces=0)
    image, second = shlight.render(scene, 4, 4, return_report=True, max_bounces=0)
    assert first.build_seconds > 0
    assert second.build_seconds == 0
    scene.add_sphere_light([0, 0, 2], 0.5, [1, 1, 1])
    brighter, third = shlight.render(scene, 4, 4, return_report=True, max_bounces=0)
    assert third.build_seconds > 0
    assert (brighter[..., :3] > image[..., :3]).all()


def test_a_glossy_penumbra_is_that_of_plain_monte_carlo() -> None:
    """Four shadow rays of a hit say little about a lobe whose peak is half hidden."""
    scene = shlight.Scene()
    mesh = ball((0, 0, 0), 1.0)
    metal = shlight.Bsdf.ggx(0.3, (0.9, 0.6, 0.4))
    scene.add_mesh(mesh.vertices, mesh.triangles, normals=mesh.normals, bsdf=metal)
    scene.add_mesh([[-8, -8, 2], [0, -8, 2], [0, 8, 2], [-8, 8, 2]], FACES)
    lamp = lamp_at((0.5, -1.5, 4), (0, 0, 0), 1.5, 1.5, (12, 8, 4))
    scene.add_polygon_light(lamp.corners, lamp.radiance)
    scene.set_camera(shlight.look_at((0, -3, 1.5), (-0.144, -0.134, 0.602)), 0.03)
    image = shlight.render(scene, 8, 8, min_samples=256, max_samples=256, noise_threshold=0.0, max_bounces=0)
    expected = methods.render_monte_carlo(scene, 8, 8, samples=16384)
    # A million rays whose values vary by about their mean: 1e-3; and the renderer's tolerance of 1e-3.
    np.testing.assert_allclose(image.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=5e-3)


def test_the_picture_as_it_stands() -> None:
    shown: list[tuple[Any, shlight.RenderReport]] = []

    def end_after_two(image: Any, report: shlight.RenderReport) -> bool:
        shown.append((image, report))
        return report.passes < 2

    image, report = shlight.render(lit_floor(), 48, 32, on_update=end_after_two, return_report=True, max_bounces=0)
    assert report.passes == 2
    np.testing.assert_array_equal(image, shown[-1][0])
    assert not np.array_equal(image, shown[0][0])
    assert 0 < report.noise < 1
    assert shown[-1][1].seconds_left >= 0
    again = shlight.render(lit_floor(), 48, 32, threads=1, on_update=lambda _, seen: seen.passes < 2, max_bounces=0)
    np.testing.assert_array_equal(image, again)
    with pytest.raises(ZeroDivisionError):
        shlight.render(lit_floor(), 48, 32, on_update=lambda image, report: 1 / 0, max_bounces=0)


def test_doubled_faces_are_dark_where_they_are_asked_to_be() -> None:
    scene = lit_floor()
    lit = shlight.render(scene, 48, 32, max_bounces=0)
    assert lit.report.doubled == []
    scene.add_mesh([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]])
    again = shlight.render(scene, 48, 32, max_bounces=0)
    assert len(again.report.doubled) == 2
    np.testing.assert_allclose(again, lit, rtol=1e-5)
    dark = shlight.render(scene, 48, 32, max_bounces=0, darken_doubled=True)
    assert dark.report.doubled == again.report.doubled
    assert np.asarray(dark)[16, 24, :3].max() == 0 < np.asarray(lit)[16, 24, :3].min()


def test_no_time_is_left_in_the_end() -> None:
    left: list[float] = []

    def keep(_: Any, report: shlight.RenderReport) -> bool:
        left.append(report.seconds_left)
        return True

    shlight.render(lit_floor(), 48, 32, on_update=keep, max_bounces=0)
    assert max(left) > left[-1] == 0


def test_the_noise_that_is_told_goes_down() -> None:
    scene = lit_floor()
    scene.add_mesh([[-1, -0.5, 0.3], [1, -0.5, 0.3], [0, 1, 0.6]], [[0, 1, 2]], bsdf=shlight.Bsdf.lambert(0.5))
    told: list[float] = []

    def keep(_: Any, report: shlight.RenderReport) -> bool:
        told.append(report.noise)
        return True

    shlight.render(scene, 96, 64, on_update=keep, max_bounces=2)
    known = [noise for noise in told if noise > 0]
    assert len(known) > 3
    assert all(after <= 4 / 3 * before for before, after in itertools.pairwise(known))


def error_of(image: Any, truth: Any) -> float:
    """The noise of an image, as a report defines it."""
    value = np.asarray(truth[..., :3], np.float64)
    error = np.asarray(image[..., :3], np.float64) - value
    return float(np.sqrt((error**2 / (value**2 + 0.01 * value.mean() ** 2)).mean()))


def test_the_noise_of_what_is_finer_than_pixels_is_told() -> None:
    place = nodes.position()
    wave = 5000.0 * nodes.values.operation("sine", 917.3 * place.x + 1231.7 * place.y)
    scene = lit_floor(bsdf=nodes.lambert(wave - nodes.values.operation("floor", wave)))
    truth = shlight.render(scene, 48, 32, pixel_samples=1024, max_samples=1024, seed=1)
    for settings in ({"noise_threshold": 0.1}, {"pixel_samples": 64, "max_samples": 64}):
        image = shlight.render(scene, 48, 32, **settings)  # type: ignore[arg-type]
        assert 0.45 <= image.report.noise / error_of(image, truth) <= 1.2


def test_the_noise_of_as_many_rays_everywhere_is_told_with_bounces() -> None:
    scene = lit_floor()
    scene.add_mesh([[-1, -0.5, 0.3], [1, -0.5, 0.3], [0, 1, 0.6]], [[0, 1, 2]], bsdf=shlight.Bsdf.lambert(0.5))
    truth = shlight.render(scene, 48, 32, pixel_samples=1024, max_samples=1024, max_bounces=1, seed=1)
    image = shlight.render(scene, 48, 32, pixel_samples=16, max_samples=16, max_bounces=1)
    assert 0.5 <= image.report.noise / error_of(image, truth) <= 2


MESH_ERRORS: dict[str, Any] = {
    "vertices": np.full_like(FLOOR, np.nan),
    "triangles": [[0, 1, 4]],
    "bsdf": [0.8],
    "material_indices": [0, -1],
    "transforms": [np.ones((4, 4))],
}


@pytest.mark.parametrize(("name", "bad"), MESH_ERRORS.items())
def test_bad_meshes_leave_the_scene_as_it_was(name: str, bad: Any) -> None:
    scene = lit_floor()
    before = shlight.render(scene, 4, 4, max_bounces=0)
    arguments: dict[str, Any] = {"vertices": FLOOR + np.array([0, 0, 1]), "triangles": FACES, name: bad}
    with pytest.raises(ValueError, match=f"^{name}"):
        scene.add_mesh(**arguments)
    after, report = shlight.render(scene, 4, 4, return_report=True, max_bounces=0)
    np.testing.assert_array_equal(after, before)
    assert report.build_seconds == 0


# --- while a picture is drawn, by the library and by Monte Carlo


def monte_carlo(scene: shlight.Scene, width: int, height: int, pixel_samples: int = 16, **options: Any) -> Any:
    return methods.render_monte_carlo(scene, width, height, samples=pixel_samples, **options)


both_renderers = pytest.mark.parametrize("render", [partial(shlight.render, max_bounces=0), monte_carlo])
SLOW: dict[str, Any] = {"width": 2000, "height": 2000, "pixel_samples": 256}


@both_renderers
def test_threads_do_not_change_a_bit(render: Callable[..., Any]) -> None:
    scene = lit_floor(bsdf=shlight.Bsdf.ggx(0.8, 0.5))
    scene.add_mesh(FLOOR / 20 + [0, 0, 0.5], FACES)
    one = render(scene, 33, 21, threads=1)
    np.testing.assert_array_equal(one, render(scene, 33, 21, threads=2))
    np.testing.assert_array_equal(one, render(scene, 33, 21))
    assert np.isfinite(one).all()


@both_renderers
def test_progress_rises_to_one_in_the_calling_thread(render: Callable[..., Any]) -> None:
    shares: list[float] = []
    threads: set[int] = set()

    def progress(share: float) -> None:
        shares.append(share)
        threads.add(threading.get_ident())

    render(lit_floor(bsdf=shlight.Bsdf.ggx(0.9, 0.5)), 150, 150, progress=progress)
    assert threads == {threading.get_ident()}
    assert shares == sorted(shares)
    assert shares[-1] == 1
    assert all(0 <= share <= 1 for share in shares)


@both_renderers
@pytest.mark.parametrize("answer", [False, np.False_])
def test_false_cancels(render: Callable[..., Any], answer: Any) -> None:
    start = time.monotonic()
    with pytest.raises(shlight.RenderCancelled):
        render(lit_floor(), **SLOW, progress=lambda share: answer)
    assert time.monotonic() - start < 10
    assert issubclass(shlight.RenderCancelled, RuntimeError)


def test_a_build_that_was_cancelled_is_done_again() -> None:
    scene, picture = lit_floor(), shlight.render(lit_floor(), 8, 8, max_bounces=0)
    asked: list[float] = []
    with pytest.raises(shlight.RenderCancelled):
        shlight.render(scene, 8, 8, progress=lambda share: asked.append(share) is not None, max_bounces=0)
    assert asked == [0.0]
    image, report = shlight.render(scene, 8, 8, return_report=True, max_bounces=0)
    assert report.build_seconds > 0
    np.testing.assert_array_equal(image, picture)


@both_renderers
def test_errors_of_the_callback_propagate(render: Callable[..., Any]) -> None:
    def progress(share: float) -> None:
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        render(lit_floor(), **SLOW, progress=progress)


def test_control_c_ends_the_render() -> None:
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        shlight.render(lit_floor(), **SLOW, max_bounces=0)
    assert time.monotonic() - start < 10
    timer.join()


def test_other_threads_run_meanwhile() -> None:
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    try:
        with pytest.raises(shlight.RenderCancelled):
            shlight.render(
                lit_floor(), **SLOW, threads=1, progress=lambda share: time.monotonic() - start < 0.3, max_bounces=0
            )
    finally:
        done.set()
        thread.join()
    assert len(ticks) > 12


def test_negative_light_takes_light_away() -> None:
    scene = lit_floor()
    bright = shlight.render(scene, 4, 4, max_bounces=0)
    scene.add_sphere_light([0.5, 0.25, 1.5], 0.5, [-4, -2, -1])
    dark = shlight.render(scene, 4, 4, max_bounces=0)
    assert bright[..., :3].min() > 0
    np.testing.assert_allclose(dark[..., :3], 0, atol=1e-7)


def test_the_report_says_why_a_picture_is_black() -> None:
    def dark(*vertices: Any, radiance: Any = (1, 1, 1)) -> str:
        scene = shlight.Scene()
        scene.add_mesh(FLOOR, FACES)
        if vertices:
            scene.add_polygon_light(vertices, radiance)
        return str(shlight.render(from_above(scene), 4, 4, return_report=True, max_bounces=0)[1].dark)

    above = [[-1, -1, 3], [1, -1, 3], [1, 1, 3]]
    assert dark() == "the scene has no light"
    assert "the side that sees their vertices counter-clockwise" in dark(*above)
    assert dark(*above[::-1]) == ""
