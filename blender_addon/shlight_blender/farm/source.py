# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene file, the files that it needs, what decides about its pixels, and its pictures.

A process that only hands it on needs no bpy, whose import changes where processes that it starts look for modules.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from shlight.farm import Rendered, tasks

WITH_PATHS = ("libraries", "images", "fonts", "sounds", "movieclips", "volumes", "cache_files")


def of_open_scene(path: Path) -> tuple[list[str], list[str]]:
    """The scene's own file and what Blender has read for it; those that are missing. Absolute paths, sorted."""
    import bpy

    from ..export.materials import measured_path

    paths = {_absolute(name) for name in bpy.utils.blend_paths(absolute=True)}
    measured = (measured_path(material) for material in bpy.data.materials)
    paths.update(_absolute(str(path)) for path in measured if path is not None)
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

    owners = [(item, "filepath") for name in WITH_PATHS for item in getattr(bpy.data, name, ())]
    owners += [(material.shlight, "measured_file") for material in bpy.data.materials]
    for owner, name in owners:
        path = getattr(owner, name)
        moved = root / path.lstrip("/")
        if path.startswith("/") and not path.startswith("//") and moved.is_file():
            setattr(owner, name, str(moved))
            if isinstance(owner, bpy.types.Library):
                owner.reload()


Box = tuple[int, int, int, int]

_open_key = ""  # of the source whose scene is open in this process


@dataclass(frozen=True)
class SceneFile:
    """A `shlight.farm.Source`; files: sizes of the scene and all that it needs, by absolute path."""

    path: str
    settings: tuple[tuple[str, Any], ...]
    scale: float
    files: tuple[tuple[str, int], ...]
    file_hash: str  # of the scene alone
    versions: tuple[str, str]  # of shlight and Blender
    sent: bool
    for_display: bool  # as PNG, with the scene's view transform
    key: str
    frame: int
    views: tuple[tuple[str, str], ...]
    size: tuple[int, int]
    messages: tuple[str, ...]

    def render(self, frame: int, view: str, box: Box | None, threads: int) -> Rendered:
        """See Source.render."""
        from ..background import set_threads
        from .picture import render_picture

        root = unpacked(self.key) if self.sent else Path("/")
        check(self.files, root)
        scene = self._scene(root)
        set_threads(scene.render, threads)
        rendered = render_picture(scene, frame, view, box, self.for_display, self.messages)
        check(self.files, root)  # one that vanished meanwhile would be magenta in the picture
        return rendered

    def pack(self, folder: Path) -> Path:
        """An archive of all files, for workers that do not see them."""
        return packed(self.key, [path for path, _ in self.files], folder)

    def _scene(self, root: Path) -> Any:
        """The open scene; it is opened once in a process."""
        import bpy

        from .picture import apply_settings, open_for_farm, set_size

        global _open_key
        if _open_key != self.key:
            _open_key = ""
            if (versions := _versions()) != self.versions:
                raise RuntimeError(f"the worker has shlight and Blender {versions}, and not {self.versions}")
            path = root / self.path.lstrip("/")
            if hash_of(path) != self.file_hash:
                raise RuntimeError(f"{path} is another file where the worker is; --send sends it")
            scene = open_for_farm(path)
            if root != Path("/"):
                move_absolute_paths(root)
                self._check_sent(path)
            apply_settings(scene, dict(self.settings))
            set_size(scene.render, self.scale)
            _open_key = self.key
        return bpy.context.scene

    def _check_sent(self, path: Path) -> None:
        """RuntimeError where Blender does not find a file that was sent; it would be magenta in the picture."""
        sent = {Path(name).name for name, _ in self.files}
        lost = [name for name in of_open_scene(path)[1] if Path(name).name in sent]
        if lost:
            raise RuntimeError(f"'{lost[0]}' is missing although it was sent")


def describe(
    path: Path, views: tuple[str, ...], settings: Mapping[str, Any], scale: float, sent: bool, for_display: bool
) -> SceneFile:
    """Opens it in this process, and finds what it needs. SceneError, ValueError or OSError where that cannot be."""
    from .picture import apply_settings, closed_to_others, open_for_farm, set_size, views_of

    path = Path(os.path.abspath(path))  # noqa: PTH100, symbolic links stay
    scene = open_for_farm(path)
    apply_settings(scene, settings)
    size = set_size(scene.render, scale)
    found, missing = of_open_scene(path)
    messages = [*closed_to_others(scene), *(f"File '{name}' is missing" for name in missing)]
    hashes = {os.path.relpath(name, path.parent): hash_of(Path(name)) for name in found}
    versions = _versions()
    set_values = sorted((name, str(value)) for name, value in settings.items())
    decisive = [hashes, set_values, scale, versions, missing, for_display]
    return SceneFile(
        str(path),
        tuple(settings.items()),
        scale,
        tuple((name, Path(name).stat().st_size) for name in found),
        hashes[path.name],
        versions,
        sent,
        for_display,
        hashlib.sha256(json.dumps(decisive).encode()).hexdigest(),
        max(scene.frame_current, 0),
        views_of(scene, views),
        size,
        tuple(messages),
    )


def _versions() -> tuple[str, str]:
    import bpy

    return metadata.version("shlight"), bpy.app.version_string
