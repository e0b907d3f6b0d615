# SPDX-License-Identifier: MIT
"""Random calls of all public functions and random scenes, many of them hostile.

    python tests/python/fuzz.py --calls 1000000 --scenes 10000 --seed 1
    python tests/python/fuzz.py --case call:1:4711

Each is accepted or refused by an error that names an argument, within LIMIT seconds; no process ends, nothing warns,
and results are finite and within bounds. The second way shows one case, which its kind, seed and number determine, as
code that can be pasted, and runs it.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_calls import Step, random_call
from fuzz_scenes import random_scene
from fuzz_values import MATERIALS

import shlight
from shlight import Bsdf

KINDS = {"call": random_call, "scene": random_scene}
BATCH = {"call": 10_000, "scene": 250}
LIMIT = 10.0  # seconds of a core; what takes longer hangs
MEMORY = 8 << 30
THIS = (sys.executable, str(Path(__file__).resolve()))


@dataclass(frozen=True)
class Case:
    kind: str
    seed: int
    number: int

    def steps(self) -> list[Step]:
        with np.errstate(all="ignore"):
            return KINDS[self.kind](np.random.default_rng([self.seed, self.number]))

    def __str__(self) -> str:
        return f"{self.kind}:{self.seed}:{self.number}"


def complaint(case: Case) -> str | None:
    for step in case.steps():
        problem = step.complaint()
        if problem is not None:
            return f"{step.call}: {problem}"
    return None


def shown(value: Any) -> str:
    """A value as code, if it has a form as code."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufc" and value.dtype != np.longdouble:
        return f"np.array({value.tolist()!r}, {value.dtype.str!r}).reshape({value.shape})"
    if isinstance(value, type) and issubclass(value, np.generic):
        return f"np.{value.__name__}"
    if isinstance(value, list):
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, Bsdf | shlight.Scene):
        return next((code for code, bsdf in MATERIALS.items() if value is bsdf), type(value).__name__.lower())
    return f"{value.bit_length()} bits" if isinstance(value, int) and abs(value) > 10**500 else repr(value)


def code_of(steps: list[Step]) -> str:
    return "\n".join(
        f"{step.call.split('/')[0]}({', '.join(f'{name}={shown(value)}' for name, value in step.arguments.items())})"
        for step in steps
    )


def work(kind: str, seed: int, first: int, end: int, limit: float) -> None:
    """Prints the number of each case before it is tried, so that the last one is what ended the process, and what is
    wrong with it after that."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in range(first, end):
        os.write(1, b"%d\n" % number)
        signal.setitimer(signal.ITIMER_PROF, limit)
        signal.setitimer(signal.ITIMER_REAL, 6 * limit)  # others may use the cores
        problem = complaint(Case(kind, seed, number))
        if problem is not None:
            os.write(1, f"\t{' '.join(problem.split())}\n".encode())


def ending(code: int, errors: str) -> str:
    if -code in (signal.SIGPROF, signal.SIGALRM):
        return "the process hangs"
    return f"the process ended with {code}: {' '.join(errors[-300:].split())}"


def run_batch(kind: str, first: int, end: int, seed: int, limit: float, program: Sequence[str]) -> dict[Case, str]:
    """What is wrong; a process that ends early is followed by one for what is left."""
    found: dict[Case, str] = {}
    while first < end:
        arguments = ["--work", *map(str, (kind, seed, first, end, limit))]
        done = subprocess.run([*program, *arguments], capture_output=True, text=True, check=False)
        number = None
        for line in done.stdout.splitlines():
            if line.startswith("\t"):
                found[Case(kind, seed, int(number or 0))] = line.strip()
            else:
                number = int(line)
        if done.returncode == 0:
            break
        if number is None or done.returncode > 0:  # the fuzzer's own fault
            raise RuntimeError(done.stderr)
        found[Case(kind, seed, number)] = ending(done.returncode, done.stderr)
        first = number + 1
    return found


def run(
    counts: dict[str, int], seed: int, *, jobs: int = 2, limit: float = LIMIT, program: Sequence[str] = THIS
) -> dict[Case, str]:
    found: dict[Case, str] = {}
    with ThreadPoolExecutor(jobs) as pool:
        parts = [
            pool.submit(run_batch, kind, first, min(first + BATCH[kind], count), seed, limit, program)
            for kind, count in counts.items()
            for first in range(0, count, BATCH[kind])
        ]
        for part in parts:
            found.update(part.result())
    return found


def shown_case(case: Case) -> str:
    """In a process of its own, because the library makes some of the arguments."""
    done = subprocess.run([*THIS, "--show", str(case)], capture_output=True, text=True, check=False)
    return done.stdout or done.stderr


def report(found: dict[Case, str]) -> str:
    """The case with the shortest code among a few, for each group of problems that differ only in numbers."""
    alike: dict[str, list[Case]] = {}
    for case, problem in found.items():
        alike.setdefault(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", problem), []).append(case)
    parts = []
    for cases in sorted(alike.values(), key=len, reverse=True):
        code, case = min(((shown_case(case), case) for case in cases[:8]), key=lambda pair: len(pair[0]))
        parts.append(f"{len(cases)} like {case}: {found[case]}\n{code}")
    return "\n".join(parts)


def parsed_case(text: str) -> Case:
    kind, seed, number = text.split(":")
    return Case(kind, int(seed), int(number))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=100_000)
    parser.add_argument("--scenes", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--case", type=parsed_case, help="KIND:SEED:NUMBER")
    parser.add_argument("--show", type=parsed_case, help=argparse.SUPPRESS)
    parser.add_argument("--work", nargs=5, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.work:
        kind, seed, first, end, limit = given.work
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            work(kind, int(seed), int(first), int(end), float(limit))
        return 0
    if given.show or given.case:
        print(code_of((given.show or given.case).steps()))
        problem = complaint(given.case) if given.case else None
        if problem is not None:
            print(problem)
        return problem is not None
    found = run({"call": given.calls, "scene": given.scenes}, given.seed, jobs=given.jobs)
    print(report(found))
    print(f"{len(found)} of {given.calls} calls and {given.scenes} scenes are wrong")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
