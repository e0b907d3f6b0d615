# SPDX-License-Identifier: MIT
"""The pictures of `shlight charts`: their scenes, their errors, and that they are drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from charts_cases import drawn

import shlight
from shlight.charts import picture_measure, picture_panels, pictures, scenes


def noisy(rng: np.random.Generator, truth: Any, sigma: float) -> Any:
    return (truth + sigma * rng.normal(size=truth.shape)).astype(np.float32)


def test_the_references_noise_does_not_count_as_error() -> None:
    rng = np.random.default_rng(4)
    truth = np.ones((200, 300, 4))
    reference = picture_measure.Reference((noisy(rng, truth, 0.03), noisy(rng, truth, 0.03)), 2)
    error = reference.error(noisy(rng, truth, 0.01))
    assert error.value == pytest.approx(1e-4 / 1.01, rel=0.2)
    assert abs(error.value - 1e-4 / 1.01) <= 4 * error.uncertainty <= 1e-4
    perfect = reference.error(truth)
    assert abs(perfect.value) <= 4 * perfect.uncertainty
    assert str(picture_measure.Error(1e-6, 2e-6)) == "≤ 4e-06"
    assert str(picture_measure.Error(3e-5, 2e-6)) == "3.0e-05"


def test_equal_time_and_equal_quality(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures of noise, on a clock that they turn themselves: 2 s, and 0.1 s a sample."""
    now = [0.0]
    monkeypatch.setattr(picture_measure.time, "perf_counter", lambda: now[0])
    truth = np.ones((200, 300, 4))
    seeds: list[int] = []

    def harmonics(scene: Any, effort: Any, rays: Any, order: Any, **options: Any) -> Any:
        now[0] += 2.0
        return noisy(np.random.default_rng(1), truth, 0.02)

    def monte_carlo(scene: Any, effort: Any, samples: int, *, seed: int, **options: Any) -> Any:
        now[0] += 0.1 * samples
        seeds.append(seed)
        return noisy(np.random.default_rng([seed, samples]), truth, 0.2 / np.sqrt(samples))

    monkeypatch.setattr(picture_measure, "_harmonics", harmonics)
    monkeypatch.setattr(picture_measure, "_monte_carlo", monte_carlo)
    effort = replace(pictures.QUICK, half_samples=256, samples=(1, 16), most_samples=120)
    setting = replace(pictures.SETTINGS[0], build=lambda: None)
    found = picture_measure.compare(setting, effort, 7, lambda share, text: None)
    assert found.equal_time.effort == "20 samples a pixel"
    assert found.equal_time.seconds == pytest.approx(2.0)
    assert found.shown.error.value == pytest.approx(4e-4 / 1.01, rel=0.1)
    # (0.2 / 0.02)² samples have the same error, 0.1 s each.
    assert found.reached
    assert found.samples_for_quality == pytest.approx(100, rel=0.1)
    assert found.seconds_for_quality == pytest.approx(10, rel=0.1)
    assert found.equal_quality.error.value == pytest.approx(found.shown.error.value, rel=0.15)
    assert found.by_monte_carlo(found.shown) == pytest.approx(10, rel=0.1)
    # The reference shares no random number with what is compared to it.
    assert seeds[:2] == [8, 9]
    assert set(seeds[2:]) == {7}
    fewer = picture_measure.compare(setting, replace(effort, most_samples=50), 7, lambda share, text: None)
    assert not fewer.reached
    assert fewer.equal_quality.effort == "50 samples a pixel"
    assert fewer.seconds_for_quality == pytest.approx(10, rel=0.1)


@pytest.mark.parametrize(
    ("mesh", "closed"),
    [
        (scenes.ball((1, 2, 3), 0.5), True),
        (scenes.knot((1, 2, 3), 0.8, 0.16), True),
        (scenes.box((1, 2, 3), (0.3, 0.4, 0.5), 0.7), True),
        (scenes.vase((1, 2, 3), 1.1), False),
    ],
    ids=["ball", "knot", "box", "vase"],
)
def test_meshes_face_outwards(mesh: scenes.Mesh, closed: bool) -> None:
    corners = mesh.vertices[mesh.triangles] - np.array([1, 2, 3])
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(faces, axis=-1)
    real = area > 1e-12
    normals = mesh.normals[mesh.triangles][real]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1, rtol=1e-9)
    assert (np.einsum("tk,tik->ti", faces[real] / area[real, None], normals) > 0.9).all()
    volume = np.einsum("tk,tk->", corners.mean(axis=1), faces) / 6
    assert volume > 0
    if closed:
        np.testing.assert_allclose(faces.sum(axis=0), 0, atol=1e-9)


@pytest.mark.parametrize("setting", pictures.SETTINGS, ids=lambda setting: setting.name)
def test_the_scenes_are_lit_by_each_of_three_lights(
    setting: picture_measure.Setting, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = shlight.render(setting.build(), 48, 30, shadow_rays=4, pixel_samples=1, tolerance=1e-3)
    assert (whole[..., 3] == 1).mean() >= 0.99  # no sky
    assert np.median(whole[..., :3].mean(axis=-1)) >= 0.01
    alone = []
    lights = [("sphere", 0), ("sphere", 1), ("polygon", 0)]
    for kept in lights:
        counts = {"sphere": 0, "polygon": 0}

        def add(kind: str, real: Any, kept: Any = kept, counts: Any = counts) -> Any:
            def wrapped(self: Any, *arguments: Any) -> None:
                if (kind, counts[kind]) == kept:
                    real(self, *arguments)
                counts[kind] += 1

            return wrapped

        with monkeypatch.context() as patch:
            patch.setattr(shlight.Scene, "add_sphere_light", add("sphere", shlight.Scene.add_sphere_light))
            patch.setattr(shlight.Scene, "add_polygon_light", add("polygon", shlight.Scene.add_polygon_light))
            scene = setting.build()
        assert counts == {"sphere": 2, "polygon": 1}
        alone.append(shlight.render(scene, 48, 30, shadow_rays=4, pixel_samples=1, tolerance=1e-3)[..., :3].mean())
    assert min(alone) >= 0.05 * sum(alone)
    assert sum(alone) == pytest.approx(float(whole[..., :3].mean()), rel=0.02)


def test_insets_lie_in_the_picture() -> None:
    for middle in [(0.0, 0.0), (1.0, 1.0), *(inset for s in pictures.SETTINGS for inset in s.insets)]:
        (left, top), size = picture_panels._inset(middle, 240, 150)
        assert 0 <= left <= 240 - size
        assert 0 <= top <= 150 - size


def test_pictures_are_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    quick = replace(pictures.QUICK, width=48, height=30, half_samples=16, most_samples=32, rays=((1, 1), (4, 4)))
    monkeypatch.setattr(pictures, "QUICK", quick)
    result, rows = drawn("pictures", pictures.draw, tmp_path)
    assert (tmp_path / "pictures.png").is_file()
    assert (tmp_path / "pictures_curves.png").is_file()
    for name in ("matt", "gold"):
        own = [row for row in rows if row["scene"] == name]
        few, *_, many = [float(row["rel_mse"]) for row in own if row["way"] == "Monte Carlo with MIS"]
        assert many < few / 4  # 64 times the samples
        assert all(float(row["seconds"]) > 0 for row in own)
        (equal,) = [row for row in own if row["way"] == "equal time"]
        assert float(equal["rel_mse"]) > 0
    assert len(result.tables[0].rows) == 2 * 3
