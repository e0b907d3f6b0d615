# SPDX-License-Identifier: MIT
"""Measures the times of calls, as ratios within one run.

It checks the request, has the sections measured, and tells and keeps the results.
"""

from __future__ import annotations

import sys
from pathlib import Path

from shlight.commands import CommandError, check_folder, run_command, work_folder
from shlight.progress import Progress

from . import builds, machine, peer, picture, table
from .compare import comparison
from .options import Options, parse
from .row import Bench, Row, read
from .run import Run
from .sections import PEERED, SECTIONS


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for what is missing to meet it."""
    arguments = sys.argv[1:] if argv is None else argv
    if arguments[:1] == ["picture"]:
        return picture.main(arguments[1:])
    return run_command("./dev bench", lambda: _work(arguments), when_interrupted="nothing was written")


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    if options.list:
        width = max(len(section.name) for section in SECTIONS)
        print("\n".join(f"{section.name:{width}}  {section.title}" for section in SECTIONS))
        return
    # Errors that can be found before anything is measured.
    before = None if options.compare is None else read(options.compare)
    if options.read is None:
        if options.out.is_dir():
            raise CommandError(f"{options.out} is a folder; --out wants a file", 2)
        check_folder(options.out.parent)
        if options.against is not None:
            builds.check_package(options.against)
        elif any(section.name in PEERED for section in options.sections):
            peer.check_installed()
    bench = _measured(options) if options.read is None else read(options.read)
    _tell(bench)
    if before is not None:
        print(f"Change against {options.compare}\n\n{comparison(bench, before)}\n")
    if options.read is None:
        _keep(bench, options.out)
        print(f"results: {options.out}")


def _measured(options: Options) -> Bench:
    progress = Progress(len(options.sections))
    where, rows = machine.described(), list[Row]()
    try:
        for section in options.sections:
            progress.begin(section.title)
            run = Run(section.name, options.lights, options.rounds, progress.step)
            rows += section.measure(run) if options.against is None else builds.measure(options.against, run)
            progress.end()
    except BaseException:
        progress.interrupt()
        raise
    print()
    return Bench(where, {"lights": options.lights, "rounds": options.rounds}, rows)


def _tell(bench: Bench) -> None:
    print(f"{table.machine(bench)}\n")
    for section in SECTIONS:
        rows = [row for row in bench.rows if row.section == section.name]
        if rows:
            print(f"{table.section(section.title, rows)}\n")
    bounded = [row for row in bench.rows if row.met is not None]
    if bounded:
        print(f"{sum(bool(row.met) for row in bounded)} of {len(bounded)} bounds are met\n")


def _keep(bench: Bench, out: Path) -> None:
    """Puts the file in place when it is complete."""
    with work_folder(out.parent) as folder:
        written = folder / out.name
        written.write_text(bench.to_json(), encoding="utf-8")
        out.parent.mkdir(parents=True, exist_ok=True)
        written.replace(out)
