# SPDX-License-Identifier: MIT
"""What a second thread brings: the time of one ÷ that of two, on the wall.

The two processors of a virtual machine may be two cores at one moment and the two threads of one core at the next,
where multiply-adds alone gain nothing. They are measured before and after each turn, and of a kind of work those turns
count in which the machine had two cores to give; the gain over all turns stands beside it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import kinds, limits
from .rounds import WALL, Seconds, Spread, Work
from .row import Row
from .run import Run, duration

ORDERS = (8, 16)
BOUND = 1.8
TURNS = 3  # so many times as many as of other sections, because some do not count
PROBE_ROUNDS = 10 * limits.ROUNDS  # long beside what it takes to wake a thread
TWO_CORES = 1.6  # what multiply-adds gain from them at least
FEWEST = 9  # turns that make a median


def measure(run: Run) -> list[Row]:
    run = replace(run, rounds=TURNS * run.rounds)
    probe = {threads: limits.multiply_adds(threads, PROBE_ROUNDS) for threads in (1, 2)}
    rows = []
    for i, order in enumerate(ORDERS):
        by_threads = {threads: kinds.works(run.lights, order, threads) for threads in (1, 2)}
        if i == 0:  # of the machine, not of an order
            by_threads = {threads: {limits.FILL: limits.fill(threads), **by_threads[threads]} for threads in (1, 2)}
        names = list(by_threads[1])
        works: dict[str, Work] = {}
        for name in names:
            works |= {_turn(f"before {name}", threads): probe[threads] for threads in (1, 2)}
            works |= {_turn(name, threads): by_threads[threads][name] for threads in (1, 2)}
        works |= {_turn("at last", threads): probe[threads] for threads in (1, 2)}
        seconds = run.alternate(works, (i, len(ORDERS)), WALL)
        probes = [_gain(seconds, name) for name in [*(f"before {name}" for name in names), "at last"]]
        if i == 0:
            rows.append(
                Row.of(run.section, limits.PEAK, Spread.of(np.concatenate(probes)), "× as fast", bound_is="least")
            )
        for k, name in enumerate(names):
            counts = np.minimum(probes[k], probes[k + 1]) >= TWO_CORES
            rows.append(_row(run, name, order, seconds, counts))
    return rows


def _row(run: Run, name: str, order: int, seconds: Seconds, counts: NDArray[np.bool_]) -> Row:
    every = _gain(seconds, name)
    if np.count_nonzero(counts) < min(FEWEST, len(every)):
        counts = np.ones_like(counts)
    one, two = (seconds[_turn(name, threads)][counts] for threads in (1, 2))
    detail = (
        f"{duration(one)} ÷ {duration(two)}; {len(one)} of {len(every)} turns, {Spread.of(every).median:.2f} in all"
    )
    is_limit = name == limits.FILL
    return Row.of(
        run.section,
        name if is_limit else f"{name}, n = {order}",
        Spread.of(one / two),
        "× as fast",
        bound=None if is_limit else BOUND,
        bound_is="least",
        detail=detail,
    )


def _turn(name: str, threads: int) -> str:
    return f"{name}, {threads}"


def _gain(seconds: Seconds, name: str) -> NDArray[np.float64]:
    return seconds[_turn(name, 1)] / seconds[_turn(name, 2)]
