# SPDX-License-Identifier: GPL-3.0-or-later
"""Another process that works for this one, from both sides.

`WorkerProcess` starts it, reads its messages without waiting for it, and ends it for good: Blender renders in one, and
whatever it prints, and even its crash, then ends in one clear line. `serve` is what runs in it. Its last argument is a
folder, which holds request.json and takes what it makes and its messages. A message is a line of the file messages.json
there, since descriptors cannot be passed on in every system; it is a pair:
    "stage" and the arguments of Stage: what is done from now on
    "known" and figures by name: of the result, already
    "result" and figures by name: the rest of it, or
    "error" and the arguments of WorkerError: why there is none
"""

from __future__ import annotations

import ctypes
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .names import one_line

PR_SET_PDEATHSIG = 1  # from linux/prctl.h
LOG, MESSAGES = "blender.log", "messages.json"  # in the folder


class SceneError(RuntimeError):
    """The scene cannot be opened or has nothing to render; the message is for the user."""

    exit_code = 2  # of a command whose request it was


class Channel:
    """The way to the process that wants to know."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def stage(self, name: str, expected_seconds: float = 0.0) -> None:
        """Says what is done from now on; 0: nobody knows how long."""
        self.send("stage", (name, expected_seconds))

    def known(self, **figures: Any) -> None:
        """Says what of the result is known."""
        self.send("known", figures)

    def send(self, kind: str, given: Any) -> None:
        self._stream.write(json.dumps([kind, given]) + "\n")
        self._stream.flush()


Work = Callable[[dict[str, Any], Path, Channel], dict[str, Any]]


def serve(work: Work, argv: list[str]) -> None:
    """Sends what work(request, folder, channel) returns, or why it fails."""
    if sys.platform == "linux":
        # A command that is killed cannot end the worker; then the system does.
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    folder = Path(argv[-1])
    request = json.loads((folder / "request.json").read_text(encoding="utf-8"))
    with (folder / MESSAGES).open("a", encoding="utf-8") as stream:
        channel = Channel(stream)
        try:
            channel.send("result", work(request, folder, channel))
        except Exception as error:
            traceback.print_exc()
            # Blender's operators fail with RuntimeErrors, whose text says enough.
            kind = "" if isinstance(error, RuntimeError) else f"{type(error).__name__}: "
            channel.send("error", (kind + one_line(error), getattr(error, "exit_code", 1)))


TICK_SECONDS = 0.2
LOOK_SECONDS = 0.02  # between looks at the messages


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

    def __init__(self, text: str, exit_code: int = 1) -> None:
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
        """Starts it; `command` without the folder. OSError if it cannot."""
        (folder / "request.json").write_text(json.dumps(request), encoding="utf-8")
        self._log = folder / LOG
        self.known: dict[str, Any] = {}
        self.stage = Stage()
        self._pending = b""
        (folder / MESSAGES).touch()
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                [*command, str(folder)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                # Blender reads no preferences of the user.
                env=environment | {"BLENDER_USER_RESOURCES": str(folder / "blender"), "TMPDIR": str(folder)},
                start_new_session=True,  # Ctrl-C reaches this process alone, which then ends the worker
            )
        self._messages = (folder / MESSAGES).open("rb")

    def result(self, seconds: float = TICK_SECONDS) -> dict[str, Any] | None:
        """The figures once all are known; None after other messages or `seconds` without any. WorkerError if it fails.

        `known` has those that are known before, `stage` what is being done.
        """
        until = time.monotonic() + seconds
        while True:
            code = self._process.poll()  # before the messages, of which it then has written the last
            *lines, self._pending = (self._pending + self._messages.read()).split(b"\n")
            for kind, given in map(json.loads, lines):
                if kind == "error":
                    raise WorkerError(*given)
                if kind == "stage":
                    self.stage = Stage(*given)
                    continue
                self.known |= given
                if kind == "result":
                    return self.known
            if code is not None:
                raise WorkerError(last_words(code, self._log))
            if lines or time.monotonic() >= until:
                return None
            time.sleep(LOOK_SECONDS)

    def end(self) -> None:
        """Ends it at once. After its result nothing is left to do but Blender's own end, which may crash."""
        self._messages.close()
        if hasattr(os, "killpg"):
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)  # with what it has started itself
        self._process.kill()
        self._process.wait()


def last_words(code: int, log: Path) -> str:
    """How it ended, and the last that it said."""
    how = f"with signal {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    said = [line.strip() for line in lines if line.strip()]
    return f"Blender ended unexpectedly {how}" + (f"; its last words: {said[-1][:300]}" if said else "")
