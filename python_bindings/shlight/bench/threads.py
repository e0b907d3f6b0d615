# SPDX-License-Identifier: MIT
"""What a second thread brings: the time of one ÷ that of two, on the wall."""

from __future__ import annotations

from . import kinds
from .rounds import WALL, Spread
from .row import Row
from .run import Run, duration

ORDERS = (8, 16)
BOUND = 1.8


def measure(run: Run) -> list[Row]:
    rows = []
    for i, order in enumerate(ORDERS):
        by_threads = {threads: kinds.works(run.lights, order, threads) for threads in (1, 2)}
        names = list(by_threads[1])
        # The two turns that are compared follow each other.
        works = {f"{name}, {threads}": by_threads[threads][name] for name in names for threads in (1, 2)}
        seconds = run.alternate(works, (i, len(ORDERS)), WALL)
        for name in names:
            one, two = seconds[f"{name}, 1"], seconds[f"{name}, 2"]
            detail = f"{duration(one)} ÷ {duration(two)}"
            row = f"{name}, n = {order}"
            spread = Spread.of(one / two)
            rows.append(Row.of(run.section, row, spread, "× as fast", bound=BOUND, bound_is="least", detail=detail))
    return rows
