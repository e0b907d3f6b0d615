# SPDX-License-Identifier: GPL-3.0-or-later
"""`shlight preview`: checks the request, has the worker render, measures, and puts the results in place."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

from shlight import images
from shlight.commands import CommandError, check_folder, run_command, work_folder

from .figures import add_circumstances, add_measurements, table
from .options import Options, parse
from .progress import Progress
from .supervision import run_worker

RESULTS = ("shlight.exr", "cycles_same_time.exr", "reference.exr", "preview.png", "figures.json")


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for a failure on the way."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command("preview", lambda: _work(arguments), when_interrupted="nothing was written")


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    out = Path(options.out)
    _check(options, out)
    with work_folder(out) as folder:
        figures = _run(options, folder)
        _publish(folder, out)
    print(table(figures))
    print(f"\nresults: {out}/{{{','.join(RESULTS)}}}")


def _check(options: Options, out: Path) -> None:
    """What can be known to fail before anything is started."""
    with options.scene_file.open("rb"):  # missing, a folder, or not readable: an OSError with its name
        pass
    check_folder(out)
    if importlib.util.find_spec("bpy") is None:
        raise CommandError("the Python module bpy is missing: pip install 'shlight[blender]'", 1)


def _run(options: Options, work: Path) -> dict[str, Any]:
    """Renders and measures; leaves all results in `work`."""
    progress = Progress()
    try:
        figures = run_worker(options, work, progress)
        progress.stage("measuring")
        _measure(options, work, figures)
        progress.end()
        return figures
    except CommandError as error:
        raise CommandError(f"{options.scene}: {error}", error.exit_code) from error


def _measure(options: Options, work: Path, figures: dict[str, Any]) -> None:
    from .picture import comparison

    ours, cycles, *halves = (
        images.read_exr(work / name) for name in ("shlight.exr", "cycles_same_time.exr", "half_1.exr", "half_2.exr")
    )
    try:
        reference = add_measurements(figures, ours, cycles, (halves[0], halves[1]))
    except ValueError as error:  # black or not finite
        raise CommandError(str(error), 1) from error
    add_circumstances(figures, options)
    picture = comparison(options.scene_name, figures, ours, cycles, reference)
    for name, image in (("shlight.exr", ours), ("cycles_same_time.exr", cycles), ("reference.exr", reference)):
        images.write_exr(work / name, image)
    images.write_png(work / "preview.png", picture)
    (work / "figures.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


def _publish(work: Path, out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    for name in RESULTS:
        (work / name).replace(out / name)
