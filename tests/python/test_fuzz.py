# SPDX-License-Identifier: MIT
"""Random calls and scenes with seeds that are kept, and the fuzzer with planted faults."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import fuzz
import fuzz_calls
import numpy as np
import pytest
from fuzz_calls import Step

import shlight

FOLDER = str(Path(fuzz.__file__).parent)


@pytest.mark.parametrize(("calls", "scenes"), [(400, 10), pytest.param(30_000, 700, marks=pytest.mark.slow)])
def test_calls_and_scenes_are_answered(calls: int, scenes: int) -> None:
    found = fuzz.run({"call": calls, "scene": scenes}, seed=1)
    assert not found, fuzz.report(found)


def faulty(fault: str, **counts: int) -> dict[fuzz.Case, str]:
    """What is found where a function is replaced in all processes that work."""
    script = f"import os, sys\nsys.path.insert(0, {FOLDER!r})\nimport shlight\n{fault}\nimport fuzz\nfuzz.main()"
    return fuzz.run({"call": 0, "scene": 0, **counts}, seed=1, limit=0.5, program=(sys.executable, "-c", script))


@pytest.mark.parametrize(
    ("function", "problem"),
    [
        ("lambda **_: os.abort()", "ended with -6"),
        pytest.param("lambda **_: sum(iter(int, 1))", "hangs", marks=pytest.mark.slow),
    ],
)
def test_ends_and_hangs_are_found_and_the_others_still_tried(function: str, problem: str) -> None:
    found = faulty(f"shlight.disk_coefficients = {function}", call=14)
    calls = [
        case for case in (fuzz.Case("call", 1, n) for n in range(14)) if case.steps()[0].call == "disk_coefficients"
    ]
    assert [case for case, each in found.items() if problem in each] == calls
    assert len(calls) > 1


@pytest.mark.parametrize(
    ("result", "problem"),
    [
        (lambda c: c * np.nan, "not finite"),
        (lambda c: -c, "negative or too large"),
        (lambda c: 100 * c, "negative or too large"),
        (lambda c: c * np.arange(1, 10), "band 1"),
        (lambda c: np.array(3 * [*c[:1], 0, 0]), "squares"),
        (lambda c: c[:4], "shape"),
    ],
)
def test_wrong_coefficients_are_found(result: Any, problem: str) -> None:
    sphere = {"centers": [0, 0, 2.0], "radii": 1.9, "order": 3}

    def check(c: Any) -> str | None:
        return fuzz_calls.coefficient_problem(c, (9,), clip=True, zero=False)

    assert Step("", shlight.sphere_coefficients, sphere, True, check).complaint() is None
    wrong = Step("", lambda **given: result(shlight.sphere_coefficients(**given)), sphere, True, check)
    assert problem in str(wrong.complaint())
