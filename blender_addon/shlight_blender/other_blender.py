# SPDX-License-Identifier: GPL-3.0-or-later
"""A second Blender in the background, of the same program, or of the Python that has the module bpy."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import bpy
import numpy as np

START = Path(__file__).with_name("start.py")


def command(worker: str) -> list[str]:
    """How it is started to run main() of a module of the add-on, such as "export.bake_worker"."""
    arguments = [str(START), "--", __package__, os.pathsep.join(folder for folder in sys.path if folder), worker]
    if bpy.app.binary_path:
        options = ["--background", "--factory-startup", "--python-exit-code", "1", "--python"]
        return [bpy.app.binary_path, *options, *arguments]
    return [sys.executable, *arguments]


def environment() -> dict[str, str]:
    """The other Python finds the modules of this one, except Blender's own: their bpy is not the one to start with."""
    if bpy.app.binary_path:
        return dict(os.environ)
    scripts = bpy.utils.system_resource("SCRIPTS")
    return os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p and not p.startswith(scripts))}


def save_unsaved_images(images: Iterable[Any], folder: Path) -> dict[str, str]:
    """Names of the images whose changes are in no file, and of the files in `folder` with their pixels."""
    files = {}
    for number, image in enumerate(image for image in images if image.is_dirty):
        pixels = np.empty(len(image.pixels), dtype=np.float32)
        image.pixels.foreach_get(pixels)
        files[image.name] = f"image_{number}.npy"
        np.save(folder / files[image.name], pixels)
    return files


def load_unsaved_images(files: dict[str, str], folder: Path) -> None:
    """Gives the images of the file that is open the pixels that `save_unsaved_images` has written."""
    for name, file in files.items():
        bpy.data.images[name].pixels.foreach_set(np.load(folder / file))
