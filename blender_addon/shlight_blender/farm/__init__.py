# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files as sources of pictures for `shlight.farm`: Blender files, and scripts with a function build_scene()."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from shlight.commands import CommandError

from ..comparison.supervision import check_blender
from .source import SceneFile, describe


def open_scene_file(
    path: Path, *, views: tuple[str, ...], settings: Mapping[str, Any], scale: float, sent: bool
) -> SceneFile:
    """The source of a file's pictures, which is opened in a process of its own.

    Raises CommandError, ValueError or OSError where nothing of it can be rendered.
    """
    check_blender()
    with path.open("rb"):  # the usual FileNotFoundError
        pass
    if not 0.0 < scale <= 100.0:
        raise ValueError(f"scale must be above 0 and at most 100, got {scale}")
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), _say_nothing) as pool:
        try:
            return pool.submit(describe, path, views, settings, scale, sent).result()
        except BrokenProcessPool:
            raise CommandError(f"{path}: Blender crashed when it opened it", 1) from None
        except (ValueError, OSError):
            raise
        except Exception as error:  # SceneError among them, whose module needs bpy
            raise CommandError(f"{path}: {error}", 2) from None


def _say_nothing() -> None:
    """Blender's chatter is no output of the command."""
    with Path(os.devnull).open("wb") as nothing:
        os.dup2(nothing.fileno(), 1)
