# SPDX-License-Identifier: GPL-3.0-or-later
"""`shlight preview`: checks the request, has the worker render, measures, and puts the results in place."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from shlight import images
from shlight.commands import INTERRUPTED, CommandError, check_folder, run_command, work_folder

from ..comparison.measurements import Image, add_measurements
from ..comparison.pictures import common_exposure
from ..comparison.supervision import check_blender, run_worker
from .figures import add_circumstances, table
from .options import Options, parse
from .picture import comparison
from .progress import Progress

WORKER = "shlight_blender.preview.worker"
FIRST_RESULTS = ("shlight.exr", "shlight.png")
RESULTS = (*FIRST_RESULTS, "cycles_same_time.exr", "reference.exr", "preview.png", "figures.json")


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for a failure on the way."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command("shlight preview", lambda: _work(arguments), when_interrupted="nothing was written")


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    out = Path(options.out)
    _check(options, out)
    with work_folder(out) as folder:
        figures = _Preview(options, folder, out).run()
    print(table(figures))
    print(f"\ncomparison: {out / 'preview.png'}\nall results: {out}/{{{','.join(RESULTS)}}}")


def _check(options: Options, out: Path) -> None:
    """Raises errors that can be found before anything is started."""
    with options.scene_file.open("rb"):  # missing, a folder, or not readable: an OSError with its name
        pass
    check_folder(out)
    check_blender()


class _Preview:
    """One preview: what is rendered in the folder `work` goes to `out` as soon as it is complete."""

    def __init__(self, options: Options, work: Path, out: Path) -> None:
        self._options = options
        self._work = work
        self._out = out
        self._progress = Progress()
        self._shlight: Image | None = None  # once it is in place

    def run(self) -> dict[str, Any]:
        """Renders, measures, and puts all results in place; returns the figures."""
        try:
            figures = run_worker(WORKER, self._options.to_data(), self._work, self._progress.tick, self._hear)
            self._progress.stage("measuring")
            self._measure(figures)
            self._publish(RESULTS[len(FIRST_RESULTS) :])
            return figures
        except CommandError as error:
            raise CommandError(f"{self._options.scene}: {error}", error.exit_code) from error
        except KeyboardInterrupt:
            if self._shlight is None:
                raise
            raise CommandError(f"interrupted; shlight's picture stays: {self._picture_path}", INTERRUPTED) from None
        finally:
            self._progress.end()

    def _hear(self, message: dict[str, Any]) -> None:
        if message["kind"] == "stage":
            self._progress.stage(message["name"], message["expected_seconds"])
        else:
            self._show_shlight(message["seconds"])

    @property
    def _picture_path(self) -> Path:
        return self._out / "shlight.png"

    def _show_shlight(self, seconds: float) -> None:
        """shlight's picture in place of an earlier run's results, and its name on the terminal."""
        image = images.read_exr(self._work / "shlight.exr")
        images.write_exr(self._work / "shlight.exr", image)
        shown = images.linear_to_srgb8(image[..., :3], common_exposure(image))
        images.write_png(self._work / "shlight.png", shown)
        self._out.mkdir(parents=True, exist_ok=True)
        for name in RESULTS:
            (self._out / name).unlink(missing_ok=True)
        self._publish(FIRST_RESULTS)
        self._shlight = image
        self._progress.note(f"shlight's picture, rendered in {seconds:.2f} s: {self._picture_path} and shlight.exr")

    def _publish(self, names: tuple[str, ...]) -> None:
        for name in names:
            (self._work / name).replace(self._out / name)

    def _measure(self, figures: dict[str, Any]) -> None:
        cycles, *halves = (
            images.read_exr(self._work / name) for name in ("cycles_same_time.exr", "half_1.exr", "half_2.exr")
        )
        assert self._shlight is not None
        try:
            reference = add_measurements(figures, self._shlight, cycles, (halves[0], halves[1]))
        except ValueError as error:  # black or not finite
            raise CommandError(str(error), 1) from error
        add_circumstances(figures, self._options)
        picture = comparison(self._options.scene_name, figures, self._shlight, cycles, reference)
        images.write_exr(self._work / "cycles_same_time.exr", cycles)
        images.write_exr(self._work / "reference.exr", reference)
        images.write_png(self._work / "preview.png", picture)
        (self._work / "figures.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
