# SPDX-License-Identifier: GPL-3.0-or-later
"""A second Blender in the background: how it is started, and how it opens scenes and renders.

It is of the same program, or of the Python that has the module bpy. Pictures are handed out as they are, and in Cycles
as a reference nothing trades truth for calm.
"""

from __future__ import annotations

import os
import runpy
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import numpy.typing as npt

from . import register as register_addon
from .compat import pixels_of, set_sample_range
from .names import name_of
from .shown_images import rendered_image
from .worker_process import SceneError

START = Path(__file__).with_name("start.py")


def command(worker: str) -> list[str]:
    """How it is started to run main() of a module of the add-on, such as "compare.render"."""
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
        files[image.name] = f"image_{number}.npy"
        np.save(folder / files[image.name], pixels_of(image)[::-1].ravel())
    return files


def load_unsaved_images(files: dict[str, str], folder: Path) -> None:
    """Gives the images of the file that is open the pixels that `save_unsaved_images` has written."""
    for name, file in files.items():
        bpy.data.images[name].pixels.foreach_set(np.load(folder / file))


Bounces = tuple[int, int, int]  # at most in all, on glossy surfaces, and through surfaces
FEW_PIXELS = 16


def open_scene(path: Path) -> Any:
    """Opens a Blender file, or runs the function build_scene() of a Python script, and returns the scene.

    The add-on is registered before, since a script may choose the engine and set its properties.
    """
    register_addon()
    scene = _build(path) if path.suffix == ".py" else open_blend(path)
    if scene is None:
        raise SceneError("there is no scene in it")
    if scene.camera is None:
        raise SceneError(f"scene '{name_of(scene)}' has no camera")
    return scene


def _build(script: Path) -> Any:
    try:
        names = runpy.run_path(str(script))
        if "build_scene" not in names:
            raise SceneError("there is no function build_scene() in it")
        return names["build_scene"]()
    except (Exception, SystemExit) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"{type(error).__name__}: {' '.join(str(error).split())}") from error


def open_blend(path: Path, *, use_scripts: bool = False) -> Any:
    """Opens a Blender file and returns its scene."""
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False, use_scripts=use_scripts)
    except RuntimeError as error:
        raise SceneError(_reason(error)) from error
    return bpy.context.scene


def _reason(error: RuntimeError) -> str:
    """Blender's own words without the file's name, which Blender puts before them, in quotation marks."""
    line = str(error).strip().splitlines()[0]
    words = line.removeprefix("Error: ").split('" failed: ')[-1].split("': ")[-1]
    return f"Blender cannot read it ({words.split(' in file ')[0]})"


@contextmanager
def kept(owners: Iterable[Any], *names: str) -> Iterator[None]:
    """In the end properties of owners have the values again that they have now."""
    before = [(owner, name, getattr(owner, name)) for owner in owners for name in names]
    try:
        yield
    finally:
        for owner, name, value in before:
            setattr(owner, name, value)


@contextmanager
def few_pixels(render: Any, longer_side: int = FEW_PIXELS) -> Iterator[None]:
    """Meanwhile renders are of this many pixels on the longer side."""
    size = render.resolution_x, render.resolution_y
    with kept([render], "resolution_x", "resolution_y"):
        render.resolution_x, render.resolution_y = (max(1, longer_side * side // max(size)) for side in size)
        yield


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
    cycles.sample_clamp_direct = 0.0
    cycles.light_sampling_threshold = 0.0
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
    rendered = rendered_image()
    assert rendered is not None
    rendered.save_render(str(path), scene=scene)
    image = bpy.data.images.load(str(path), check_existing=False)
    pixels = np.ascontiguousarray(pixels_of(image))
    bpy.data.images.remove(image)
    return pixels
