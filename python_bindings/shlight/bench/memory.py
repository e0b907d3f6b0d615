# SPDX-License-Identifier: MIT
"""Memory per million lights: what a call's peak adds to what the process holds, inputs aside.

Each is measured in a process of its own, where nothing that was freed before can serve again.
"""

from __future__ import annotations

import os
import subprocess
import sys

from shlight.commands import CommandError

from . import kinds
from .rounds import Spread
from .row import Row
from .run import Run

ORDERS = (8, 16)
# glibc gives back to the system what is freed, so that only what is held counts.
RETURN_AT_ONCE = {"MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "0"}


def measure(run: Run) -> list[Row]:
    names = list(kinds.works(1, 1))
    rows = []
    for i, order in enumerate(ORDERS):
        for k, name in enumerate(names):
            run.step((i + k / len(names)) / len(ORDERS), f"{name}, n = {order}")
            count = run.count(order, 10 * run.lights)
            growth, result = (number / count for number in _probed(name, order, count))
            detail = f"result {result:.0f} MB, beside it {growth - result:.0f} MB"
            spread = Spread(growth, growth, growth)
            rows.append(Row.of(run.section, f"{name}, n = {order}", spread, "MB per million", detail=detail))
    return rows


def _probed(name: str, order: int, count: int) -> tuple[float, float]:
    """Bytes by which the peak grew, and of the result."""
    path = os.pathsep.join(part for part in sys.path if part)
    environment = {**os.environ, "PYTHONPATH": path, **RETURN_AT_ONCE}
    command = [sys.executable, "-m", "shlight.bench.memory_probe", name, str(order), str(count)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CommandError(f"the memory of {name} could not be measured: {done.stderr.strip()}", 1)
    growth, result = done.stdout.split()
    return float(growth), float(result)
