# SPDX-License-Identifier: MIT
"""`./dev survey`: finds the files, has a worker render each, says how it went, and keeps the results."""

from __future__ import annotations

import json
import shutil
import sys
import threading
import time
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from shlight import images
from shlight.commands import INTERRUPTED, CommandError, check_folder, run_command, work_folder
from shlight_blender.worker_process import LOG, Stage, check_blender

from ..preview.supervision import run_worker
from . import records
from .options import SUFFIXES, Options, parse
from .records import Record
from .sheet import strip, write_sheet

WORKER = "shlight_tools.survey.worker"
JSON, SHEET, PICTURES = "survey.json", "contact_sheet.png", "pictures"
PARTS = ("strip.png", "shlight.exr", "cycles.exr")  # of each file
LOG_LINES = 20  # that are kept of a file that failed


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for a failure on the way."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command("./dev survey", lambda: _work(arguments), when_interrupted="nothing was written")


def _work(arguments: list[str]) -> None:
    options = parse(arguments)
    files = find_files(options.folder)
    check_folder(options.out)
    check_blender()
    survey = _Survey(options, files)
    survey.keep()
    with work_folder(options.out) as folder:
        survey.run(folder)
    print(f"\n{records.summary(survey.records)}")
    print(f"\ncontact sheet: {options.out / SHEET}\nall results: {options.out}/{{{JSON},{PICTURES}}}")


def find_files(folder: Path) -> list[Path]:
    """All files of the folder and those in it that can be surveyed, sorted, relative to it."""
    next(folder.iterdir(), None)  # missing, no folder, or not readable: an OSError with its name
    found = (path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())
    files = sorted(path.relative_to(folder) for path in found)
    if not files:
        raise CommandError(f"{folder}: there is no file {', '.join(SUFFIXES)} in it", 2)
    return files


class _Stopped(Exception):  # noqa: N818
    """The survey ends, and with it the worker of the file that is being rendered."""


class _Survey:
    """The files, and what is known of those that are done."""

    def __init__(self, options: Options, files: list[Path]) -> None:
        self._options = options
        self._files = files
        self._out = options.out
        self._stop = threading.Event()
        self.records: list[Record] = []

    def keep(self) -> None:
        """Takes what an earlier survey in the same folder has, if that is asked for."""
        path = self._out / JSON
        if not self._options.resume or not path.is_file():
            return
        try:
            before = json.loads(path.read_text(encoding="utf-8"))
            names = {str(file) for file in self._files}
            self.records = [record for record in before["files"] if record["file"] in names]
            same = before["options"] == self._circumstances()["options"]
        except (ValueError, KeyError, TypeError) as error:
            raise CommandError(f"{path}: this is no survey that can be resumed ({error})", 2) from error
        if not same:
            raise CommandError(f"{path}: that survey had other options; --resume needs the same", 2)

    def run(self, work: Path) -> None:
        """Does all files that are not done; each is written and said as soon as it is done."""
        print(records.HEADING, flush=True)
        for record in self.records:
            print(records.line(record), flush=True)
        try:
            with closing(self._done(work)) as done:
                for record in done:
                    self.records.append(record)
                    records.write(self._out / JSON, self.records, self._circumstances())
                    print(records.line(record), flush=True)
        except KeyboardInterrupt:
            if not self.records:
                raise
            how_many = f"{len(self.records)} of {len(self._files)} files are done, see {self._out / JSON}"
            raise CommandError(f"interrupted; {how_many}; --resume does the others", INTERRUPTED) from None
        strips = {record["file"]: self._picture(record["file"], PARTS[0]) for record in self.records}
        size = self._options.render["size"]
        write_sheet(self._out / SHEET, self.records, strips, size, self._options.worst)

    def _done(self, work: Path) -> Generator[Record, None, None]:
        """The records of the files that are left, in the order in which they are done."""
        known = {record["file"] for record in self.records}
        left = [file for file in self._files if str(file) not in known]
        with ThreadPoolExecutor(self._options.jobs) as pool:
            try:
                tasks = [pool.submit(self._survey, file, work / str(n)) for n, file in enumerate(left)]
                for task in as_completed(tasks):
                    yield task.result()
            except BaseException:
                self._stop.set()
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _survey(self, file: Path, work: Path) -> Record:
        """Renders one file; its pictures are in place afterwards."""
        work.mkdir()
        record: Record = {"file": str(file), "problem": ""}
        begun = time.monotonic()

        def tick(stage: Stage, known: dict[str, Any]) -> None:
            record.update(records.flat(known))
            if self._stop.is_set():
                raise _Stopped
            if 0 < self._options.time_limit < time.monotonic() - begun:
                raise CommandError(f"no answer after {self._options.time_limit:g} s: {stage.name}", 1)

        request = self._options.of_file(self._options.folder / file)
        try:
            record |= records.flat(run_worker(WORKER, request, work, tick))
            self._write_pictures(work)
        except CommandError as error:
            record["problem"] = str(error)
            record["log"] = _tail(work / LOG)
        record["seconds"] = time.monotonic() - begun
        self._publish(file, work)
        return record

    def _write_pictures(self, work: Path) -> None:
        ours, theirs = (np.load(work / f"{name}.npy") for name in ("shlight", "reference"))
        images.write_exr(work / "shlight.exr", ours)
        images.write_exr(work / "cycles.exr", theirs)
        images.write_png(work / "strip.png", strip(ours, theirs))

    def _publish(self, file: Path, work: Path) -> None:
        for part in PARTS:
            target = self._picture(str(file), part)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.unlink(missing_ok=True)
            if (work / part).is_file():
                (work / part).replace(target)
        shutil.rmtree(work)

    def _picture(self, file: str, part: str) -> Path:
        """The path of a picture of a file."""
        return self._out / PICTURES / f"{file}.{part.removeprefix('strip.')}"

    def _circumstances(self) -> dict[str, Any]:
        render = self._options.render
        return {"folder": str(self._options.folder), "options": render | {"size": list(render["size"])}}


def _tail(log: Path) -> list[str]:
    return log.read_text(encoding="utf-8", errors="replace").splitlines()[-LOG_LINES:] if log.is_file() else []
