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
from ..export.expressions import Surroundings
from ..export.materials import read_material
from ..names import name_of
from ..rendering import Bounces, leave_plain, set_threads
from ..report import ExportReport
from ..serving import SceneError
from .request import Request

DEFAULT_LONGER_SIDE = 512
FEW_PIXELS = 16
# Rays that find an object in their way, other than the camera's.
LIGHT_RAYS = ("visible_diffuse", "visible_glossy", "visible_shadow")


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


def prepare(scene: Any, request: Request) -> None:
    """Settings that all renders share: frame, lamps, size, filter, bounces, and nothing after the renderer."""
    if request.frame is not None:
        scene.frame_set(request.frame)
    if request.lights is not None:
        _leave_only(scene, request.lights)
    render = scene.render
    render.resolution_x, render.resolution_y = request.size or _default_size(render)
    render.resolution_percentage = 100
    render.use_border = False
    set_threads(render, request.threads)
    scene.cycles.pixel_filter_type = "BOX"  # both engines read it
    if request.max_bounces is not None:
        scene.shlight.max_bounces = request.max_bounces
    leave_plain(render)


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


def use_shlight(scene: Any, request: Request) -> None:
    """The next render is shlight's, with the scene's settings and what the command line changes of them."""
    scene.render.engine = "SHLIGHT"
    settings = scene.shlight
    if request.order is not None:
        settings.order = request.order
    if request.tolerance is not None:
        settings.tolerance = request.tolerance
    if request.pixel_samples is not None:
        settings.pixel_samples = request.pixel_samples
    if request.shadow_rays is not None:
        settings.use_shadows = request.shadow_rays > 0
        settings.shadow_rays = max(request.shadow_rays, 1)


def bounces_of(scene: Any) -> Bounces:
    """The bounces that shlight renders."""
    settings = scene.shlight
    return settings.max_bounces, settings.glossy_bounces, settings.transmission_bounces


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
