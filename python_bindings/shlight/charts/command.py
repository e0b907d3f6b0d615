# SPDX-License-Identifier: MIT
"""`shlight charts`: checks the request, has the figures drawn, and puts each in place when it is complete."""

from __future__ import annotations

import importlib.util
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from .figure import Drawn, Figure, Run, Table
from .figures import FIGURES
from .options import Options, parse
from .page import PAGE, leave_part, page, part_of
from .progress import Progress

INTERRUPTED, TERMINATED = 130, 143


class ChartsError(Exception):
    """What the user is told, and the exit code."""

    def __init__(self, text: str, exit_code: int) -> None:
        super().__init__(text)
        self.exit_code = exit_code


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for what is missing to meet it."""
    try:
        options = parse(sys.argv[1:] if argv is None else argv)
        if options.list:
            width = max(len(figure.name) for figure in FIGURES)
            print("\n".join(f"{figure.name:{width}}  {figure.title}" for figure in FIGURES))
            return 0
        _check(options)
        with _terminable(), _work_folder(options.out) as work:
            _draw_all(options, work)
        print(f"results: {options.out / PAGE}")
    except SystemExit as stop:  # the options were not understood, and that was said; or terminated
        return stop.code if isinstance(stop.code, int) else 1
    except KeyboardInterrupt:
        return _complain("interrupted; the figure that was being drawn left nothing", INTERRUPTED)
    except ChartsError as error:
        return _complain(str(error), error.exit_code)
    except BrokenPipeError:
        raise  # standard output was closed; the command line that called this says so
    except OSError as error:
        return _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error), 2)
    return 0


def _complain(text: str, exit_code: int) -> int:
    print(f"shlight charts: {text}", file=sys.stderr)
    return exit_code


def _check(options: Options) -> None:
    """What can be known to fail before anything is started."""
    nearest = next(path for path in (options.out, *options.out.parents) if path.exists())
    if not nearest.is_dir():
        raise ChartsError(f"{nearest} is a file; --out wants a folder", 2)
    if importlib.util.find_spec("matplotlib") is None:
        raise ChartsError("the Python module matplotlib is missing: pip install 'shlight[charts]'", 1)


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


@contextmanager
def _work_folder(out: Path) -> Iterator[Path]:
    """A temporary folder on the file system of `out`; gone afterwards, whatever happens."""
    place = next(folder for folder in (out.absolute(), *out.absolute().parents) if folder.is_dir())
    try:
        folder = tempfile.TemporaryDirectory(prefix=".shlight-charts-", dir=place)
    except OSError as error:
        raise ChartsError(f"cannot write to {out}: {error.strerror}", 2) from None
    with folder as name:
        yield Path(name)


@contextmanager
def _terminable() -> Iterator[None]:
    """A polite request to end (SIGTERM) cleans up as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(*_: object) -> NoReturn:
        raise SystemExit(TERMINATED)

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
