# SPDX-License-Identifier: MIT
"""This build and another one in turns: each makes the calls of this bench in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import numpy as np

import shlight
from shlight.commands import CommandError

from .row import Row
from .run import Run, duration

SERVER = Path(__file__).with_name("serve.py")
OWN = Path(shlight.__file__).parents[1]
MOST = 1.15  # of the other build's time
SECONDS = 0.5  # that the turns of a work take at least: short ones have more of them
MOST_TURNS = 500


def check_package(folder: Path) -> None:
    """Raises CommandError where no package is that could be timed."""
    if not any((folder / "shlight").glob("_core*.so")):
        raise CommandError(f"there is no built package shlight in {folder}", 2)


def measure(other: Path, run: Run) -> list[Row]:
    """Time of this build ÷ that of the other, of the fastest turn of each. other: the folder its package is in."""
    rows = []
    with ExitStack() as stack:
        builds = [stack.enter_context(_started(folder, run)) for folder in (OWN, other)]
        names, _ = (json.loads(_line(build)) for build in builds)
        for i, name in enumerate(names):
            run.step(i / len(names), name)
            slowest = max(_call(build, name) for build in builds)  # which is not measured: fits are made
            turns = max(run.rounds, min(MOST_TURNS, int(SECONDS / slowest)))
            seconds = np.array([[_call(build, name) for build in builds] for _ in range(turns)])
            now, before = seconds.min(axis=0)
            value, detail = float(now / before), f"{duration(now)} ÷ {duration(before)} a call"
            rows.append(Row(run.section, name, value, value, value, "× the other build", MOST, detail=detail))
    return rows


def _started(folder: Path, run: Run) -> subprocess.Popen[str]:
    command = [sys.executable, "-P", str(SERVER), str(folder), run.section, str(run.lights)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def _call(build: subprocess.Popen[str], name: str) -> float:
    assert build.stdin is not None
    print(name, file=build.stdin, flush=True)
    return float(_line(build))


def _line(build: subprocess.Popen[str]) -> str:
    assert build.stdout is not None
    line = build.stdout.readline()
    if not line:
        raise CommandError("a process that makes the calls has ended; the messages above say why", 1)
    return line
