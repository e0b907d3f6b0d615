# SPDX-License-Identifier: MIT
"""Scripts of Open Shading Language, whose instructions the core interprets hit by hit."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from shlight.nodes import inputs as sources
from shlight.nodes.oso import Instruction, Script, Symbol, parse
from shlight.nodes.script_operations import Computation
from shlight.nodes.script_registers import CoreScript
from shlight.nodes.values import Color, Value, Varying, Vector, number, steps, vector

GLOBALS: dict[str, Callable[[], Value | Vector]] = {
    "P": sources.position,
    "N": sources.normal,
    "Ng": sources.geometric_normal,
    "I": sources.towards_viewer,
    "u": lambda: sources.barycentric().x,
    "v": lambda: sources.barycentric().y,
}
NOTHING = frozenset(("nop", "end", "useparam", "printf", "fprintf", "warning", "error"))
MOST_NESTED = 100
MOST_NUMBERS = 128, 32  # of inputs and outputs


def osl(script: str, /, **inputs: Varying) -> dict[str, Value | Vector]:
    """The outputs, by name, of a script of Open Shading Language that was compiled by oslc.

    script: the text of the .oso file. inputs: the script's parameters by name; those that are left out have the values
        that the script gives them. Numbers, vectors and colours are supported, not closures, matrices, textures,
        derivatives and attributes. A script that jumps back a million times ends there.
    Functions are rounded as in Cycles. Raises ValueError naming the argument, also where the script uses what is not
    supported.
    """
    known, arguments = [], []
    parsed = parse(script)
    for name, given in inputs.items():
        symbol = parsed.symbols.get(name)
        if symbol is None or symbol.kind != "param" or symbol.length is not None or not symbol.default:
            raise ValueError(f"{name} is no number, vector or colour that the script asks for")
        parts = [number(given, name)] if symbol.width == 1 else list(vector(given, name))
        constants = [part.constant for part in parts]
        if None in constants:
            arguments.append((name, parts))
        else:
            known.append((name, tuple(constants)))
    core, read, outputs = _translated(script, tuple(known), tuple(name for name, _ in arguments))
    values = [part for _, parts in arguments for part in parts]
    for name in read:
        found = GLOBALS[name]()
        values += [found] if isinstance(found, Value) else list(found)
    made = iter(steps("script", *values, data=core))
    results: dict[str, Value | Vector] = {}
    for name, kind in outputs:
        if kind in ("float", "int"):
            results[name] = next(made)
        else:
            results[name] = (Color if kind == "color" else Vector)(next(made), next(made), next(made))
    return results


@lru_cache(maxsize=64)
def _translated(
    script: str, known: tuple[tuple[str, tuple[float, ...]], ...], given: tuple[str, ...]
) -> tuple[CoreScript, list[str], list[tuple[str, str]]]:
    """The core's script; names of globals that it reads after its arguments; names and types of outputs."""
    return _Translation(parse(script), dict(known), given).result()


class _Translation(Computation):
    """Lists the core's instructions of a script: blocks become jumps."""

    def __init__(self, script: Script, known: dict[str, tuple[float, ...]], given: tuple[str, ...]) -> None:
        super().__init__()
        self.script, self.known = script, known
        self.loops: list[tuple[list[int], list[int]]] = []  # jumps of `break` and of `continue`
        self.returns: list[list[int]] = []
        self.depth = 0
        symbols = script.symbols.values()
        self.arguments = [script.symbols[name] for name in given]
        used = {argument.name for op in script.code for argument in op.arguments}
        self.globals = [s for s in symbols if s.kind == "global" and s.name in used and s.name in GLOBALS]
        for symbol in [*self.arguments, *self.globals]:
            symbol.register = self.reserve([0.0] * symbol.width)
        self.argument_count = len(self.registers)
        for symbol in symbols:
            if symbol not in self.globals and symbol not in self.arguments:
                self.place(symbol)

    def place(self, symbol: Symbol) -> None:
        """Gives a symbol registers, with what it holds at first."""
        if symbol.type not in ("float", "int", "color", "point", "vector", "normal") or symbol.kind == "global":
            return
        size = symbol.width * (symbol.length if symbol.length is not None else 1)
        if symbol.kind == "param" and symbol.name in self.known:
            symbol.default, symbol.is_initialized = list(self.known[symbol.name]), False
        values = (symbol.default + [0.0] * size)[:size]
        if symbol.is_int:
            values = [float(np.trunc(value)) for value in values]
        if symbol.kind in ("param", "const") and symbol.writes == 0 and not symbol.is_initialized:
            symbol.known = tuple(values)
        symbol.register = self.reserve(values, is_int=symbol.is_int)

    def result(self) -> tuple[CoreScript, list[str], list[tuple[str, str]]]:
        for symbol in self.arguments:
            if symbol.is_int:
                self.emit("to_int", symbol.register, symbol.register)
        for name, (first, last) in self.script.first_values.items():
            if name not in self.known and name not in (s.name for s in self.arguments):
                self.block(first, last)
        self.returns.append([])
        self.block(self.script.begin, len(self.script.code))
        self.land(self.returns.pop())
        results: list[int] = []
        outputs = [s for s in self.script.symbols.values() if s.kind == "oparam" and s.register >= 0]
        outputs = [s for s in outputs if s.length is None]
        for symbol in outputs:
            results += [self.as_float(symbol, i) for i in range(symbol.width)]
        if self.argument_count > MOST_NUMBERS[0] or len(results) > MOST_NUMBERS[1]:
            raise ValueError("script has too many inputs or outputs")
        named = [s.register for s in self.script.symbols.values() if s.kind in ("local", "param", "oparam")]
        core = self.core(self.argument_count, results, named)
        return core, [s.name for s in self.globals], [(s.name, s.type) for s in outputs]

    def jump(self, list_of_jumps: list[int], unless: int | None = None) -> None:
        """Adds a jump to a list of those that will land at one place."""
        list_of_jumps.append(len(self.code))
        self.emit("jump" if unless is None else "jump_unless", 0, unless or 0)

    def land(self, jumps: list[int]) -> None:
        """The next instruction is where jumps lead to."""
        for place in jumps:
            self.code[place][1] = len(self.code)

    def block(self, first: int, last: int) -> None:
        """Instructions from one up to another."""
        self.depth += 1
        if self.depth > MOST_NESTED:
            raise ValueError("script has blocks that lie too deep in each other")
        while first < last:
            op = self.script.code[first]
            after = first + 1
            if op.jumps:
                ends = [after, *op.jumps]
                if ends != sorted(ends) or ends[-1] > last:
                    raise ValueError(f"script has a jump of {op.name} that leads nowhere")
                after = ends[-1]
            self.instruction(op, first)
            first = after
        self.depth -= 1

    def instruction(self, op: Instruction, place: int) -> None:
        if op.name in NOTHING:
            return
        counts = {"if": 2, "for": 4, "while": 4, "dowhile": 4, "functioncall": 1}
        if len(op.jumps) != counts.get(op.name, 0):
            raise ValueError(f"script has jumps of {op.name} that are missing")
        if op.name == "if":
            self.branch(op, place)
        elif op.name in ("for", "while", "dowhile"):
            self.loop(op, place)
        elif op.name == "functioncall":
            self.returns.append([])
            self.block(place + 1, op.jumps[0])
            self.land(self.returns.pop())
        elif op.name in ("break", "continue") and self.loops:
            self.jump(self.loops[-1][op.name == "continue"])
        elif op.name in ("return", "exit") and self.returns:
            self.jump(self.returns[-1 if op.name == "return" else 0])
        else:
            self.compute(op)

    def branch(self, op: Instruction, place: int) -> None:
        to_else: list[int] = []
        self.jump(to_else, unless=self.truth(op.arguments[0]))
        self.block(place + 1, op.jumps[0])
        if op.jumps[1] > op.jumps[0]:
            to_end: list[int] = []
            self.jump(to_end)
            self.land(to_else)
            self.block(*op.jumps)
            to_else = to_end
        self.land(to_else)

    def loop(self, op: Instruction, place: int) -> None:
        condition, body, step, end = op.jumps
        self.block(place + 1, condition)
        again = len(self.code)
        breaks, continues = [], []  # type: list[int], list[int]
        self.loops.append((breaks, continues))
        if op.name != "dowhile":
            self.block(condition, body)
            self.jump(breaks, unless=self.truth(op.arguments[0]))
        self.block(body, step)
        self.land(continues)
        self.block(step, end)
        if op.name == "dowhile":
            self.block(condition, body)
            self.jump(breaks, unless=self.truth(op.arguments[0]))
        self.emit("jump", again)
        self.loops.pop()
        self.land(breaks)
