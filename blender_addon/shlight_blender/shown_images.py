# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of Blender that scripts draw, and the areas that show them.

They are files in Blender's temporary folder, which goes with it: Blender would ask for a place for images that are in
no file before it quits.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[np.float32]

SETTLE_SECONDS = 0.5

_unsaved: set[str] = set()  # names of images whose pixels have changed


def rendered_image() -> Any | None:
    """Blender's image of the last render, which a file may have under another name than Render Result."""
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)


def make_image(name: str, pixels: Pixels, folder: Path, *, is_light: bool = True) -> Any:
    """A new image of pixels (height, width, 4), row 0 at the bottom, saved in a folder.

    is_light: they are linear and premultiplied, and shown as renders are; else bytes, shown as they are.
    """
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=is_light, float_buffer=is_light)
    if is_light:
        image.alpha_mode = "PREMUL"
    image.use_view_as_render = is_light
    image.file_format = "OPEN_EXR" if is_light else "PNG"
    image.filepath_raw = str(folder / name) + (".exr" if is_light else ".png")
    _write(image, pixels)
    image.save()
    return image


def draw_image(image: Any, pixels: Pixels) -> None:
    """Gives an image other pixels, and saves it once they rest."""
    _write(image, pixels)
    _unsaved.add(image.name)
    if bpy.app.timers.is_registered(_settle):
        bpy.app.timers.unregister(_settle)
    bpy.app.timers.register(_settle, first_interval=SETTLE_SECONDS)


def _write(image: Any, pixels: Pixels) -> None:
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.update()


def _settle() -> None:
    """Saves what is still there."""
    while _unsaved:
        if (image := bpy.data.images.get(_unsaved.pop())) is not None:
            image.save()
