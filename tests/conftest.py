# SPDX-License-Identifier: MIT
from __future__ import annotations

import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

# Tests count the files of folders in which they put modules.
sys.dont_write_bytecode = True
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"


@pytest.fixture(scope="session", autouse=True)
def _interruptible() -> Iterator[None]:
    """A shell starts background jobs with SIGINT ignored; tests of Ctrl-C need it, as do the processes they start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def resident() -> Callable[[], int]:
    """How many bytes of this process are in memory."""
    return lambda: int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
