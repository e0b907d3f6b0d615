# SPDX-License-Identifier: MIT
"""The parts of `./dev preview` that need no Blender."""

from __future__ import annotations

import io
import re
from typing import Any

import numpy as np
import pytest

from shlight_blender.compare import measure, pictures, reference
from shlight_blender.worker_process import Stage
from shlight_tools.preview.picture import common_exposure
from shlight_tools.preview.progress import Progress


def test_calibration_finds_the_samples_in_less_than_the_time() -> None:
    calls = []

    def render(samples: int) -> float:
        calls.append(0.05 + 0.003 * samples)
        return calls[-1]

    found = reference.calibrate(render, 1.25, 100000)
    assert found.samples(1.25) == 400
    assert found.seconds(4096) == pytest.approx(0.05 + 0.003 * 4096)
    assert sum(calls) <= 0.5 * 1.25
    # A target shorter than one sample takes.
    assert reference.calibrate(render, 0.01, 100000).samples(0.01) == 1


def halves_of(most: int, budget: float, per_sample: float = 0.1) -> tuple[list[Any], dict[str, Any]]:
    """Halves whose sample number i has the value i, 1000 more in the second. All but the first take thrice the time."""

    def render(half: int, first: int, samples: int) -> tuple[float, Any]:
        values = 1000 * half + np.arange(first, first + samples)
        seconds = 0.1 + per_sample * samples * (3 if first else 1)
        return seconds, np.full((1, 1, 3), values.mean(), np.float32)

    return reference.render_halves(
        render, reference.SampleTime({1: 0.1 + per_sample, 8: 0.1 + 8 * per_sample}), most, budget
    )


def test_the_reference_keeps_to_its_time_and_its_samples() -> None:
    halves, told = halves_of(10000, 60.0)
    assert told["stopped_by"] == "seconds"
    assert 60 * 15 / 16 <= told["seconds"] <= 60 * 1.25
    each = told["samples"] // 2
    assert len(set(told["chunks"])) > 1
    assert [half[0, 0, 0] for half in halves] == pytest.approx([(each - 1) / 2, 1000 + (each - 1) / 2], rel=1e-6)
    for budget in (1e6, 0.0):
        told = halves_of(101, budget)[1]
        assert (told["samples"], told["stopped_by"]) == (102, "samples")
    assert halves_of(101, 1.0, per_sample=100.0)[1]["samples"] == 2


def test_a_render_that_takes_long_before_its_first_sample_gets_more_of_them() -> None:
    def render(half: int, first: int, samples: int) -> tuple[float, Any]:
        return 4.0 + 0.01 * samples, np.zeros((1, 1, 3), np.float32)

    told = reference.render_halves(render, reference.SampleTime({1: 8.0}), 10000, 40.0)[1]
    assert told["samples"] >= 100
    assert told["seconds"] <= 40 * 1.25


def test_an_error_that_noise_hides_is_given_as_a_bound() -> None:
    assert measure.error_text({"rel_mse": 3.14e-5, "rel_mse_standard_error": 2e-6}) == "3.1e-05 ± 2e-06"
    assert measure.error_text({"rel_mse": 3e-6, "rel_mse_standard_error": 2e-6}) == "≤ 7.0e-06"
    assert measure.error_text({"rel_mse": -3e-6, "rel_mse_standard_error": 2e-6}) == "≤ 4.0e-06"


def test_a_terminal_shows_a_bar_that_is_full_only_at_the_end() -> None:
    stream = io.StringIO()
    stream.isatty = lambda: True
    progress = Progress(stream)
    progress.show(Stage("reference", expected=1e-9))
    progress.note("look")
    assert "[#######################.]" in stream.getvalue()
    assert re.search(r"reference: \d\.\d s\nlook\n$", stream.getvalue())


def test_the_picture_is_bright_enough_and_its_scale_round() -> None:
    dim = np.full((10, 10, 3), 0.1, np.float32)
    assert common_exposure(dim) == pytest.approx(3)
    assert common_exposure(0 * dim) == 0
    for share, limit in ((0.012, 2.0), (0.02, 2.0), (0.049, 5.0), (0.08, 10.0), (0.0, 0.1)):
        assert pictures.difference_limit(np.full((8, 8), -share)) == pytest.approx(limit)
