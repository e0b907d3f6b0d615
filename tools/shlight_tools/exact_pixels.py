# SPDX-License-Identifier: MIT
"""Pictures of Cycles by one ray through the middle of each pixel, for what has no noise; it needs bpy."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from numpy.typing import NDArray

from shlight.images import read_exr


def empty_scene(width: int, height: int) -> bpy.types.Scene:
    """A scene of a file without anything, whose camera is to be added."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="cycles")
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01
    return scene


def picture(scene: bpy.types.Scene) -> NDArray[np.float64]:
    """The colours (height, width, 3), row 0 on top."""
    with TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return read_exr(scene.render.filepath)[..., :3].astype(np.float64)
