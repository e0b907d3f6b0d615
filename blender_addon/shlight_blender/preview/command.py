# SPDX-License-Identifier: GPL-3.0-or-later
"""`shlight preview`: checks the request, has the worker render, measures, and puts the results in place."""

from __future__ import annotations

import importlib.util
import json
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from shlight import images

from .figures import add_circumstances, add_measurements, table
from .options import Options, parse
from .progress import Progress
from .supervision import PreviewError, run_worker

INTERRUPTED, TERMINATED = 130, 143
RESULTS = ("shlight.exr", "cycles_same_time.exr", "reference.exr", "preview.png", "figures.json")


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for a failure on the way."""
    try:
        options = parse(sys.argv[1:] if argv is None else argv)
        out = Path(options.out)
        _check(options)
        with _terminable(), _work_folder(out) as work:
            figures = _run(options, work)
            _publish(work, out)
        print(table(figures))
        print(f"\nresults: {out}/{{{','.join(RESULTS)}}}")
    except SystemExit as stop:  # the options were not understood, and that was said; or terminated
        return stop.code if isinstance(stop.code, int) else 1
    except KeyboardInterrupt:
        return _complain("interrupted; nothing was written", INTERRUPTED)
    except PreviewError as error:
        return _complain(str(error), error.exit_code)
    except BrokenPipeError:
        raise  # standard output was closed; the command line that called this says so
    except OSError as error:
        return _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error), 2)
    return 0


def _complain(text: str, exit_code: int) -> int:
    print(f"shlight preview: {text}", file=sys.stderr)
    return exit_code


def _check(options: Options) -> None:
    """What can be known to fail before anything is started."""
    with options.scene_file.open("rb"):  # missing, a folder, or not readable: an OSError with its name
        pass
    out = Path(options.out)
    nearest = next(path for path in (out, *out.parents) if path.exists())
    if not nearest.is_dir():
        raise PreviewError(f"{nearest} is a file; --out wants a folder", 2)
    if importlib.util.find_spec("bpy") is None:
        raise PreviewError("the Python module bpy is missing: pip install 'shlight[blender]'", 1)


def _run(options: Options, work: Path) -> dict[str, Any]:
    """Renders and measures; leaves all results in `work`."""
    progress = Progress()
    try:
        figures = run_worker(options, work, progress)
        progress.stage("measuring")
        _measure(options, work, figures)
        progress.end()
        return figures
    except PreviewError as error:
        raise PreviewError(f"{options.scene}: {error}", error.exit_code) from error


def _measure(options: Options, work: Path, figures: dict[str, Any]) -> None:
    from .picture import comparison

    ours, cycles, *halves = (
        images.read_exr(work / name) for name in ("shlight.exr", "cycles_same_time.exr", "half_1.exr", "half_2.exr")
    )
    try:
        reference = add_measurements(figures, ours, cycles, (halves[0], halves[1]))
    except ValueError as error:  # black or not finite
        raise PreviewError(str(error), 1) from error
    add_circumstances(figures, options)
    picture = comparison(options.scene_name, figures, ours, cycles, reference)
    for name, image in (("shlight.exr", ours), ("cycles_same_time.exr", cycles), ("reference.exr", reference)):
        images.write_exr(work / name, image)
    images.write_png(work / "preview.png", picture)
    (work / "figures.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


@contextmanager
def _work_folder(out: Path) -> Iterator[Path]:
    """A temporary folder on the file system of `out`; gone afterwards, whatever happens."""
    place = next(folder for folder in (out.absolute(), *out.absolute().parents) if folder.is_dir())
    try:
        folder = tempfile.TemporaryDirectory(prefix=".shlight-preview-", dir=place)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(out)) from None
    with folder as name:
        yield Path(name)


def _publish(work: Path, out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    for name in RESULTS:
        (work / name).replace(out / name)


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
