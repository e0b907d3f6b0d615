# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a scene needs: which they are, whether they are still there, and how they get to other machines."""

from __future__ import annotations

import hashlib
import os
import re
import sys
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from shlight.farm import tasks

WITH_PATHS = ("libraries", "images", "fonts", "sounds", "movieclips", "volumes", "cache_files")


def of_open_scene(path: Path) -> tuple[list[str], list[str]]:
    """The scene's own file and what Blender has read for it; those that are missing. Absolute paths, sorted."""
    import bpy

    paths = {_absolute(name) for name in bpy.utils.blend_paths(absolute=True)}
    for image in bpy.data.images:
        if image.source in {"SEQUENCE", "TILED"} and image.filepath:
            paths.discard(named := _absolute(image.filepath, image.library))
            paths.update(_siblings(named))
    if path.suffix == ".py":
        modules = {name: getattr(module, "__file__", None) for name, module in list(sys.modules.items())}
        own = (_absolute(file) for name, file in modules.items() if file and not name.endswith("main__"))
        paths.update(file for file in own if file.parent == path.parent and file.is_file())
    found = sorted(str(name) for name in {path, *paths} if name.is_file())
    return found, sorted(str(name) for name in paths if not name.exists())


def _absolute(name: str, library: Any = None) -> Path:
    """Symbolic links stay, so that it is found again under the name that the scene gives it."""
    import bpy

    return Path(os.path.abspath(bpy.path.abspath(name, library=library)))  # noqa: PTH100


def _siblings(path: Path) -> Iterable[Path]:
    """The pictures of a sequence, or the tiles of an image."""
    shape = re.sub(r"\d+|<UDIM>|<UVTILE>", "\0", path.stem)
    return [
        other
        for other in (path.parent.iterdir() if path.parent.is_dir() else ())
        if other.suffix == path.suffix and re.sub(r"\d+", "\0", other.stem) == re.sub("\0_u.*_v.*", "\0", shape)
    ]


def check(files: Iterable[tuple[str, int]], root: Path) -> None:
    """Raises OSError for a file that is not there any more, or has another size."""
    for name, size in files:
        path = root / name.lstrip("/")
        try:
            found = path.stat().st_size
        except OSError:
            raise FileNotFoundError(f"{path} is not there; --send sends files to workers") from None
        if found != size:
            raise OSError(f"{path} has changed")


def hash_of(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def packed(key: str, paths: Iterable[str], folder: Path) -> Path:
    """An archive of files under their absolute paths."""
    archive = folder / f"shlight-{key}.bin"
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as target:
        for path in paths:
            target.write(path, path.lstrip("/"))
    return archive


def unpacked(key: str) -> Path:
    """The folder on a worker that stands for the root of the sender's files; made once."""
    archive = tasks.received_files / f"shlight-{key}.bin"
    folder = archive.with_suffix("")
    if not folder.is_dir():
        partial = archive.with_suffix(".partial")
        with zipfile.ZipFile(archive) as source:
            source.extractall(partial)  # no name leads out of the folder
        partial.rename(folder)
    return folder


def move_absolute_paths(root: Path) -> None:
    """Paths of the open file that are absolute lead below `root` from now on; relative ones do so anyway."""
    import bpy

    for name in WITH_PATHS:
        for item in getattr(bpy.data, name, ()):
            moved = root / item.filepath.lstrip("/")
            if item.filepath.startswith("/") and not item.filepath.startswith("//") and moved.is_file():
                item.filepath = str(moved)
                if name == "libraries":
                    item.reload()
