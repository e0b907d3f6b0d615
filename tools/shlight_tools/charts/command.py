# SPDX-License-Identifier: MIT
"""Measures the methods and draws the figures.

It checks the request, has the figures drawn, and puts each in place when it is complete.
"""

from __future__ import annotations

import importlib.util
import sys
import time
from pathlib import Path

from shlight.commands import CommandError, check_folder, run_command, work_folder
from shlight.progress import Progress

from .figure import Drawn, Figure, Run, Table
from .figures import FIGURES
from .options import Options, parse
from .page import PAGE, leave_part, page, part_of


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for what is missing to meet it."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command(
        "./dev charts", lambda: _work(arguments), when_interrupted="the figure that was being drawn left nothing"
    )


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    if options.list:
        width = max(len(figure.name) for figure in FIGURES)
        print("\n".join(f"{figure.name:{width}}  {figure.title}" for figure in FIGURES))
        return
    # Errors that can be found before anything is measured.
    check_folder(options.out)
    if importlib.util.find_spec("matplotlib") is None:
        raise CommandError("the Python module matplotlib is missing: pip install matplotlib", 1)
    with work_folder(options.out) as folder:
        _draw_all(options, folder)
    print(f"results: {options.out / PAGE}")


def _draw_all(options: Options, work: Path) -> None:
    from .style import look

    progress = Progress(len(options.figures))
    tables: list[Table] = []
    try:
        for figure in options.figures:
            progress.begin(figure.title)
            run = Run(figure.name, work, quick=options.quick, report=progress.step)
            start = time.monotonic()
            with look():
                drawn = figure.draw(run)
            _publish(figure, run, drawn, time.monotonic() - start, options.out)
            tables.extend(drawn.tables)
            progress.end()
    except BaseException:
        progress.interrupt()
        raise
    for table in tables:
        print(f"\n{table.markdown()}")
    print()


def _publish(figure: Figure, run: Run, drawn: Drawn, seconds: float, out: Path) -> None:
    """Puts a figure's files in place of those that it left before, and makes the page anew."""
    files = [*(picture.file for picture in run.pictures), *run.data]
    part = leave_part(figure, run, drawn, seconds)
    out.mkdir(parents=True, exist_ok=True)
    before = part_of(out, figure) or {"pictures": [], "data": []}
    for file in files:
        (run.out / file).replace(out / file)
    (run.out / part).replace(out / part)
    for file in {*(picture for picture, _ in before["pictures"]), *before["data"]} - set(files):
        (out / file).unlink(missing_ok=True)
    (run.out / PAGE).write_text(page(out, FIGURES), encoding="utf-8")
    (run.out / PAGE).replace(out / PAGE)
