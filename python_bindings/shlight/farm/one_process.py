# SPDX-License-Identifier: MIT
"""Tasks one after the other, without Dask, in a process that can be ended at once: Blender's own end may hang."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from typing import Any

from shlight.commands import interrupts_blocked
from shlight.farm.pictures import Source
from shlight.farm.tasks import Result, Task, perform


class OneProcess:
    """Tasks that one other process does."""

    def __init__(self, source: Source, threads: int) -> None:
        self._source, self._threads = source, threads
        self._tasks: list[Task] = []
        self._process: Any = None
        self._channel: Any = None

    def submit(self, task: Task) -> None:
        """Puts a task behind the others."""
        self._tasks.append(task)

    def ended(self) -> list[tuple[Task, Callable[[], Result]]]:
        """The next task, with what gives its result or raises."""
        task = self._tasks.pop(0)
        if self._process is None:
            self._start()
        try:
            self._channel.send(task)
            result = self._channel.recv()
        except (EOFError, OSError):
            self.close()
            result = RuntimeError("the process died while it rendered it, killed or out of memory")

        def given() -> Result:
            if isinstance(result, Exception):
                raise result
            return result

        return [(task, given)]

    def cancel(self, tasks: Callable[[Task], bool]) -> None:
        """Tasks that are not needed any more."""
        self._tasks = [task for task in self._tasks if not tasks(task)]

    def close(self) -> None:
        """Ends the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._channel.close()
            self._process = None

    def _start(self) -> None:
        spawning = multiprocessing.get_context("spawn")
        self._channel, other_end = spawning.Pipe()
        self._process = spawning.Process(target=_serve, args=(other_end, self._source, self._threads), daemon=True)
        with interrupts_blocked():
            self._process.start()
        other_end.close()


def _serve(channel: Any, source: Source, threads: int) -> None:
    while True:
        task = channel.recv()
        try:
            channel.send(perform(source, task, threads))
        except Exception as error:
            channel.send(RuntimeError(str(error) or type(error).__name__))
