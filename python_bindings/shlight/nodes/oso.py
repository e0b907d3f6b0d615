# SPDX-License-Identifier: MIT
"""Compiled scripts of Open Shading Language (.oso) as text: their symbols and instructions."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|\S+')
WRITES = re.compile(r'%argrw\{"([rwW-]*)"\}')
TRIPLES = ("color", "point", "vector", "normal")
KINDS = ("param", "oparam", "global", "local", "temp", "const")


@dataclass
class Symbol:
    """A variable: `default` has the numbers of its line, `is_initialized` is true where instructions make its value,
    and `writes` counts those that write it. `known` is what it always holds, where that is known."""

    kind: str
    type: str
    name: str
    length: int | None = None  # of an array
    default: list[float] = field(default_factory=list)
    text: str = ""
    is_initialized: bool = False
    writes: int = 0
    register: int = -1
    known: tuple[float, ...] | None = None

    @property
    def width(self) -> int:
        """Numbers of one element."""
        return 3 if self.type in TRIPLES else 1

    @property
    def is_int(self) -> bool:
        """Whether its registers hold integers."""
        return self.type == "int"


@dataclass(frozen=True)
class Instruction:
    """An operation on symbols, and the instructions that it may go on with."""

    name: str
    arguments: tuple[Symbol, ...]
    jumps: tuple[int, ...]


@dataclass(frozen=True)
class Script:
    """Symbols by name, instructions, and where those of the script itself begin, and those of symbols by name end."""

    symbols: dict[str, Symbol]
    code: list[Instruction]
    begin: int
    first_values: dict[str, tuple[int, int]]


def parse(text: str) -> Script:
    """Reads a compiled script. Raises ValueError naming the argument `script`."""
    if not isinstance(text, str) or not text.startswith("OpenShadingLanguage"):
        raise ValueError("script must be the text of a compiled script of Open Shading Language (.oso)")
    symbols: dict[str, Symbol] = {}
    code: list[Instruction] = []
    begins: dict[str, int] = {}
    for line in text.splitlines()[1:]:
        tokens = TOKEN.findall(line)
        words = tokens[: next((i for i, token in enumerate(tokens) if token.startswith("%")), len(tokens))]
        if not words or words[0].startswith("#"):
            continue
        if words[0] in KINDS and not begins:
            symbol = _symbol(words, line)
            symbols[symbol.name] = symbol
        elif words[0] == "code" and len(words) == 2:
            begins[words[1]] = len(code)
        elif begins:
            code.append(_instruction(words, line, symbols))
    if "___main___" not in begins:
        raise ValueError("script has no instructions of its own")
    places = sorted([*begins.values(), len(code)])
    ranges = {name: (first, places[places.index(first) + 1]) for name, first in begins.items() if name != "___main___"}
    return Script(symbols, code, begins["___main___"], ranges)


def _symbol(words: list[str], line: str) -> Symbol:
    closure = words[1:2] == ["closure"]
    if len(words) < 3 + closure:
        raise ValueError(f"script has a symbol without a name: {line.strip()}")
    kind, (written_type, name, *rest) = words[0], words[1 + closure :]
    found = re.fullmatch(r"(\w+)(?:\[(\d*)\])?", written_type)
    if found is None or (len(found[2] or "1")) > 5:
        raise ValueError(f"script has a symbol of an unknown type: {written_type}")
    length = None if found[2] is None else int(found[2] or 0)
    is_initialized = "%initexpr" in line or '%meta{string,widget,"null"' in line
    symbol = Symbol(kind, "closure" if closure else found[1], name, length, is_initialized=is_initialized)
    if symbol.type in ("float", "int", *TRIPLES):
        try:
            symbol.default = [float(word) for word in rest]
        except ValueError:
            raise ValueError(f"script gives {name} a value that is no number") from None
    elif rest:
        symbol.text = rest[0].strip('"')
    return symbol


def _instruction(words: list[str], line: str, symbols: dict[str, Symbol]) -> Instruction:
    first = next((i for i, word in enumerate(words[1:], 1) if word.isdecimal()), len(words))
    unknown = [word for word in words[1:first] if word not in symbols] + [w for w in words[first:] if not w.isdecimal()]
    if unknown:
        raise ValueError(f"script uses {unknown[0]}, which it does not have")
    arguments = tuple(symbols[word] for word in words[1:first])
    marks = WRITES.search(line)
    for symbol, mark in zip(arguments, marks[1] if marks else "w", strict=False):
        symbol.writes += mark in "wW"
    return Instruction(words[0], arguments, tuple(int(word) for word in words[first:]))
