# SPDX-License-Identifier: GPL-3.0-or-later
"""Opening a scene in Blender and setting up its renders."""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy

from .. import register as register_addon
from ..compat import set_sample_range
from ..export.expressions import Surroundings
from ..export.materials import read_material
from ..names import name_of
from ..report import ExportReport
from .options import RenderOptions

DEFAULT_LONGER_SIDE = 512
FEW_PIXELS = 16
# Rays that find an object in their way, other than the camera's.
LIGHT_RAYS = ("visible_diffuse", "visible_glossy", "visible_shadow")


class SceneError(Exception):
    """The scene cannot be opened or has nothing to render; the message is for the user."""


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


def prepare(scene: Any, options: RenderOptions) -> None:
    """Settings that all renders share: frame, lamps, size, filter, bounces, and nothing after the renderer."""
    if options.frame is not None:
        scene.frame_set(options.frame)
    if options.lights is not None:
        _leave_only(scene, options.lights)
    render = scene.render
    render.resolution_x, render.resolution_y = options.size or _default_size(render)
    render.resolution_percentage = 100
    render.use_border = False
    render.threads_mode = "FIXED" if options.threads else "AUTO"
    if options.threads:
        render.threads = options.threads
    scene.cycles.pixel_filter_type = "BOX"  # both engines read it
    if options.max_bounces is not None:
        scene.shlight.max_bounces = options.max_bounces
    leave_plain(render)


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


def _leave_only(scene: Any, names: list[str]) -> None:
    """Switches off all lamps but these."""
    lamps = {seen.name: seen for seen in scene.objects if seen.type == "LIGHT"}
    for name in names:
        if name not in lamps:
            raise SceneError(f"there is no lamp '{name}' in it, but {', '.join(lamps) or 'none'}")
    for name, lamp in lamps.items():
        lamp.hide_render = name not in names


def _default_size(render: Any) -> tuple[int, int]:
    scale = DEFAULT_LONGER_SIDE / max(render.resolution_x, render.resolution_y)
    return max(1, round(render.resolution_x * scale)), max(1, round(render.resolution_y * scale))


def use_shlight(scene: Any, options: RenderOptions) -> None:
    """The next render is shlight's, with the scene's settings and what the command line changes of them."""
    scene.render.engine = "SHLIGHT"
    settings = scene.shlight
    if options.order is not None:
        settings.order = options.order
    if options.tolerance is not None:
        settings.tolerance = options.tolerance
    if options.pixel_samples is not None:
        settings.pixel_samples = options.pixel_samples
    if options.shadow_rays is not None:
        settings.use_shadows = options.shadow_rays > 0
        settings.shadow_rays = max(options.shadow_rays, 1)


@contextmanager
def few_pixels(render: Any, longer_side: int = FEW_PIXELS) -> Iterator[None]:
    """Meanwhile renders are of this many pixels on the longer side."""
    size = render.resolution_x, render.resolution_y
    render.resolution_x, render.resolution_y = (max(1, longer_side * side // max(size)) for side in size)
    try:
        yield
    finally:
        render.resolution_x, render.resolution_y = size


@contextmanager
def without_shadows() -> Iterator[None]:
    """Meanwhile surfaces that do not glow are seen by the camera alone, and no light that Cycles follows meets them."""
    surfaces = [seen for seen in bpy.data.objects if seen.type != "LIGHT" and not _glows(seen)]
    before = [(seen, flag, getattr(seen, flag)) for seen in surfaces for flag in LIGHT_RAYS]
    for seen, flag, _ in before:
        setattr(seen, flag, False)
    try:
        yield
    finally:
        for seen, flag, value in before:
            setattr(seen, flag, value)


def _glows(seen: Any) -> bool:
    materials = (slot.material for slot in seen.material_slots)
    return any(read_material(material, ExportReport(), Surroundings()).emits() for material in materials)


def use_cycles(
    scene: Any, samples: int, seed: int, *, first: int = 0, of: int | None = None, denoise: bool = False
) -> None:
    """The next render is Cycles': as many bounces as shlight's of each kind, and nothing that trades truth for calm.

    The samples are those from number `first` on of a sequence of `of` (by default of `samples`). SceneError where it is
    to be denoised and this Blender has no denoiser.
    """
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    set_sample_range(cycles, first, samples, of or samples)
    cycles.seed = seed
    cycles.use_animated_seed = False
    cycles.time_limit = 0.0
    most = scene.shlight.max_bounces
    cycles.max_bounces = cycles.diffuse_bounces = most
    cycles.glossy_bounces = min(scene.shlight.glossy_bounces, most)
    cycles.transmission_bounces = min(scene.shlight.transmission_bounces, most)
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_fast_gi = False
    cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = 0.0
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
    """Chooses OpenImageDenoise; SceneError where Blender is built without it."""
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        raise SceneError("the Cycles of this Blender is built without OpenImageDenoise") from None
