# SPDX-License-Identifier: GPL-3.0-or-later
"""What the latest comparison found, and its pictures as images of Blender."""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..names import name_of
from ..shown_images import Pixels, draw_image, make_image
from ..windows import areas
from .pictures import difference_limit, in_palette

COMPARISON, DIFFERENCE, REFERENCE = "shlight Comparison", "shlight Difference", "shlight Reference"


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
            make_image(name, pixels, last.folder, is_light=name != DIFFERENCE)


def show_split(split: float) -> None:
    """Moves the split of the comparison's image, and saves the image once the split rests."""
    image = bpy.data.images.get(COMPARISON)
    if last is None or image is None:
        return
    draw_image(image, last.split(split))


def remove() -> None:
    """Removes the images and their files, and forgets the figures."""
    for image in _images():
        bpy.data.images.remove(image)
    forget()


def forget() -> None:
    """Forgets the results, as of a file that is closed."""
    global last
    if last is not None:
        shutil.rmtree(last.folder, ignore_errors=True)
    last = None


def _images() -> list[Any]:
    """The images of the latest comparison."""
    if last is None:
        return []
    named = (bpy.data.images.get(name) for name in last.names)
    return [image for image in named if image is not None and image.filepath_raw.startswith(str(last.folder))]


def shown() -> list[tuple[Any, str]]:
    """Areas that show an image of the comparison, and its name."""
    images = _images()
    return [(area, image.name) for area in areas("IMAGE_EDITOR") if (image := area.spaces.active.image) in images]


def show(names: list[tuple[Any, str]]) -> None:
    """Has areas show images again."""
    for area, name in names:
        area.spaces.active.image = bpy.data.images.get(name)
        area.tag_redraw()


def are_of(scene: Any) -> bool:
    """Whether there are results, and of this scene."""
    return last is not None and last.scene == name_of(scene)
