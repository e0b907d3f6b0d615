# SPDX-License-Identifier: MIT
"""What a section is, and what it is given to measure with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from shlight._arrays import Floats

from .rounds import ONE_THREAD, Clock, Seconds, Spread, Work, alternate
from .row import Row

LIGHTS, ROUNDS = 100_000, 11
QUICK_LIGHTS, QUICK_ROUNDS = 10_000, 9
UNITS = (("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0))
RESULT_BYTES = 4e8  # of one call: more lights than this holds are not asked for


@dataclass(frozen=True)
class Run:
    """One measurement of one section. step: told often how much is done, 0 … 1, and what comes now."""

    section: str
    lights: int
    rounds: int
    step: Callable[[float, str], None] = field(default=lambda share, text: None)

    def count(self, order: int) -> int:
        """The usual number of lights, or fewer if their coefficients of this order exceed the memory limit."""
        return min(self.lights, int(RESULT_BYTES / (4 * order**2)))

    def size(self, usual: tuple[int, int]) -> tuple[int, int]:
        """The size of a picture: half as wide and high in a quick run."""
        width, height = usual
        return (width // 2, height // 2) if self.lights < LIGHTS else usual

    def shorter(self) -> Run:
        """Half as many rounds, for pictures: they take long, and vary little."""
        return replace(self, rounds=(self.rounds + 1) // 2)

    def alternate(
        self, works: Mapping[str, Work], part: tuple[int, int] = (0, 1), clock: Clock = ONE_THREAD
    ) -> Seconds:
        """rounds.alternate(). part: (i, k): the i-th of k such measurements of the section."""
        i, k = part
        return alternate(works, self.rounds, clock, lambda share, name: self.step((i + share) / k, name))

    def ratio(
        self, seconds: Seconds, name: str, other: str, *, unit: str, bound: float | None = None, row: str = ""
    ) -> Row:
        """Time of one work ÷ that of another, of each round. row: its name, if not that of the work."""
        own, others = seconds[name], seconds[other]
        detail = f"{duration(own)} ÷ {duration(others)}"
        return Row.of(self.section, row or name, Spread.of(own / others), unit, bound=bound, detail=detail)


@dataclass(frozen=True)
class Section:
    """Rows that are measured together."""

    name: str  # on the command line
    title: str
    measure: Callable[[Run], list[Row]]


def duration(seconds: Floats) -> str:
    """The median of some times, as text."""
    value = Spread.of(seconds).median
    unit, size = next(((unit, size) for unit, size in UNITS if value < 1000 * size), UNITS[-1])
    return f"{value / size:.3g} {unit}"
