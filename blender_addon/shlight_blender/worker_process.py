# SPDX-License-Identifier: GPL-3.0-or-later
"""The process of a worker: it is started, its messages are read without waiting for it, and it is ended for good.

Blender renders in one: whatever it prints, and even its crash, then ends in one clear line. `serving` has the messages.
"""

from __future__ import annotations

import importlib.util
import json
import os
import select
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LOG = "blender.log"
TICK_SECONDS = 0.2


@dataclass
class Stage:
    """A part of a worker's work. expected: seconds that it may take; 0: nobody knows."""

    name: str = "Starting Blender"
    expected: float = 0.0
    since: float = field(default_factory=time.monotonic)

    @property
    def seconds(self) -> float:
        """For how long already."""
        return time.monotonic() - self.since

    @property
    def share(self) -> float:
        """The elapsed share of the expected time, less than 1; 0 if none is expected."""
        return min(self.seconds / self.expected, 0.99) if self.expected > 0 else 0.0


class WorkerError(Exception):
    """The worker failed; the message says why. exit_code: of a command that started it."""

    def __init__(self, text: str, exit_code: int) -> None:
        super().__init__(text)
        self.exit_code = exit_code


def check_blender() -> None:
    """Raises CommandError where a worker would find no Blender."""
    from shlight.commands import CommandError

    if importlib.util.find_spec("bpy") is None:
        raise CommandError("the Python module bpy is missing: pip install 'shlight[blender]'", 1)


class WorkerProcess:
    """A process of its own with all that it starts. Blender's temporary files, and its log, are in `folder`."""

    def __init__(self, command: list[str], request: dict[str, Any], folder: Path, environment: dict[str, str]) -> None:
        """Starts it; `command` without the folder and the file descriptor for messages. OSError if it cannot."""
        (folder / "request.json").write_text(json.dumps(request), encoding="utf-8")
        self._log = folder / LOG
        self._pending = b""
        self.known: dict[str, Any] = {}
        self.stage = Stage()
        self._read_end, write_end = os.pipe()
        try:
            with self._log.open("wb") as log:
                self._process = subprocess.Popen(
                    [*command, str(folder), str(write_end)],
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    pass_fds=[write_end],
                    # Blender reads no preferences of the user.
                    env=environment | {"BLENDER_USER_RESOURCES": str(folder / "blender"), "TMPDIR": str(folder)},
                    start_new_session=True,  # Ctrl-C reaches this process alone, which then ends the worker
                )
        except OSError:
            os.close(self._read_end)
            raise
        finally:
            os.close(write_end)

    def result(self, seconds: float = TICK_SECONDS) -> dict[str, Any] | None:
        """The figures once all are known; None after `seconds` at most, for which it waits. WorkerError if it failed.

        `known` has those that are known before, `stage` what is being done.
        """
        for message in self._messages(seconds):
            if message["kind"] == "error":
                raise WorkerError(message["text"], message["exit_code"])
            if message["kind"] == "stage":
                self.stage = Stage(message["name"], message["expected_seconds"])
                continue
            self.known |= message["figures"]
            if message["kind"] == "result":
                return self.known
        return None

    def _messages(self, seconds: float) -> list[dict[str, Any]]:
        """The messages that were not read."""
        if not select.select([self._read_end], [], [], seconds)[0]:
            return []
        received = os.read(self._read_end, 65536)
        if not received:
            raise WorkerError(last_words(self._process.wait(), self._log), 1)
        *lines, self._pending = (self._pending + received).split(b"\n")
        return [json.loads(line) for line in lines]

    def end(self) -> None:
        """Ends it at once. After its result nothing is left to do but Blender's own end, which may crash."""
        os.close(self._read_end)
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)  # with what it has started itself
        self._process.wait()


def last_words(code: int, log: Path) -> str:
    """How it ended, and the last that it said."""
    how = f"with signal {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    said = [line.strip() for line in lines if line.strip()]
    return f"Blender ended unexpectedly {how}" + (f"; its last words: {said[-1][:300]}" if said else "")
