# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of a process that works for another one; `worker_process` starts it and reads its messages.

Its last two arguments are a folder, which holds request.json and takes what it makes, and a file descriptor for
messages. A message is a line of JSON:
    {"kind": "stage", "name": ..., "expected_seconds": ...}: what is done from now on
    {"kind": "known", "figures": ...}: of the result, already
    {"kind": "result", "figures": ...}: the rest of it, or
    {"kind": "error", "text": ..., "exit_code": ...}: why there is none
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .names import one_line

PR_SET_PDEATHSIG = 1  # from linux/prctl.h


class SceneError(RuntimeError):
    """The scene cannot be opened or has nothing to render; the message is for the user."""

    exit_code = 2  # of a command whose request it was


class Channel:
    """The way to the process that wants to know."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def stage(self, name: str, expected_seconds: float = 0.0) -> None:
        """Says what is done from now on; 0: nobody knows how long."""
        self.send("stage", name=name, expected_seconds=expected_seconds)

    def known(self, **figures: Any) -> None:
        """Says what of the result is known."""
        self.send("known", figures=figures)

    def send(self, kind: str, **message: Any) -> None:
        """Sends any message."""
        self._stream.write(json.dumps({"kind": kind, **message}) + "\n")
        self._stream.flush()


Work = Callable[[dict[str, Any], Path, Channel], dict[str, Any]]


def serve(work: Work, argv: list[str]) -> None:
    """Sends what work(request, folder, channel) returns, or why it fails."""
    if sys.platform == "linux":
        # A command that is killed cannot end the worker; then the system does.
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    folder = Path(argv[-2])
    request = json.loads((folder / "request.json").read_text(encoding="utf-8"))
    with os.fdopen(int(argv[-1]), "w", encoding="utf-8") as stream:
        channel = Channel(stream)
        try:
            channel.send("result", figures=work(request, folder, channel))
        except Exception as error:
            traceback.print_exc()
            # Blender's operators fail with RuntimeErrors, whose text says enough.
            kind = "" if isinstance(error, RuntimeError) else f"{type(error).__name__}: "
            channel.send("error", text=kind + one_line(error), exit_code=getattr(error, "exit_code", 1))
