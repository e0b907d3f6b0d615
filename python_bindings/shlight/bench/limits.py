# SPDX-License-Identifier: MIT
"""How near the kernels come to what the machine can do: to its multiply-adds, and to its writes where they write.

Both limits are measured in the same rounds: multiply-adds that wait for nothing, and the C library's memset over what
no cache holds. Where the results fit into one, more than 100 % of memset is possible.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from shlight import _core

from . import kinds
from .operations import OPERATIONS
from .rounds import Spread, Work
from .row import Row
from .run import Run, result_bytes

ORDERS = (8, 16, 32)
PEAK, FILL = "multiply-adds", "memset"
WRITING = ("basis", "clipped sphere", "whole sphere", "quad")
GIGA = 1e9
ROUNDS, FILL_BYTES = 200_000, 100_000_000


def measure(run: Run) -> list[Row]:
    rows: list[Row] = []
    limits = {PEAK: multiply_adds(), FILL: fill()}
    for i, order in enumerate(ORDERS):
        works = {**limits, **kinds.works(run.count(order), order)}
        seconds = run.alternate(works, (i, len(ORDERS)))
        peak, writing = 2 / seconds[PEAK], 1 / seconds[FILL]
        if not rows:
            rows.append(Row.of(run.section, PEAK, Spread.of(peak / GIGA), "Gflop/s", bound_is="least"))
            rows.append(Row.of(run.section, FILL, Spread.of(writing / GIGA), "GB/s", bound_is="least"))
        for name in works:
            if name in OPERATIONS:
                flop = OPERATIONS[name](order)
                done = flop / seconds[name]
                detail = f"{flop} flop a light, {Spread.of(done / GIGA).median:.1f} Gflop/s"
                row = f"{name}, n = {order}"
                rows.append(
                    Row.of(
                        run.section, row, Spread.of(100 * done / peak), f"% of {PEAK}", detail=detail, bound_is="least"
                    )
                )
            if name in WRITING:
                written = result_bytes(order) / seconds[name]
                detail = f"{result_bytes(order)} bytes a light, {Spread.of(written / GIGA).median:.1f} GB/s"
                row = f"{name}, n = {order}, writes"
                rows.append(
                    Row.of(
                        run.section,
                        row,
                        Spread.of(100 * written / writing),
                        f"% of {FILL}",
                        detail=detail,
                        bound_is="least",
                    )
                )
    return rows


def multiply_adds(threads: int = 1, rounds: int = ROUNDS) -> Work:
    """As many on each thread."""
    return Work(_in_threads(lambda part: _core.multiply_adds(rounds), threads), threads * _core.multiply_adds(rounds))


def fill(threads: int = 1) -> Work:
    """Of one block, a part of it on each thread."""
    # Not with zeros, which some machines write faster than anything else.
    block = np.empty(FILL_BYTES, np.uint8)
    size = FILL_BYTES // threads
    return Work(_in_threads(lambda part: ctypes.memset(block.ctypes.data + part * size, 1, size), threads), FILL_BYTES)


def _in_threads(call: Callable[[int], object], threads: int) -> Callable[[], None]:
    """`call` for each part at once, the first one on the caller's thread. It must let others run meanwhile."""
    pool = ThreadPoolExecutor(max(1, threads - 1))

    def run() -> None:
        others = [pool.submit(call, part) for part in range(1, threads)]
        call(0)
        for other in others:
            other.result()

    return run
