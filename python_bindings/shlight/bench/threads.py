# SPDX-License-Identifier: MIT
"""What a second thread brings: the time of one ÷ that of two, on the wall.

The host of a virtual machine may take its processors away, or hand out two threads of one core: multiply-adds alone
then gain nothing. They are measured before and after each turn, and of a kind of work those turns count in which the
machine had two cores to give; the gain over all turns stands beside it. Without enough such turns all of them count.

Calls follow each other in a turn as in a loop, where the second thread still looks for work when the next one comes.
After a pause it has to be woken: what one such call gains is measured besides.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import kinds, limits
from .rounds import WALL, Seconds, Spread, Work
from .row import Row
from .run import Run, duration, result_bytes

ORDERS = (8, 16)
BOUND = 1.8
TURNS = 3  # so many times as many as of other sections, because some do not count
MOST_REPEATS = 3  # of them, until enough do
CALLS = 3  # in a turn
PROBE_ROUNDS = 10 * limits.ROUNDS  # long beside what it takes to wake a thread
TWO_CORES = 1.6  # what multiply-adds gain from them at least
FEWEST = 9  # turns that make a median


def measure(run: Run) -> list[Row]:
    run = replace(run, rounds=TURNS * run.rounds)
    rows = []
    for i, order in enumerate(ORDERS):
        by_threads = {
            threads: {limits.FILL: limits.fill(threads), **kinds.works(run.lights, order, threads)}
            for threads in (1, 2)
        }
        names = list(by_threads[1])
        seconds = _with_two_cores(run, names, by_threads, i)
        if i == 0:  # of the machine, not of an order
            probes = np.concatenate([_gain(seconds, name) for name in _probes(names)])
            rows.append(Row.of(run.section, limits.PEAK, Spread.of(probes), "× as fast", bound_is="least"))
        rows += [_row(run, names, k, order, seconds) for k, name in enumerate(names) if i == 0 or name != limits.FILL]
    return rows


def _with_two_cores(run: Run, names: list[str], by_threads: dict[int, dict[str, Work]], i: int) -> Seconds:
    """Repeats the i-th order's turns until enough of each work count."""
    probe = {threads: limits.multiply_adds(threads, PROBE_ROUNDS) for threads in (1, 2)}
    works: dict[str, Work] = {}
    for before, name in zip(_probes(names), [*names, None], strict=True):
        works |= {_turn(before, threads): probe[threads] for threads in (1, 2)}
        if name is not None:
            works |= {_turn(_paused(name), threads): by_threads[threads][name] for threads in (1, 2)}
            works |= {_turn(name, threads): _in_a_row(by_threads[threads][name]) for threads in (1, 2)}
    seconds: Seconds = {name: np.empty(0) for name in works}
    for repeat in range(MOST_REPEATS):
        more = run.alternate(works, (MOST_REPEATS * i + repeat, MOST_REPEATS * len(ORDERS)), WALL)
        seconds = {name: np.concatenate([seconds[name], more[name]]) for name in works}
        if all(_has_enough(_counts(seconds, names, k)) for k in range(len(names))):
            break
    return seconds


def _row(run: Run, names: list[str], k: int, order: int, seconds: Seconds) -> Row:
    name = names[k]
    every, paused = _gain(seconds, name), _gain(seconds, _paused(name))
    counts = _counts(seconds, names, k)
    turns = f"{np.count_nonzero(counts)} of {len(every)} turns"
    if not _has_enough(counts):
        counts = np.ones_like(counts)
        turns += " had two cores: all count"
    one, two, filled = (
        seconds[_turn(work, threads)][counts] for work, threads in ((name, 1), (name, 2), (limits.FILL, 2))
    )
    detail = f"{duration(one)} ÷ {duration(two)}; {turns}, {Spread.of(every).median:.2f} in all"
    detail += f"; {Spread.of(paused[counts]).median:.2f} after a pause"
    if name in limits.WRITING:
        written = Spread.of(100 * result_bytes(order) * filled / two).median
        detail += f"; writes at {written:.0f} % of {limits.FILL}"
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


def _in_a_row(work: Work) -> Work:
    def calls() -> None:
        for _ in range(CALLS):
            work.call()

    return Work(calls, CALLS * work.count)


def _paused(name: str) -> str:
    return f"one call of {name}"


def _probes(names: list[str]) -> list[str]:
    """The multiply-adds before each work, and those after the last."""
    return [*(f"before {name}" for name in names), "at last"]


def _counts(seconds: Seconds, names: list[str], k: int) -> NDArray[np.bool_]:
    """In which turns the machine had two cores for the k-th work."""
    before, after = (_gain(seconds, name) for name in _probes(names)[k : k + 2])
    return np.minimum(before, after) >= TWO_CORES


def _has_enough(counts: NDArray[np.bool_]) -> bool:
    return int(np.count_nonzero(counts)) >= min(FEWEST, len(counts))


def _turn(name: str, threads: int) -> str:
    return f"{name}, {threads}"


def _gain(seconds: Seconds, name: str) -> NDArray[np.float64]:
    return seconds[_turn(name, 1)] / seconds[_turn(name, 2)]
