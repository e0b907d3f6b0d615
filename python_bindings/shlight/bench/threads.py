# SPDX-License-Identifier: MIT
"""What a second thread brings: the time of one ÷ that of two, on the wall.

Beside the library's kinds of work what the machine itself gains, at multiply-adds alone and at memset alone.
"""

from __future__ import annotations

from . import kinds, limits
from .rounds import WALL, Spread
from .row import Row
from .run import Run, duration

ORDERS = (8, 16)
BOUND = 1.8
ROUNDS = 20 * limits.ROUNDS  # long beside what it takes to wake a thread


def measure(run: Run) -> list[Row]:
    machine = {
        threads: {limits.PEAK: limits.multiply_adds(threads, ROUNDS), limits.FILL: limits.fill(threads)}
        for threads in (1, 2)
    }
    rows = []
    for i, order in enumerate(ORDERS):
        by_threads = {threads: {**machine[threads], **kinds.works(run.lights, order, threads)} for threads in (1, 2)}
        names = list(by_threads[1])
        # The two turns that are compared follow each other.
        works = {f"{name}, {threads}": by_threads[threads][name] for name in names for threads in (1, 2)}
        seconds = run.alternate(works, (i, len(ORDERS)), WALL)
        for name in names:
            one, two = seconds[f"{name}, 1"], seconds[f"{name}, 2"]
            gain = Spread.of(one / two)
            if name not in machine[1]:
                detail = f"{duration(one)} ÷ {duration(two)}"
                row = f"{name}, n = {order}"
                rows.append(Row.of(run.section, row, gain, "× as fast", bound=BOUND, bound_is="least", detail=detail))
            elif i == 0:
                rows.append(Row.of(run.section, name, gain, "× as fast", bound_is="least"))
    return rows
