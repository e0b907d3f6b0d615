# SPDX-License-Identifier: MIT
"""Large results share memory with results that are gone, never with results that live."""

from __future__ import annotations

import gc
import resource
import threading
from pathlib import Path

import numpy as np

import shlight

ORDER = 16
COUNT = 8192  # 8 MiB of float32


def basis(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions, and the basis in them."""
    directions = np.random.default_rng(seed).normal(size=(COUNT, 3)).astype(np.float32)
    return directions, shlight.sh_basis(directions, ORDER)


def resident() -> int:
    """Bytes of this process in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def test_memory_of_results_that_are_gone_is_free_again():
    basis(1)
    before = resident()
    for seed in range(16):
        basis(seed)
    assert resident() - before <= 4 * 4 * ORDER**2 * COUNT  # of the sixteen, four


def test_living_results_stay_as_they_are():
    results = [basis(seed) for seed in range(4)]
    copies = [values.copy() for _, values in results]
    for seed in range(4, 8):
        basis(seed)
    for (_, values), copy in zip(results, copies, strict=True):
        np.testing.assert_array_equal(values, copy)


def test_results_are_ordinary_writable_arrays_whose_views_keep_them_alive():
    directions, values = basis(1)
    assert values.flags.writeable
    assert values.flags.c_contiguous
    assert not values.flags.owndata
    values[:5] += 1
    view = values[5:7]
    del values
    gc.collect()
    basis(2)
    np.testing.assert_array_equal(view, shlight.sh_basis(directions[5:7], ORDER))


def test_threads_do_not_share_living_results():
    wrong = []

    def work(seed: int) -> None:
        for i in range(6):
            directions, values = basis(100 * seed + i)
            if not np.array_equal(values[:64], shlight.sh_basis(directions[:64], ORDER)):
                wrong.append(seed)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
