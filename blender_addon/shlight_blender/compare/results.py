# SPDX-License-Identifier: GPL-3.0-or-later
"""What the latest comparison found, and its pictures as images of Blender.

The images are files in Blender's temporary folder, which goes with it: Blender would ask for a place for images that
are in no file before it quits.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import numpy.typing as npt

from ..names import name_of
from .pictures import difference_limit, in_palette

COMPARISON, DIFFERENCE, REFERENCE = "shlight Comparison", "shlight Difference", "shlight Reference"
SETTLE_SECONDS = 0.5

Pixels = npt.NDArray[np.float32]


@dataclass
class Results:
    """Figures as the worker sends them; pictures (height, width, 4), row 0 at the bottom."""

    scene: str  # its name
    figures: dict[str, Any]
    folder: Path  # of the images' files
    shlight: Pixels
    cycles: Pixels
    difference: Pixels  # (height, width), relative
    reference: Pixels | None = None

    def __post_init__(self) -> None:
        self.limit = difference_limit(self.difference.astype(np.float64))  # [%], at the ends of the palette

    @property
    def names(self) -> list[str]:
        """The names of the comparison's images."""
        return [COMPARISON, DIFFERENCE, *([] if self.reference is None else [REFERENCE])]

    def pictures(self, split: float) -> dict[str, Pixels]:
        """Pixels of the images by their names."""
        pictures = (self.split(split), in_palette(100 * self.difference / self.limit), self.reference)
        return {name: picture for name, picture in zip(self.names, pictures, strict=False) if picture is not None}

    def split(self, split: float) -> Pixels:
        """shlight's columns up to this share of the width, and Cycles' from there on."""
        column = round(split * self.shlight.shape[1])
        return np.concatenate([self.shlight[:, :column], self.cycles[:, column:]], axis=1)


last: Results | None = None


def load(folder: Path, figures: dict[str, Any], scene: str) -> None:
    """Takes over what the worker has left in `folder`, in place of the results before. OSError, RuntimeError."""
    global last
    names = ["shlight", "cycles_same_time", "difference", *(["reference"] if "reference" in figures else [])]
    arrays = [np.load(folder / f"{name}.npy")[::-1] for name in names]
    before = shown()
    remove()
    last = Results(
        scene, figures, Path(tempfile.mkdtemp(prefix="shlight_results_", dir=bpy.app.tempdir or None)), *arrays
    )
    make_images()
    show(before)


def make_images() -> None:
    """Makes those images that are not there."""
    if last is None:
        return
    for name, pixels in last.pictures(bpy.context.window_manager.shlight_compare.split).items():
        if bpy.data.images.get(name) is None:
            _make_image(name, pixels, last.folder)


def _make_image(name: str, pixels: Pixels, folder: Path) -> None:
    height, width = pixels.shape[:2]
    is_light = name != DIFFERENCE  # whose bytes are shown as they are
    image = bpy.data.images.new(name, width, height, alpha=is_light, float_buffer=is_light)
    if is_light:
        image.alpha_mode = "PREMUL"
    image.use_view_as_render = is_light
    image.file_format = "OPEN_EXR" if is_light else "PNG"
    image.filepath_raw = str(folder / name) + (".exr" if is_light else ".png")
    _write(image, pixels)
    image.save()


def _write(image: Any, pixels: Pixels) -> None:
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.update()


def show_split(split: float) -> None:
    """Moves the split of the comparison's image, and saves the image once the split rests."""
    image = bpy.data.images.get(COMPARISON)
    if last is None or image is None:
        return
    _write(image, last.split(split))
    if bpy.app.timers.is_registered(_settle):
        bpy.app.timers.unregister(_settle)
    bpy.app.timers.register(_settle, first_interval=SETTLE_SECONDS)


def _settle() -> None:
    image = bpy.data.images.get(COMPARISON)
    if last is not None and image is not None:
        image.save()


def remove() -> None:
    """Removes the images and their files, and forgets the figures."""
    for image in _images():
        bpy.data.images.remove(image)
    forget()


def forget() -> None:
    """Forgets the results, as of a file that is closed."""
    global last
    if bpy.app.timers.is_registered(_settle):
        bpy.app.timers.unregister(_settle)
    if last is not None:
        shutil.rmtree(last.folder, ignore_errors=True)
    last = None


def _images() -> list[Any]:
    """The images of the latest comparison."""
    if last is None:
        return []
    named = (bpy.data.images.get(name) for name in last.names)
    return [image for image in named if image is not None and image.filepath_raw.startswith(str(last.folder))]


def image_editors() -> list[Any]:
    """Areas of all windows."""
    windows = bpy.context.window_manager.windows
    return [area for window in windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]


def shown() -> list[tuple[Any, str]]:
    """Areas that show an image of the comparison, and its name."""
    images = _images()
    return [(area, image.name) for area in image_editors() if (image := area.spaces.active.image) in images]


def show(names: list[tuple[Any, str]]) -> None:
    """Has areas show images again."""
    for area, name in names:
        area.spaces.active.image = bpy.data.images.get(name)
        area.tag_redraw()


def are_of(scene: Any) -> bool:
    """Whether there are results, and of this scene."""
    return last is not None and last.scene == name_of(scene)
