# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files as sources of pictures for `shlight.farm`: Blender files, and scripts with a function build_scene()."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from shlight.commands import CommandError
from shlight.farm.one_process import CallsAside

from ..worker_process import check_blender
from .source import SceneFile, describe


def open_scene_file(
    path: Path, *, views: tuple[str, ...], settings: Mapping[str, Any], scale: float, sent: bool, for_display: bool
) -> SceneFile:
    """The source of a file's pictures, which is opened in a process of its own.

    Raises CommandError, ValueError or OSError where nothing of it can be rendered.
    """
    check_blender()
    with path.open("rb"):  # the usual FileNotFoundError
        pass
    if not 0.0 < scale <= 100.0:
        raise ValueError(f"scale must be above 0 and at most 100, got {scale}")
    aside = CallsAside(_described)
    try:
        found: SceneFile | Exception = aside.call(path, views, settings, scale, sent, for_display)
    except EOFError:
        raise CommandError(f"{path}: Blender crashed when it opened it", 1) from None
    finally:
        aside.close()
    if isinstance(found, Exception):
        raise found
    return found


def _described(path: Path, *arguments: Any) -> SceneFile | Exception:
    """In a process of its own, whose standard output is none of the command's."""
    with Path(os.devnull).open("wb") as nothing:
        os.dup2(nothing.fileno(), 1)
    try:
        return describe(path, *arguments)
    except (ValueError, OSError) as error:
        return error
    except Exception as error:  # SceneError among them, whose module needs bpy
        return ValueError(f"{path}: {error}")
