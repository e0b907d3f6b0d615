# SPDX-License-Identifier: MIT
"""Scripts of Open Shading Language in Python; tests/blender/test_scripts.py compares their values with Cycles."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

from shlight import nodes
from shlight.nodes import script_reuse
from shlight.nodes.inputs import SOURCES
from shlight.nodes.program import ProgramBuilder
from shlight.nodes.script_registers import Registers
from shlight.nodes.values import steps

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


class RandomScript(Registers):
    """A script of random instructions, branches and loops, which repeats terms and copies them about."""

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__()
        self.rng = rng
        self.arguments = [self.reserve([0.0]) for _ in range(2)]
        self.variables = [self.reserve([float(i % 3)]) for i in range(12)]
        self.terms = [self.temporary()]
        self.results = self.variables[3:7]
        self.fixed = [self.constant(value) for value in (0.0, 0.5, 0.5, -2.0)]
        self.indices = [self.constant(value, is_int=True) for value in (0.0, 3.0, 9.0)]
        self.block(0)

    def any(self, registers: list[int]) -> int:
        return int(self.rng.choice(registers))

    def block(self, depth: int) -> None:
        for _ in range(self.rng.integers(3, 14)):
            kind = self.rng.integers(15 if depth < 3 else 13)
            known = [*self.variables, *self.arguments, *self.fixed, *self.terms[-3:]]
            a, b = self.any(known), self.any(known)
            to, wide = self.any([*self.variables, *self.terms[-2:]]), self.any(self.variables[:10])
            if kind < 6:
                self.emit(str(self.rng.choice(["add", "sub", "mul", "max"])), to, a, b)
            elif kind < 8:
                self.emit("copy" if kind == 6 else "sin", to, a)
            elif kind == 8:
                self.emit("load", to, self.variables[2], self.any(self.indices), 4)
            elif kind == 9:
                self.emit("store", self.variables[2], self.any(self.indices), a, 4)
            elif kind == 10:
                self.emit("dot", to, wide, self.variables[8])
            elif kind == 11:
                self.emit("hsv_to_rgb", wide, self.any(self.variables[:10]))
            elif kind == 12:
                self.terms.append(self.made("mul", a, b))
                self.emit("copy", to, self.terms[-1])
            else:
                self.nested(depth, a, is_loop=kind == 13)

    def nested(self, depth: int, condition: int, *, is_loop: bool) -> None:
        counter = self.temporary()
        self.emit("copy", counter, self.fixed[0])
        start = len(self.code)
        condition = self.made(
            "less", *((counter, self.constant(3.0)) if is_loop else (self.any(self.fixed), condition))
        )
        for _ in range(2 if is_loop else self.rng.integers(4)):
            condition = self.made("int_equal", condition, self.indices[0])
        branch = len(self.code)
        self.emit("jump_unless", 0, condition)
        self.block(depth + 1)
        if is_loop:
            self.emit("add", counter, counter, self.constant(1.0))
            self.emit("jump", start)
        self.code[branch][1] = len(self.code)

    def found(self, places: np.ndarray) -> np.ndarray:
        """The results of hits at these places."""
        core = self.core(len(self.arguments), self.results, self.variables[:8])
        builder = ProgramBuilder()
        builder.result(list(steps("script", nodes.position().x, nodes.position().y, data=core)))
        inputs = [((SOURCES["position"], 0, i), np.tile(places[i], (3, 1))) for i in range(2)]
        return np.asarray(builder.program().evaluate(inputs, places.shape[1]))


def test_what_is_left_out_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scripts without the instructions that are not needed give the same numbers; hits part, end and wait."""
    rng = np.random.default_rng(7)
    places = rng.normal(size=(2, 75)).astype(np.float32)
    lengths = []
    for _ in range(200):
        script = RandomScript(rng)
        monkeypatch.setattr(script_reuse, "MOST_INSTRUCTIONS", 2_000)
        found = script.found(places)
        lengths.append(len(script.core(2, script.results, script.variables).code) / (20 * len(script.code)))
        monkeypatch.setattr(script_reuse, "MOST_INSTRUCTIONS", 0)
        np.testing.assert_array_equal(found, script.found(places))
        one_by_one = [script.found(places[:, i : i + 1]) for i in range(0, 75, 9)]
        np.testing.assert_array_equal(found[:, ::9], np.concatenate(one_by_one, axis=1))
    assert np.mean(lengths) < 0.95, "of the instructions are left"
