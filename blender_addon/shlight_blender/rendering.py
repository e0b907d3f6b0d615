# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders whose pictures are handed out as they are, and Cycles as a reference: nothing trades truth for calm."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import numpy.typing as npt

from .compat import set_sample_range

Bounces = tuple[int, int, int]  # at most in all, on glossy surfaces, and through surfaces


def use_cycles(
    scene: Any, samples: int, seed: int, bounces: Bounces, *, first: int = 0, of: int = 0, denoise: bool = False
) -> None:
    """The next render of the scene is Cycles'.

    The samples are those from number `first` on of a sequence of `of` (0: of `samples`). RuntimeError where it is to be
    denoised and this Blender has no denoiser.
    """
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    set_sample_range(cycles, first, samples, of or samples)
    cycles.seed = seed
    cycles.use_animated_seed = False
    cycles.time_limit = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = bounces[0]
    cycles.glossy_bounces, cycles.transmission_bounces = (min(bounces[0], most) for most in bounces[1:])
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_fast_gi = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = denoise
    if denoise:
        use_denoiser(cycles)
    cycles.use_guiding = False
    for layer in scene.view_layers:
        layer.samples = 0  # 0: the scene's number


def use_denoiser(cycles: Any) -> None:
    """Chooses OpenImageDenoise; RuntimeError where Blender is built without it."""
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        raise RuntimeError("the Cycles of this Blender is built without OpenImageDenoise") from None


def set_threads(render: Any, threads: int) -> None:
    """threads: 0 for one on each core."""
    render.threads_mode = "FIXED" if threads else "AUTO"
    if threads:
        render.threads = threads


def leave_plain(render: Any) -> None:
    """One picture with nothing after the renderer, saved as it is."""
    render.use_multiview = False
    render.use_compositing = False
    render.use_sequencer = False
    render.use_stamp = False
    # Each render exports the scene anew: that is part of its time, and Cycles would go on with its old settings.
    render.use_persistent_data = False
    image = render.image_settings
    image.color_management = "FOLLOW_SCENE"
    image.file_format = "OPEN_EXR"
    image.color_mode = "RGBA"
    image.color_depth = "32"


def last_picture(scene: Any, path: Path) -> npt.NDArray[np.float32]:
    """The picture of the last render (height, width, 4), row 0 on top, by way of a file: Blender knows no other."""
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    image = bpy.data.images.load(str(path), check_existing=False)
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return np.ascontiguousarray(pixels.reshape(height, width, 4)[::-1])
