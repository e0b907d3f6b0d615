# SPDX-License-Identifier: MIT
"""What a command asks of a worker, and how it follows its messages and ends it in every case."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from shlight.commands import CommandError
from shlight_blender.compare.reference import Request
from shlight_blender.worker_process import Stage, WorkerError, WorkerProcess


@dataclass(frozen=True, kw_only=True)
class SceneRequest(Request):
    """The request of a command line; None keeps the scene's value."""

    lights: list[str] | None = None  # names of the lamps that shine
    size: tuple[int, int] | None = None
    frame: int | None = None
    threads: int = 0  # 0: all
    order: str | None = None
    tolerance: float | None = None
    pixel_samples: int | None = None
    shadow_rays: int | None = None  # 0: no shadows
    max_bounces: int | None = None  # of both
    render_seconds: float | None = None  # time limit of shlight; 0: none


def run_worker(
    module: str, request: SceneRequest, folder: Path, tick: Callable[[Stage, dict[str, Any]], None]
) -> dict[str, Any]:
    """Has the worker `module` render into `folder` and returns its figures; CommandError with its reason if it fails.

    tick() is called a few times a second, with what is being done and the figures that are known already, and ends the
    worker by raising an exception.
    """
    worker = WorkerProcess([sys.executable, "-m", module], asdict(request), folder, dict(os.environ))
    try:
        while (figures := worker.result()) is None:
            tick(worker.stage, worker.known)
        return figures
    except WorkerError as error:
        tick(worker.stage, worker.known)  # what came with the error
        raise CommandError(str(error), error.exit_code) from None
    finally:
        worker.end()
