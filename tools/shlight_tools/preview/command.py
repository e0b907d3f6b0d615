# SPDX-License-Identifier: MIT
"""`./dev preview`: checks the request, has the worker render, measures, and puts the results in place."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from shlight import images
from shlight.commands import INTERRUPTED, CommandError, check_folder, run_command, work_folder
from shlight_blender.worker_process import Stage, check_blender

from .figures import add_circumstances, table
from .options import Options, parse
from .picture import common_exposure, comparison
from .progress import Progress
from .supervision import run_worker

WORKER = "shlight_tools.preview.worker"
PICTURES = ("shlight", "cycles_same_time", "reference")
FIRST_RESULTS = ("shlight.exr", "shlight.png")
RESULTS = (*FIRST_RESULTS, "cycles_same_time.exr", "reference.exr", "preview.png", "figures.json")


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for a failure on the way."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command("./dev preview", lambda: _work(arguments), when_interrupted="nothing was written")


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    with Path(options.request.scene).open("rb"):  # missing, a folder, or not readable: an OSError with its name
        pass
    check_folder(options.out)
    check_blender()
    with work_folder(options.out) as folder:
        figures = _Preview(options, folder).run()
    print(table(figures))
    print(f"\ncomparison: {options.out / 'preview.png'}\nall results: {options.out}/{{{','.join(RESULTS)}}}")


class _Preview:
    """One preview: what is rendered in the folder `work` goes to that of the results as soon as it is complete."""

    def __init__(self, options: Options, work: Path) -> None:
        self._options = options
        self._work = work
        self._out = options.out
        self._progress = Progress()
        self._has_picture = False

    def run(self) -> dict[str, Any]:
        """Renders, and puts all results in place; returns the figures."""
        try:
            figures = run_worker(WORKER, self._options.request, self._work, self._tick)
            self._show_shlight(figures)
            self._show(figures)
            return figures
        except CommandError as error:
            raise CommandError(f"{self._options.scene}: {error}", error.exit_code) from error
        except KeyboardInterrupt:
            if not self._has_picture:
                raise
            raise CommandError(f"interrupted; shlight's picture stays: {self._picture_path}", INTERRUPTED) from None
        finally:
            self._progress.end()

    def _tick(self, stage: Stage, known: dict[str, Any]) -> None:
        self._show_shlight(known)
        self._progress.show(stage)

    @property
    def _picture_path(self) -> Path:
        return self._out / "shlight.png"

    def _show_shlight(self, known: dict[str, Any]) -> None:
        """Once it is known, shlight's picture in place of an earlier run's results, and its name on the terminal."""
        if self._has_picture or "shlight" not in known:
            return
        seconds = known["shlight"]["seconds"]
        image = np.load(self._work / "shlight.npy")
        images.write_exr(self._work / "shlight.exr", image)
        shown = images.linear_to_srgb8(image[..., :3], common_exposure(image))
        images.write_png(self._work / "shlight.png", shown)
        self._out.mkdir(parents=True, exist_ok=True)
        for name in RESULTS:
            (self._out / name).unlink(missing_ok=True)
        self._publish(FIRST_RESULTS)
        self._has_picture = True
        self._progress.note(f"shlight's picture, rendered in {seconds:.2f} s: {self._picture_path} and shlight.exr")

    def _publish(self, names: tuple[str, ...]) -> None:
        for name in names:
            (self._work / name).replace(self._out / name)

    def _show(self, figures: dict[str, Any]) -> None:
        """All other results in place."""
        pictures = {name: np.load(self._work / f"{name}.npy") for name in PICTURES}
        for name in PICTURES[1:]:
            images.write_exr(self._work / f"{name}.exr", pictures[name])
        add_circumstances(figures, self._options)
        picture = comparison(self._options.scene_name, figures, *pictures.values())
        images.write_png(self._work / "preview.png", picture)
        (self._work / "figures.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
        self._publish(RESULTS[len(FIRST_RESULTS) :])
