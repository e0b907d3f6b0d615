# SPDX-License-Identifier: GPL-3.0-or-later
"""Starting a worker, following its messages, and ending it in every case."""

from __future__ import annotations

import importlib.util
import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from shlight.commands import CommandError

TICK_SECONDS = 0.2
LOG = "blender.log"


def check_blender() -> None:
    """Raises CommandError where a worker would find no Blender."""
    if importlib.util.find_spec("bpy") is None:
        raise CommandError("the Python module bpy is missing: pip install 'shlight[blender]'", 1)


def run_worker(
    module: str, request: dict[str, Any], folder: Path, tick: Callable[[], None], hear: Callable[[dict[str, Any]], None]
) -> dict[str, Any]:
    """Has the worker `module` render into `folder` and returns its figures; CommandError with its reason if it fails.

    tick() is called a few times a second and ends the worker by raising an exception, hear(message) is told each
    message but the last.
    """
    (folder / "request.json").write_text(json.dumps(request), encoding="utf-8")
    read_end, write_end = os.pipe()
    with (folder / LOG).open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", module, str(folder), str(write_end)],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            pass_fds=[write_end],
            env=_environment(folder),
            start_new_session=True,  # Ctrl-C reaches this process alone, which then ends the worker
        )
    os.close(write_end)
    try:
        return _follow(read_end, tick, hear)
    except EOFError:
        raise CommandError(_last_words(process, folder), 1) from None
    finally:
        os.close(read_end)
        # After its result the worker has nothing left to do but Blender's own end, which takes time and may crash.
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)  # with what it has started itself
        process.wait()


def _environment(folder: Path) -> dict[str, str]:
    """Blender reads no preferences of the user, and puts its temporary files where they are removed with the rest."""
    return os.environ | {
        "BLENDER_USER_RESOURCES": str(folder / "blender"),
        "TMPDIR": str(folder),
    }


def _follow(read_end: int, tick: Callable[[], None], hear: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    for message in _messages(read_end, tick):
        if message["kind"] == "error":
            raise CommandError(message["text"], message["exit_code"])
        if message["kind"] == "result":
            figures: dict[str, Any] = message["figures"]
            return figures
        hear(message)
    raise EOFError


def _messages(read_end: int, tick: Callable[[], None]) -> Iterator[Any]:
    pending = b""
    while True:
        tick()
        if not select.select([read_end], [], [], TICK_SECONDS)[0]:
            continue
        received = os.read(read_end, 65536)
        if not received:
            return
        *lines, pending = (pending + received).split(b"\n")
        for line in lines:
            yield json.loads(line)


def _last_words(process: subprocess.Popen[bytes], folder: Path) -> str:
    code = process.wait()
    how = f"with signal {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
    lines = (folder / LOG).read_text(encoding="utf-8", errors="replace").split("\n")
    said = [line.strip() for line in lines if line.strip()]
    return f"Blender ended unexpectedly {how}" + (f"; its last words: {said[-1][:300]}" if said else "")
