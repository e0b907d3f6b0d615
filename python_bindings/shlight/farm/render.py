# SPDX-License-Identifier: MIT
"""Frames from a source to files: which are wanted, who renders them, and what becomes of those that fail."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

from shlight.commands import CommandError, work_folder
from shlight.farm import files
from shlight.farm.cluster import Workers, check_dask, connected, core_count, default_workers
from shlight.farm.frames import PNG, check_out, file_of
from shlight.farm.one_process import OneProcess
from shlight.farm.pictures import Picture, Rendered, Source, picture_of
from shlight.farm.progress import FarmProgress
from shlight.farm.tasks import Result, Task
from shlight.farm.tls import Tls, is_loopback

SOURCES = "shlight.scenes"  # the entry point group of what opens scene files


@dataclass
class Outcome:
    """Files that were written, those that were there already, and why the others are missing."""

    written: list[Path] = field(default_factory=list)
    kept: list[Path] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)  # reasons, by frame and view


def render_frames(
    scene: str | os.PathLike[str] | Source,
    frames: Iterable[int] | None,
    out: str | os.PathLike[str],
    *,
    views: Sequence[str] = (),
    settings: Mapping[str, Any] | None = None,
    scale: float = 1.0,
    scheduler: str | None = None,
    workers: int | None = None,
    tls: Tls | None = None,
    insecure: bool = False,
    send: bool = False,
    force: bool = False,
    tile: int | None = None,
    threads: int | None = None,
    retries: int = 1,
) -> Outcome:
    """Renders frames to files, which appear under their names when they are whole.

    scene: a Blender file, a script with a function build_scene(), or a Source of pictures.
    frames: their numbers; None: the one at which the scene's file was saved.
    out: the files' name, in which #### becomes the number of the frame: OpenEXR files, or where it ends in .png
        pictures for display, with the scene's view transform.
    views: views of the scene, or names of cameras; none: all views, or the scene's camera.
    settings: properties of the scene such as {"shlight.noise_threshold": 0.005}. scale: of width and height.
    scheduler: the address of a Dask scheduler; None: `workers` processes on this machine, as many as it has cores
        unless it is given, and for a single picture, or with 0 workers, one process without Dask.
    tls: for all connections. insecure: a scheduler elsewhere may be reached without it; whoever reaches one runs any
        program there, and with what it sends here too.
    send: workers get the file and what it needs sent, and need not see it.
    force: files that are whole and of this scene and these settings are rendered too.
    tile: OpenEXR files are rendered in tiles of this side; None: those of more than 2^24 pixels in tiles of 1024; 0:
        none. Pixels depend on it within the noise threshold.
    threads: of each worker; None: all cores, shared by the workers where they are on this machine.
    retries: renders of a frame after one that has failed.

    Prints progress. A frame that fails ends up in `failed`, and the others go on. Raises ValueError or CommandError
    where nothing can be rendered, and OSError where a file cannot be written; what is whole then stays.
    """
    wanted, out = None if frames is None else list(dict.fromkeys(frames)), os.fspath(out)
    frame_count = 1 if wanted is None else len(wanted)
    _check(wanted, out, scheduler, workers, tile, retries)
    if scheduler is not None and not (tls or insecure or is_loopback(scheduler)):
        raise ValueError(
            f"scheduler {scheduler} is elsewhere: whoever reaches one without TLS can run programs on this machine and "
            "its workers; give certificates (tls), or in a network of your own insecure"
        )
    if tls is not None:
        tls.check()
    several = scheduler is not None or (workers or 0) > 0 or (workers is None and frame_count > 1)
    if several:
        check_dask()
    with ExitStack() as stack:

        def connect(tasks: int) -> Any:
            count = default_workers(tasks) if workers is None else workers
            return stack.enter_context(connected(scheduler, count, tls, partial(print, flush=True)))

        # Workers need as long to begin as Blender needs to open the file.
        aside = stack.enter_context(ThreadPoolExecutor(1))
        opening = aside.submit(_opened, scene, views, dict(settings or {}), scale, send, Path(out).suffix == PNG)
        client = connect(frame_count) if several else None
        source = opening.result()
        outcome, pictures = _pictures(source, wanted or [source.frame], out, tile, force)
        progress = FarmProgress(len(pictures), len(outcome.kept))
        tasks = [Task(picture, number) for picture in pictures for number in range(len(picture.boxes))]
        if tasks:
            Path(out).absolute().parent.mkdir(parents=True, exist_ok=True)
            if client is None and workers is None and len(tasks) > 1:
                client = connect(len(tasks))
            pool: Workers | OneProcess
            if client is None:
                pool = OneProcess(source, threads or 0)
            else:
                if scheduler is None:
                    count = default_workers(len(tasks)) if workers is None else workers
                    client.cluster.scale(count)
                    threads = threads or max(1, core_count() // count)
                archive = _archive(source, Path(out), stack) if send else None
                pool = Workers(client, source, threads or 0, progress.say, archive)
            stack.callback(pool.close)
            _Run(pool, outcome, progress, retries, stack).run(tasks)
    progress.end(outcome.failed)
    return outcome


def _pictures(
    source: Source, frames: list[int], out: str, tile: int | None, force: bool
) -> tuple[Outcome, list[Picture]]:
    """What is kept, and the pictures that are to be rendered."""
    pictures = [
        picture_of(source, frame, view, file_of(out, frame, suffix), tile)
        for frame in frames
        for view, suffix in source.views
    ]
    outcome = Outcome(kept=[picture.path for picture in pictures if not force and files.is_whole(picture)])
    kept = set(outcome.kept)
    return outcome, [picture for picture in pictures if picture.path not in kept]


def _check(
    frames: list[int] | None, out: str, scheduler: str | None, workers: int | None, tile: int | None, retries: int
) -> None:
    if frames is not None and not (frames and all(isinstance(frame, int) and frame >= 0 for frame in frames)):
        raise ValueError("frames must be at least one whole number, and none negative")
    check_out(out, 1 if frames is None else len(frames))
    if tile and Path(out).suffix == PNG:
        raise ValueError("tile is for OpenEXR files")
    for name, value in (("workers", workers), ("tile", tile), ("retries", retries)):
        if value is not None and (not isinstance(value, int) or value < 0):
            raise ValueError(f"{name} must be a whole number, 0 or more, got {value}")
    if tile and tile % files.TILE:
        raise ValueError(f"tile must be a multiple of {files.TILE}, got {tile}")
    if scheduler is not None and workers is not None:
        raise ValueError("workers and scheduler cannot be given both")


def _opened(
    scene: str | os.PathLike[str] | Source,
    views: Sequence[str],
    settings: dict[str, Any],
    scale: float,
    send: bool,
    for_display: bool,
) -> Source:
    """The source that an installed package makes of a scene's file."""
    if not isinstance(scene, (str, os.PathLike)):
        return scene
    openers = metadata.entry_points(group=SOURCES)
    source: Source = next(iter(openers)).load()(
        Path(scene), views=tuple(views), settings=settings, scale=scale, sent=send, for_display=for_display
    )
    return source


def _archive(source: Any, out: Path, stack: ExitStack) -> Path:
    """The file that workers get sent."""
    if not hasattr(source, "pack"):
        raise ValueError("send is for scene files")
    path: Path = source.pack(stack.enter_context(work_folder(out.absolute().parent)))
    return path


class _Run:
    """Tasks on their way to files."""

    def __init__(
        self, pool: Workers | OneProcess, outcome: Outcome, progress: FarmProgress, retries: int, stack: ExitStack
    ) -> None:
        self._pool = pool
        self._outcome = outcome
        self._progress = progress
        self._retries = retries
        self._stack = stack
        self._failures: Counter[Task] = Counter()
        self._tiled: dict[Picture, files.TiledFile] = {}

    def run(self, tasks: list[Task]) -> None:
        """Until every picture is a file or has failed."""
        left = set(tasks)
        for task in tasks:
            self._pool.submit(task)
        while left:
            self._progress.tick()
            for task, result in self._pool.ended():
                if task in left and self._is_done(task, result):
                    left.discard(task)
                    if task.picture.name in self._outcome.failed:
                        left = {other for other in left if other.picture != task.picture}

    def _is_done(self, task: Task, result: Callable[[], Result]) -> bool:
        try:
            made = result()
        except CommandError:
            raise
        except Exception as error:
            return self._fail(task, error)
        for message in made.messages:
            self._progress.say_once(message)
        self._put(task, made.made)
        return True

    def _fail(self, task: Task, error: Exception) -> bool:
        picture = task.picture
        reason = " ".join(str(error).split()) or type(error).__name__
        self._failures[task] += 1
        if self._failures[task] <= self._retries:
            self._progress.say(f"{picture.name}: {reason}; tried again, {self._failures[task]} of {self._retries}")
            self._pool.submit(task)
            return False
        self._outcome.failed[picture.name] = reason
        self._pool.cancel(lambda other: other.picture == picture)
        if picture in self._tiled:
            self._tiled[picture].drop()
        self._progress.count(f"{picture.name} failed: {reason}")
        return True

    def _put(self, task: Task, made: bytes | Rendered) -> None:
        picture = task.picture
        if isinstance(made, bytes):
            files.write(picture.path, made)
        else:
            if picture not in self._tiled:
                self._tiled[picture] = files.TiledFile(picture)
                self._stack.callback(self._tiled[picture].drop)
            box = picture.boxes[task.number]
            assert box is not None
            if not self._tiled[picture].add(box, made):
                self._progress.count_tile(1.0 / len(picture.boxes))
                return
            del self._tiled[picture]
        self._outcome.written.append(picture.path)
        self._progress.count(f"{picture.name}: {picture.path}")
