# SPDX-License-Identifier: GPL-3.0-or-later
"""How a command has a worker render, follows its messages, and ends it in every case."""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from shlight.commands import CommandError

from .process import WorkerError, WorkerProcess

TICK_SECONDS = 0.2


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
    worker = WorkerProcess([sys.executable, "-m", module], request, folder, dict(os.environ))
    try:
        while True:
            tick()
            for message in worker.messages(TICK_SECONDS):
                if message["kind"] == "result":
                    figures: dict[str, Any] = message["figures"]
                    return figures
                hear(message)
    except WorkerError as error:
        raise CommandError(str(error), error.exit_code) from None
    finally:
        worker.end()
