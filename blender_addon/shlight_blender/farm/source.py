# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene file, what decides about its pixels, and its pictures.

A process that only hands it on needs no bpy, whose import changes where processes that it starts look for modules.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from shlight.farm import Rendered

from . import needed_files

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
    key: str
    views: tuple[tuple[str, str], ...]
    size: tuple[int, int]
    messages: tuple[str, ...]

    def render(self, frame: int, view: str, box: Box | None, threads: int) -> Rendered:
        """See Source.render."""
        from .picture import render_picture

        root = needed_files.unpacked(self.key) if self.sent else Path("/")
        needed_files.check(self.files, root)
        scene = self._scene(root)
        scene.render.threads_mode = "FIXED" if threads else "AUTO"
        scene.render.threads = threads or scene.render.threads
        rendered = render_picture(scene, frame, view, box, self.messages)
        needed_files.check(self.files, root)  # one that vanished meanwhile would be magenta in the picture
        return rendered

    def pack(self, folder: Path) -> Path:
        """An archive of all files, for workers that do not see them."""
        return needed_files.packed(self.key, [path for path, _ in self.files], folder)

    def _scene(self, root: Path) -> Any:
        """The open scene; it is opened once in a process."""
        import bpy

        from .opening import apply_settings, open_for_farm, set_size

        global _open_key
        if _open_key != self.key:
            _open_key = ""
            if (versions := _versions()) != self.versions:
                raise RuntimeError(f"the worker has shlight and Blender {versions}, and not {self.versions}")
            path = root / self.path.lstrip("/")
            if needed_files.hash_of(path) != self.file_hash:
                raise RuntimeError(f"{path} is another file where the worker is; --send sends it")
            scene = open_for_farm(path)
            if root != Path("/"):
                needed_files.move_absolute_paths(root)
                self._check_sent(path)
            apply_settings(scene, dict(self.settings))
            set_size(scene.render, self.scale)
            _open_key = self.key
        return bpy.context.scene

    def _check_sent(self, path: Path) -> None:
        """RuntimeError where Blender does not find a file that was sent; it would be magenta in the picture."""
        sent = {Path(name).name for name, _ in self.files}
        lost = [name for name in needed_files.of_open_scene(path)[1] if Path(name).name in sent]
        if lost:
            raise RuntimeError(f"'{lost[0]}' is missing although it was sent")


def describe(path: Path, views: tuple[str, ...], settings: Mapping[str, Any], scale: float, sent: bool) -> SceneFile:
    """Opens it in this process, and finds what it needs. SceneError, ValueError or OSError where that cannot be."""
    from .opening import apply_settings, closed_to_others, open_for_farm, set_size, views_of

    path = Path(os.path.abspath(path))  # noqa: PTH100, symbolic links stay
    scene = open_for_farm(path)
    apply_settings(scene, settings)
    size = set_size(scene.render, scale)
    found, missing = needed_files.of_open_scene(path)
    messages = [*closed_to_others(scene), *(f"File '{name}' is missing" for name in missing)]
    hashes = {os.path.relpath(name, path.parent): needed_files.hash_of(Path(name)) for name in found}
    versions = _versions()
    decisive = [hashes, sorted((name, str(value)) for name, value in settings.items()), scale, versions, missing]
    return SceneFile(
        str(path),
        tuple(settings.items()),
        scale,
        tuple((name, Path(name).stat().st_size) for name in found),
        hashes[path.name],
        versions,
        sent,
        hashlib.sha256(json.dumps(decisive).encode()).hexdigest(),
        views_of(scene, views),
        size,
        tuple(messages),
    )


def _versions() -> tuple[str, str]:
    import bpy

    return metadata.version("shlight"), bpy.app.version_string
