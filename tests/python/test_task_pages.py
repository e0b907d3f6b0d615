# SPDX-License-Identifier: MIT
"""The pages of docs/tasks show what their code prints, and the pictures that it makes."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

import shlight

ROOT = Path(__file__).parents[2]
TASKS = ROOT / "docs" / "tasks"
sys.path.insert(0, str(TASKS))

import build  # noqa: E402

NUMBER = re.compile(r"(?<![\w])[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
PICTURE = re.compile(r"!\[.*?\]\((images/.*?)\)")


LOOKED_AT = {"bounces", "models", "own_material"}  # pages that print no more of a picture than its mean
LONG = {"measured_material", "noise", "own_material", "passes", "relighting"}  # the code of which takes seconds


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=page.stem, marks=pytest.mark.slow if page.stem in LONG else ())
        for page in sorted(TASKS.glob("*.md"))
    ],
)
def test_a_page_is_as_its_code_has_it(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("images").mkdir()
    if page.stem in LOOKED_AT:
        render = shlight.render
        small = lambda scene, width, height, **options: render(scene, width // 3, height // 3, **options)  # noqa: E731
        monkeypatch.setattr(shlight, "render", small)
    made, written = build.built(page), page.read_text()
    assert NUMBER.sub("0", made) == NUMBER.sub("0", written)
    # Processors round differently, after which a ray may pass an edge that it meets elsewhere.
    numbers = [np.array(NUMBER.findall(text), dtype=float) for text in (made, written)]
    np.testing.assert_allclose(*numbers, rtol=0.03, atol=2e-3)
    for picture in PICTURE.findall(written):
        assert Path(picture).is_file()
        assert (TASKS / picture).is_file()


def test_the_code_of_the_first_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    build.built(ROOT / "README.md")
    assert shlight.images.read_texture("floor.png").mean() > 10
