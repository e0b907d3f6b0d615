# SPDX-License-Identifier: MIT
"""usage: python -m shlight.bench.memory_probe KIND ORDER COUNT

Prints by how many bytes one call on COUNT lights raised the peak of this process's memory, and the bytes of its result.
"""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path

import numpy as np

from . import kinds

PEAK_RESET = "5"  # of proc(5), clear_refs


def main(name: str, order: int, count: int) -> None:
    kinds.works(64, order)[name].call()  # fits, threads
    work = kinds.works(count, order)[name]
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text(PEAK_RESET, encoding="ascii")
    before = status("VmRSS")
    result = np.asarray(work.call())
    print(status("VmHWM") - before, result.nbytes)


def status(name: str) -> int:
    """Bytes, of /proc/self/status."""
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        key, _, value = line.partition(":")
        if key == name:
            return 1024 * int(value.split()[0])
    raise KeyError(name)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
