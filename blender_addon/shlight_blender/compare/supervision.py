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

from ..worker_process import Stage, WorkerError, WorkerProcess
from .request import Request


def check_blender() -> None:
    """Raises CommandError where a worker would find no Blender."""
    if importlib.util.find_spec("bpy") is None:
        raise CommandError("the Python module bpy is missing: pip install 'shlight[blender]'", 1)


def run_worker(
    module: str, request: Request, folder: Path, tick: Callable[[Stage, dict[str, Any]], None]
) -> dict[str, Any]:
    """Has the worker `module` render into `folder` and returns its figures; CommandError with its reason if it fails.

    tick() is called a few times a second, with what is being done and the figures that are known already, and ends the
    worker by raising an exception.
    """
    worker = WorkerProcess([sys.executable, "-m", module], request.to_data(), folder, dict(os.environ))
    try:
        while (figures := worker.result()) is None:
            tick(worker.stage, worker.known)
        return figures
    except WorkerError as error:
        tick(worker.stage, worker.known)  # what came with the error
        raise CommandError(str(error), error.exit_code) from None
    finally:
        worker.end()
