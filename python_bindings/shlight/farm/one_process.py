# SPDX-License-Identifier: MIT
"""A process that can be ended at once, as Blender's own end may hang, and tasks that one does without Dask."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from functools import partial
from typing import Any

from shlight.commands import interrupts_blocked
from shlight.farm.pictures import Source
from shlight.farm.tasks import Result, Task, perform


class CallsAside:
    """Calls of a function in another process."""

    def __init__(self, function: Callable[..., Any]) -> None:
        spawning = multiprocessing.get_context("spawn")
        self._channel, other_end = spawning.Pipe()
        self._process = spawning.Process(target=_serve, args=(other_end, function), daemon=True)
        with interrupts_blocked():
            self._process.start()
        other_end.close()

    def call(self, *arguments: Any) -> Any:
        """The function's result, or a RuntimeError with its reason. EOFError or OSError where the process dies."""
        self._channel.send(arguments)
        return self._channel.recv()

    def close(self) -> None:
        self._process.kill()
        self._process.join()
        self._channel.close()


def _serve(channel: Any, function: Callable[..., Any]) -> None:
    while True:
        arguments = channel.recv()
        try:
            channel.send(function(*arguments))
        except Exception as error:
            channel.send(RuntimeError(str(error) or type(error).__name__))


class OneProcess:
    """Tasks that one other process does."""

    def __init__(self, source: Source, threads: int) -> None:
        self._perform = partial(perform, source, threads=threads)
        self._tasks: list[Task] = []
        self._aside: CallsAside | None = None

    def submit(self, task: Task) -> None:
        """Puts a task behind the others."""
        self._tasks.append(task)

    def ended(self) -> list[tuple[Task, Callable[[], Result]]]:
        """The next task, with what gives its result or raises."""
        task = self._tasks.pop(0)
        self._aside = self._aside or CallsAside(self._perform)
        try:
            result = self._aside.call(task)
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
        if self._aside is not None:
            self._aside.close()
            self._aside = None
