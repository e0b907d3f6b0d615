# SPDX-License-Identifier: MIT
"""One task: a picture or a tile, where it is rendered."""

from __future__ import annotations

import atexit
import ctypes
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from shlight.farm import files
from shlight.farm.pictures import Picture, Rendered, Source

received_files = Path()  # the folder of files that a worker got sent


@dataclass(frozen=True)
class Task:
    """A tile of a picture, or all of it."""

    picture: Picture
    number: int  # of the tile


@dataclass(frozen=True)
class Result:
    """The result of a task: the file of a picture, or a tile, and messages to the user."""

    made: bytes | Rendered
    messages: Sequence[str]


def perform_on_worker(source: Source, task: Task, threads: int, own: bool) -> Result:
    """Runs `perform` in one fixed thread of a worker's process: Blender must stay in the thread it started in.

    own: the process was started for these tasks, and has nothing to keep when they are done.
    """
    from distributed import get_worker

    global received_files
    received_files = Path(get_worker().local_directory)
    try:
        return _render_thread().submit(perform, source, task, threads).result()
    finally:
        _give_memory_back()
        if own:
            _end_at_once()


def perform(source: Source, task: Task, threads: int) -> Result:
    picture = task.picture
    rendered = source.render(picture.frame, picture.view, picture.boxes[task.number], threads)
    if picture.is_whole:
        return Result(files.encode(picture, rendered), rendered.messages)
    return Result(rendered, rendered.messages)


def _give_memory_back() -> None:
    """The GNU C library keeps freed memory for each of its threads, of which every render has others."""
    with suppress(AttributeError, OSError):  # other C libraries have no such function
        ctypes.CDLL(None).malloc_trim(0)


@cache
def _end_at_once() -> None:
    """Ends the process without Blender's own end, which may hang. What is registered last is called first."""
    atexit.register(os._exit, 0)


@cache
def _render_thread() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="shlight render")
