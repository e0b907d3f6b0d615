# SPDX-License-Identifier: MIT
"""Scripts of Open Shading Language in Python; tests/blender/test_scripts.py compares their values with Cycles."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

from shlight import nodes
from shlight.nodes.program import ProgramBuilder

HEAD = "OpenShadingLanguage 1.00\nshader s\n"
SYMBOLS = """param float x 0 %read{0,0}
param color c 0.1 0.2 0.3
oparam float y 7
oparam color d 0 0 0
local float[4] list
local int i
const int $one 1
const int $none 0
const float $half 0.5
temp int $more
code ___main___
"""


def script(*code: str) -> str:
    return HEAD + SYMBOLS + "".join(f"\t{line}\n" for line in (*code, "end"))


def value(output: Any) -> list[float]:
    """The numbers of an output without a scene, where all inputs of the surface are 0."""
    builder = ProgramBuilder()
    builder.result([output] if isinstance(output, nodes.Value) else list(output))
    return [float(row[0]) for row in builder.program().evaluate([], 1)]


def test_outputs_are_expressions() -> None:
    text = script("mul y x $half", "add d c x")
    found = nodes.osl(text, x=nodes.position().x + 3.0)
    assert value(found["y"]) == [1.5]
    assert value(found["d"]) == [np.float32(c) + np.float32(3) for c in np.float32([0.1, 0.2, 0.3])]
    assert isinstance(found["d"], nodes.Color)
    assert value(nodes.osl(text, c=(1.0, 2.0, 3.0))["d"]) == [1.0, 2.0, 3.0], "x has the script's value"
    assert value(nodes.osl(script())["y"]) == [7.0]


def test_indices_stay_in_their_array() -> None:
    beyond = script("add i $none x", "assign i x", "aassign list i $half", "aref y list i")
    for index in (-5.0, 2.0, 9.0, 3e9, np.float32(1e30)):
        assert value(nodes.osl(beyond, x=index)["y"]) == [0.5]


def test_an_endless_loop_ends() -> None:
    start = time.process_time()
    found = value(nodes.osl(script("assign y x", "while $one 2 2 3 3", "add y y $half"), x=1.0)["y"])
    assert found == [1.0 + 0.5 * 2**20]
    assert time.process_time() - start < 5.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (5, "compiled script"),
        ("shader s() {}", "compiled script"),
        (HEAD + "param float x 0\n", "no instructions"),
        (HEAD + "param float\ncode ___main___\n", "without a name"),
        (HEAD + "param float[9999999] x\ncode ___main___\n", "unknown type"),
        (HEAD + "param float x y\ncode ___main___\n", "no number"),
        (script("add y x"), "not supported"),
        (script("texture y x x"), "uses texture, which is not supported"),
        (script("add y x nothing"), "uses nothing"),
        (script("if $one 1"), "jumps of if that are missing"),
        (script("if $one 9 99"), "leads nowhere"),
        (script("while $one 3 2 1 0", "break"), "leads nowhere"),
        (script(*(f"functioncall $one {200}" for _ in range(200))), "too deep"),
        (script("break"), "uses break"),
    ],
)
def test_nonsense_is_refused(text: Any, words: str) -> None:
    with pytest.raises(ValueError, match="script") as error:
        nodes.osl(text)
    assert words in str(error.value)


def test_inputs_are_checked() -> None:
    for given in ({"nothing": 1.0}, {"y": 1.0}, {"x": "wide"}, {"x": np.nan}, {"c": (1.0, 2.0)}):
        with pytest.raises(ValueError, match=next(iter(given))):
            nodes.osl(script("mul y x $half"), **given)
