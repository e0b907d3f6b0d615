# SPDX-License-Identifier: MIT
"""The pages of docs/api show every public name, and examples in docstrings print what they say."""

from __future__ import annotations

import doctest
import pydoc
import re
from pathlib import Path

import numpy as np
import pytest

import shlight
from shlight import nodes

PAGES = Path(__file__).parents[2] / "docs" / "api"
TEXT = "\n".join(page.read_text() for page in sorted(PAGES.glob("*.md")))
# nodes.osl.osl is the function nodes.osl, which hides the module.
SHOWN = [re.sub(r"\.(\w+)\.\1$", r".\1", name) for name in re.findall(r"(?m)^::: shlight\.(\S+)", TEXT)]


def examples(name: str) -> list[doctest.DocTest]:
    """The examples of a name of the pages, and of its members."""
    known = {"np": np, "shlight": shlight, "nodes": nodes}
    found = doctest.DocTestFinder().find(pydoc.locate(f"shlight.{name}"), name, globs=known)
    return [own for own in found if own.examples]


def test_each_public_name_is_on_one_page() -> None:
    expected = {*shlight.__all__, "farm"} - {"nodes"} | {f"nodes.{name}" for name in nodes.__all__}
    assert sorted(SHOWN) == sorted(expected)


@pytest.mark.parametrize("name", SHOWN)
def test_examples_print_what_they_say(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for example in examples(name):
        assert doctest.DocTestRunner().run(example).failed == 0


def test_what_is_called_most_has_an_example() -> None:
    assert sum(bool(examples(name)) for name in SHOWN) >= 20
