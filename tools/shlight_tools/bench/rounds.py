# SPDX-License-Identifier: MIT
"""The clock: works that take turns, and the ratios of their times.

A slow clock of the processor, or a neighbour who fills its caches, then slows all of them, and leaves the ratios.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight._arrays import Floats

Clock = Callable[[], float]

# CPU time of this process, in which waiting for a core does not count, and wall-clock time.
ONE_THREAD: Clock = time.process_time
WALL: Clock = time.perf_counter


@dataclass(frozen=True)
class Work:
    """A call of the library as a user makes it: its result is let go before the clock stops, as in a loop."""

    call: Callable[[], Any]
    count: int  # lights, or directions, that it takes


@dataclass(frozen=True)
class Spread:
    """The median of some numbers, and the quartiles around it."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, numbers: Floats) -> Spread:
        low, median, high = np.quantile(numbers, [0.25, 0.5, 0.75])
        return cls(float(median), float(low), float(high))


Seconds = Mapping[str, NDArray[np.float64]]  # by the name of a work: of one light, in each round


def alternate(
    works: Mapping[str, Work],
    rounds: int,
    clock: Clock = ONE_THREAD,
    step: Callable[[float, str], None] = lambda share, text: None,
) -> Seconds:
    """Seconds per light in each round. In a round each work has one turn; before the first, each has one unmeasured:
    fits are made, memory is had from the system, and the dispatched kernels are chosen."""
    seconds = {name: np.empty(rounds) for name in works}
    for turn in range(-1, rounds):
        for i, (name, work) in enumerate(works.items()):
            step((turn + 1 + i / len(works)) / (rounds + 1), name)
            start = clock()
            work.call()
            spent = clock() - start
            if turn >= 0:
                seconds[name][turn] = spent / work.count
    return seconds
