# SPDX-License-Identifier: MIT
"""The faults that `./dev test --faults` plants, as they are listed and as they are drawn."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "faults"))

import mutations  # noqa: E402
import plant  # noqa: E402


def test_listed_faults_fit_the_sources_and_name_tests_that_are_there() -> None:
    faults = plant.listed()
    assert len({fault.about for fault in faults}) == len(faults) >= 80
    suites = {
        line.split("(")[1].split(",")[0].strip()
        for file in (ROOT / "tests/core").glob("test_*.cpp")
        for line in file.read_text().splitlines()
        if line.startswith(("TEST(", "TEST_F(", "TEST_P(", "TYPED_TEST(", "INSTANTIATE"))
    }
    for fault in faults:
        text = (ROOT / fault.file).read_text()
        assert fault.planted(text) != text
        if fault.test.startswith("tests/"):
            file, _, name = fault.test.split()[0].partition("::")
            assert f"def {name.partition('[')[0]}" in (ROOT / file).read_text(), fault.test
        elif fault.test:
            assert any(re.fullmatch(fault.test, suite) for suite in suites), fault.test


def test_drawn_faults_are_other_ones_for_each_seed() -> None:
    first, again, other = ([plant.Fault(*each) for each in mutations.draw(ROOT, 40, seed)] for seed in (1, 1, 2))
    assert first == again
    assert len(set(first) & set(other)) < 10  # some are the same by chance
    for fault in first:
        text = (ROOT / fault.file).read_text()
        assert fault.planted(text) != text
