# SPDX-License-Identifier: MIT
"""Leaves out a script's instructions that compute what a register holds already, and those whose result nothing reads.

Scripts repeat whole terms, since the compiler of Open Shading Language leaves it to the renderer to find them. Values
are numbered along stretches that no jump enters, and registers that are still read are found from the end on (A. V. Aho
et al., "Compilers", 2nd edition, 2007, 8.5 and 9.2). Results stay the same to the last bit.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from functools import lru_cache
from itertools import accumulate, count

from shlight import _core

Code = list[list[int]]  # for each instruction its number, the register that it writes or where it jumps, and operands

# Instructions, and elements of the arrays that these reach, of a script that is looked through: the time for it grows
# with the square of the first.
MOST_INSTRUCTIONS, MOST_ELEMENTS = 2_000, 100_000
TWO = frozenset((
    "add", "sub", "mul", "div", "plain_div", "fmod", "plain_fmod", "min", "max", "step", "pow", "atan2", "less",
    "less_equal", "equal", "int_less", "int_less_equal", "int_equal", "int_add", "int_sub", "int_mul", "int_div",
    "int_mod", "int_min", "int_max", "bitand", "bitor", "xor", "shl", "shr", "and", "or", "load", "store",
))  # fmt: skip
THREE = frozenset(("smoothstep", "select"))
# Registers side by side that are read from each operand on.
WIDE = {
    **{f"perlin{n}": (n,) for n in range(1, 5)},
    "dot": (3, 3),
    "cross_term": (2, 2),
    "hsv_to_rgb": (3,),
    "jump": (),
}
ZERO = ("constant", 0)
SYMMETRIC = frozenset(("add", "mul", "equal", "int_add", "int_mul", "int_equal", "bitand", "bitor", "xor", "and", "or"))


@lru_cache(maxsize=1)
def _kinds() -> list[tuple[str, tuple[int, ...]]]:
    """The name of each instruction, and how many registers it reads from each operand on."""
    names = _core.script_instructions()
    return [(n, WIDE.get(n, (1, 1) if n in TWO else (1, 1, 1) if n in THREE else (1,))) for n in names]


class _Values:
    """Numbers the values that registers hold along a stretch of instructions."""

    def __init__(self, fixed: dict[int, Hashable], variables: frozenset[int]) -> None:
        self.variables = variables
        self.number_of = dict(fixed)
        self.holders: dict[Hashable, list[int]] = {}
        for register, value in fixed.items():
            self.holders.setdefault(value, []).append(register)
        self.found: dict[tuple[Hashable, ...], Hashable] = {}  # by instruction and operands
        self.negated: dict[Hashable, Hashable] = {}  # what is true where a value is 0, and that value
        self.fresh = count().__next__

    def of(self, register: int) -> Hashable:
        if register not in self.number_of:
            self.write(register, self.fresh())
        return self.number_of[register]

    def write(self, register: int, value: Hashable) -> None:
        self.number_of[register] = value
        self.holders.setdefault(value, []).append(register)

    def holder(self, value: Hashable) -> int | None:
        """A register that holds a value: of a variable rather than of a term, which then nothing reads."""
        held = [r for r in self.holders.get(value, ()) if self.number_of[r] == value]
        return next((r for r in held if r in self.variables), held[0] if held else None)


class Reuse:
    """The instructions of a script; `fixed` are registers that nothing writes, and what they hold.

    words: what registers hold at first. arguments: the first registers, which hits have values of their own for.
    variables: registers that the script has names for.
    """

    def __init__(
        self, code: Code, words: list[int], arguments: int, results: Iterable[int], variables: Iterable[int]
    ) -> None:
        self.variables = frozenset(variables)
        self.code = [list(op) for op in code]
        self.copy = _core.script_instructions().index("copy")
        self.is_long = len(code) > MOST_INSTRUCTIONS or sum(len(self.array(op)) for op in code) > MOST_ELEMENTS
        self.arrays: set[int] = set() if self.is_long else {r for op in code for r in self.array(op)}
        self.results = frozenset(results)
        self.kept = self.results | self.arrays  # what the end of the script reads, or may
        self.targets = {op[1] for op in code if self.is_jump(op)}
        written = self.arrays.union(*(self.written(op) for op in code))
        self.fixed: dict[int, Hashable] = {
            r: ("argument", r) if r < arguments else ("constant", word)
            for r, word in enumerate(words)
            if r not in written
        }

    @staticmethod
    def name(op: list[int]) -> str:
        return _kinds()[op[0]][0]

    def is_jump(self, op: list[int]) -> bool:
        return self.name(op) in ("jump", "jump_unless")

    def array(self, op: list[int]) -> range:
        """The registers of the array of an instruction."""
        first = {"load": op[2], "store": op[1]}.get(self.name(op))
        return range(0) if first is None else range(first, first + op[4])

    def written(self, op: list[int]) -> range:
        if self.is_jump(op) or self.name(op) == "store":
            return range(0)
        return range(op[1], op[1] + (3 if self.name(op) == "hsv_to_rgb" else 1))

    def read(self, op: list[int]) -> list[int]:
        """The registers that an instruction reads, without those of arrays."""
        if self.name(op) == "load":
            return [op[3]]
        return [r + i for r, width in zip(op[2:], _kinds()[op[0]][1], strict=False) for i in range(width)]

    def code_that_is_needed(self) -> Code:
        if not self.is_long:
            values = _Values(self.fixed, self.variables)
            for place, op in enumerate(self.code):
                if place in self.targets:
                    values = _Values(self.fixed, self.variables)
                self.look_up(values, op)
            self.leave_out(self.unread())
            self.leave_out(self.joined())
        return self.code

    def look_up(self, values: _Values, op: list[int]) -> None:
        """Lets an instruction read registers that hold its operands already, and makes it a copy if one holds its
        result."""
        name, widths = _kinds()[op[0]]
        if name == "jump_unless":
            op[2] = self.condition(values, op[2])
            return
        for i, width in enumerate(widths):
            held = values.holder(values.of(op[2 + i])) if width == 1 and (name, i) != ("load", 0) else None
            op[2 + i] = op[2 + i] if held is None else held
        if name == "copy":
            values.write(op[1], values.of(op[2]))
        elif len(self.written(op)) == 1 and name != "load":
            operands = [values.of(r) for r in self.read(op)]
            key = (op[0], *(sorted(operands, key=repr) if name in SYMMETRIC else operands))
            value = values.found.setdefault(key, values.fresh())
            if name == "int_equal" and operands[1] == ZERO:
                values.negated[value] = operands[0]
            held = values.holder(value)
            if held is not None:
                op[:] = [self.copy, op[1], held, 0, 0]
            values.write(op[1], value)
        else:
            for r in [*self.written(op), *(self.array(op) if name == "store" else ())]:
                values.write(r, values.fresh())

    def condition(self, values: _Values, register: int) -> int:
        """A register that is 0 where this one is: what is negated twice is as it was."""
        value = values.of(register)
        while (once := values.negated.get(value)) is not None and (twice := values.negated.get(once)) is not None:
            held = values.holder(twice)
            if held is None:
                break
            value, register = twice, held
        return register

    def backwards(self, live_at: dict[int, frozenset[int]]) -> Iterator[tuple[int, list[int], set[int]]]:
        """Yields each instruction, from the last one on, with its place and the registers that are read after it.

        live_at: the registers that are read from the target of a jump on; it is brought up to date.
        """
        live = set(self.results)
        for place in range(len(self.code) - 1, -1, -1):
            op = self.code[place]
            if self.is_jump(op):
                beyond = live_at.get(op[1], frozenset()) if op[1] < len(self.code) else self.results
                live = live | beyond if self.name(op) == "jump_unless" else set(beyond)
            yield place, op, live
            if not self.is_idle(op, live):
                live.difference_update(self.written(op))
                live.update(self.read(op))
            if place in self.targets:
                live_at[place] = frozenset(live)

    def settled(self) -> dict[int, frozenset[int]]:
        """The registers that are read from the target of each jump on."""
        live_at: dict[int, frozenset[int]] = {}
        before = None
        while before != live_at:
            before = dict(live_at)
            for _ in self.backwards(live_at):
                pass
        return live_at

    def is_idle(self, op: list[int], live: set[int]) -> bool:
        """Whether an instruction only writes what is not in `live`. What arrays hold and results are always read."""
        written = self.written(op)
        return bool(written) and live.isdisjoint(written) and self.kept.isdisjoint(written)

    def unread(self) -> set[int]:
        """The places of instructions whose result nothing reads, and of copies to the same register."""
        walk = self.backwards(self.settled())
        return {
            place for place, op, live in walk if self.is_idle(op, live) or (self.name(op) == "copy" and op[1] == op[2])
        }

    def joined(self) -> set[int]:
        """The places of copies of a result that nothing else reads, which the instruction before them then writes."""
        found = set()
        for place, op, live in self.backwards(self.settled()):
            before = self.code[place - 1] if place > 0 else op
            if (
                self.name(op) == "copy"
                and list(self.written(before)) == [op[2]]
                and place not in self.targets
                and op[2] not in live
                and op[2] not in self.kept
            ):
                before[1] = op[1]
                found.add(place)
        return found

    def leave_out(self, places: set[int]) -> None:
        """Leaves out the instructions at some places; jumps lead to the next one that is left."""
        numbers = list(accumulate((place not in places for place in range(len(self.code))), initial=0))
        self.code = [
            [op[0], numbers[op[1]], *op[2:]] if self.is_jump(op) else op
            for place, op in enumerate(self.code)
            if place not in places
        ]
        self.targets = {op[1] for op in self.code if self.is_jump(op)}
