# SPDX-License-Identifier: MIT
"""Where the kernels' time goes, by function: the profile of docs/performance.md.

PYTHONPATH=python_bindings python docs/figures/profile_kernels.py [KIND...] [--order N]

Wants Linux's perf, and a module that kept its symbols: configured with -DCMAKE_STRIP=/bin/true. KIND: as `./dev bench`
names them, such as "clipped sphere"; all of them by default. Samples by the clock, so that virtual machines will do.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from shlight.bench import kinds

LIGHTS = 20_000
SECONDS = 3
LEAST = 2.0  # % of the samples: smaller shares are summed up
SHARE = re.compile(r"^\s*([\d.]+)%\s+\[.\]\s+(.*?)\s*$")


def repeat(kind: str, order: int) -> None:
    """The work that is watched; says when it begins."""
    work = kinds.works(LIGHTS, order)[kind]
    work.call()
    print("ready", flush=True)
    end = time.monotonic() + SECONDS + 2
    while time.monotonic() < end:
        work.call()


def shares(kind: str, order: int) -> list[tuple[float, str]]:
    """Percentages of samples and the functions they fell into."""
    with tempfile.TemporaryDirectory() as folder:
        data = str(Path(folder) / "perf.data")
        command = [sys.executable, __file__, kind, "--order", str(order), "--repeat"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as work:
            assert work.stdout is not None
            work.stdout.readline()
            record = ["perf", "record", "-q", "-e", "cpu-clock", "-F", "1999", "-o", data, "-p", str(work.pid)]
            subprocess.run([*record, "--", "sleep", str(SECONDS)], check=True, stderr=subprocess.DEVNULL)
        report = ["perf", "report", "-i", data, "--stdio", "--no-children", "-s", "symbol"]
        text = subprocess.run(report, check=True, capture_output=True, text=True).stdout
    found = [SHARE.match(line.split("  -  ")[0]) for line in text.splitlines()]
    return [(float(match[1]), match[2]) for match in found if match]


def main() -> None:
    names = list(kinds.works(1, 1))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(names))
    parser.add_argument("--order", type=int, default=16)
    parser.add_argument("--repeat", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.repeat:
        repeat(given.kinds[0], given.order)
        return
    print(f"| n = {given.order} | share | function |\n|---|---|---|")
    for kind in given.kinds or names:
        found = shares(kind, given.order)
        for share, function in found:
            if share >= LEAST:
                print(f"| {kind} | {share:.0f} % | `{plain(function)}` |")
        print(f"| {kind} | {sum(share for share, _ in found if share < LEAST):.0f} % | all others |", flush=True)


def plain(function: str) -> str:
    """Without namespaces and arguments."""
    short = function.replace("(anonymous namespace)::", "").replace("shlight::", "")
    return re.sub(r"\(.*", "", re.sub(r"\bN_\w+::|std::\w+::", "", short))


if __name__ == "__main__":
    main()
