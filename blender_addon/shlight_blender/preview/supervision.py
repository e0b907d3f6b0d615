# SPDX-License-Identifier: GPL-3.0-or-later
"""Starting the worker, following its messages, and ending it in every case."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from shlight.commands import CommandError

from .options import Options
from .progress import Progress

TICK_SECONDS = 0.2
LOG = "blender.log"


def run_worker(
    options: Options, folder: Path, progress: Progress, on_shlight: Callable[[float], None]
) -> dict[str, Any]:
    """Has the worker render into `folder` and returns its figures; CommandError with its reason if it fails.

    on_shlight(seconds) is called as soon as shlight's picture is in the folder.
    """
    (folder / "request.json").write_text(json.dumps(options.to_data()), encoding="utf-8")
    read_end, write_end = os.pipe()
    with (folder / LOG).open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "shlight_blender.preview.worker", str(folder), str(write_end)],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            pass_fds=[write_end],
            env=_environment(folder),
            start_new_session=True,  # Ctrl-C reaches this process alone, which then ends the worker
        )
    os.close(write_end)
    try:
        return _follow(read_end, progress, on_shlight)
    except EOFError:
        raise CommandError(_last_words(process, folder), 1) from None
    finally:
        os.close(read_end)
        # After its result the worker has nothing left to do but Blender's own end, which takes time and may crash.
        process.kill()
        process.wait()
        progress.end()


def _environment(folder: Path) -> dict[str, str]:
    """Blender reads no preferences of the user, and puts its temporary files where they are removed with the rest."""
    return os.environ | {
        "BLENDER_USER_RESOURCES": str(folder / "blender"),
        "TMPDIR": str(folder),
    }


def _follow(read_end: int, progress: Progress, on_shlight: Callable[[float], None]) -> dict[str, Any]:
    for message in _messages(read_end, progress.tick):
        if message["kind"] == "stage":
            progress.stage(message["name"], message["expected_seconds"])
        elif message["kind"] == "shlight":
            on_shlight(message["seconds"])
        elif message["kind"] == "error":
            raise CommandError(message["text"], message["exit_code"])
        else:
            figures: dict[str, Any] = message["figures"]
            return figures
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
