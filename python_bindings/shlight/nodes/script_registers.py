# SPDX-License-Identifier: MIT
"""The registers of a script in the core, and its instructions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from shlight import _core
from shlight.nodes.oso import Symbol
from shlight.nodes.script_reuse import Reuse

SPARE = 4  # registers after the last one, as instructions of several registers need them
MOST_REGISTERS = 1 << 20


@dataclass(frozen=True)
class CoreScript:
    """A script as the core has it; equal ones are one."""

    code: bytes
    registers: bytes
    arguments: int
    results: tuple[int, ...]

    @property
    def core(self) -> tuple[Any, Any, int, list[int]]:
        """The arguments of the core."""
        code, registers = (np.frombuffer(words, np.uint32) for words in (self.code, self.registers))
        return code, registers, self.arguments, list(self.results)


@lru_cache(maxsize=1)
def _numbers() -> dict[str, int]:
    return {name: i for i, name in enumerate(_core.script_instructions())}


class Registers:
    """The instructions of a script that are listed so far, and what its registers hold at first."""

    def __init__(self) -> None:
        self.code: list[list[int]] = []
        self.registers: list[np.uint32] = []

    def reserve(self, values: list[float], *, is_int: bool = False) -> int:
        """The first of registers that hold these values at first."""
        if len(self.registers) + len(values) > MOST_REGISTERS:
            raise ValueError("script has arrays that are too large")
        first = len(self.registers)
        with np.errstate(over="ignore", invalid="ignore"):
            made = np.array(values, np.float64)
            made = made.astype(np.int64).astype(np.int32) if is_int else made.astype(np.float32)
        self.registers += list(made.view(np.uint32))
        return first

    def temporary(self, size: int = 1) -> int:
        return self.reserve([0.0] * size)

    def constant(self, value: float, *, is_int: bool = False) -> int:
        return self.reserve([value], is_int=is_int)

    def emit(self, name: str, to: int, a: int = 0, b: int = 0, c: int = 0) -> int:
        """Adds an instruction; the register that it writes."""
        self.code.append([_numbers()[name], to, a, b, c])
        return to

    def made(self, name: str, a: int, b: int = 0, c: int = 0) -> int:
        """The same with a register of its own."""
        return self.emit(name, self.temporary(), a, b, c)

    def own(self, symbol: Symbol, i: int = 0) -> int:
        """The register of a component; a number has one for all."""
        if symbol.register < 0:
            kind = {"global": symbol.name, "closure": "closures", "string": "strings that vary", "matrix": "matrices"}
            what = kind.get("global" if symbol.kind == "global" else symbol.type, symbol.type)
            raise ValueError(f"script uses {what}, which is not supported")
        return symbol.register + (i if symbol.width == 3 else 0)

    def as_float(self, symbol: Symbol, i: int = 0) -> int:
        register = self.own(symbol, i)
        if not symbol.is_int:
            return register
        return self.made("to_float", register) if symbol.known is None else self.constant(symbol.known[0])

    def as_int(self, symbol: Symbol, i: int = 0) -> int:
        register = self.own(symbol, i)
        return register if symbol.is_int else self.made("to_int", register)

    def truth(self, symbol: Symbol, i: int = 0) -> int:
        """A register that is 0 only where a number is."""
        if symbol.is_int:
            return self.own(symbol, i)
        is_zero = self.made("equal", self.as_float(symbol, i), self.constant(0.0))
        return self.made("int_equal", is_zero, self.constant(0.0, is_int=True))

    def together(self, registers: list[int]) -> int:
        """The first of registers side by side that hold what others do."""
        first = self.temporary(len(registers))
        for i, register in enumerate(registers):
            self.emit("copy", first + i, register)
        return first

    def core(self, arguments: int, results: list[int], variables: list[int]) -> CoreScript:
        """The script of the core. variables: registers that the script has names for."""
        words = [int(word) for word in self.registers]
        needed = Reuse(self.code, words, arguments, results, variables).code_that_is_needed()
        code = np.array(needed, np.uint32).tobytes()
        registers = np.array([*self.registers, *[0] * SPARE], np.uint32).tobytes()
        return CoreScript(code, registers, arguments, tuple(results))
