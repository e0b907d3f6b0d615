# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene opened for final renders that write no file but the picture's, and a frame or a tile of one."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight.farm import Rendered
from shlight.images import image_parts
from shlight.quiet import quiet

from .. import record
from ..background import kept, leave_plain, open_scene
from ..compat import choose_layers, compositing_nodes
from ..frame import Frame, frame_of
from ..names import name_of, one_line
from ..passes import layer_passes
from ..running import ENGINE
from ..worker_process import SceneError

NUMBERS = {"FLOAT": float, "INT": int}
FLAGS = {"1": True, "true": True, "on": True, "0": False, "false": False, "off": False}


def open_for_farm(path: Path) -> Any:
    """Opens a Blender file, whose own scripts do not run, or runs a script with build_scene()."""
    bpy.app.handlers.load_post.append(_close_caches)  # Blender evaluates the scene before it returns
    try:
        with quiet():
            scene = open_scene(path)
    finally:
        bpy.app.handlers.load_post.remove(_close_caches)
    bpy.context.window.scene = scene
    bpy.ops.preferences.addon_enable(module="cycles")  # the pixel filter is one of its settings
    render = scene.render
    render.engine = ENGINE
    render.use_crop_to_border = True
    return scene


@bpy.app.handlers.persistent
def _close_caches(*_: Any) -> None:
    """Simulations that are not baked write no files; those of fluids cannot be had without."""
    for modifier in _replayed_fluids().values():
        modifier.show_viewport = modifier.show_render = False
    owners = [modifier for seen in bpy.data.objects for modifier in seen.modifiers]
    owners += [system for seen in bpy.data.objects for system in seen.particle_systems]
    owners += [scene.rigidbody_world for scene in bpy.data.scenes if scene.rigidbody_world]
    for owner in owners:
        cache = getattr(owner, "point_cache", None)
        if cache is not None and cache.use_disk_cache and not cache.is_baked:
            cache.use_disk_cache = False


def _replayed_fluids() -> dict[str, Any]:
    """Modifiers by their objects' names."""
    fluids = [(seen.name, each) for seen in bpy.data.objects for each in seen.modifiers if each.type == "FLUID"]
    return {
        name: each
        for name, each in fluids
        if each.fluid_type == "DOMAIN" and each.domain_settings.cache_type == "REPLAY"
    }


def closed_to_others(scene: Any) -> list[str]:
    """Descriptions of the file's post-processing that is not done."""
    render, left_out = scene.render, []
    if render.use_compositing and compositing_nodes(scene) is not None:
        left_out.append("compositing is left out; do it with the files")
    editor = scene.sequence_editor
    if render.use_sequencer and (getattr(editor, "strips", None) or getattr(editor, "sequences", None)):
        left_out.append("the sequencer is left out")
    left_out += [f"the fluid of '{name}' is left out; it is replayed, and not baked" for name in _replayed_fluids()]
    return [f"Scene '{name_of(scene)}': {text}" for text in left_out]


def apply_settings(scene: Any, settings: Mapping[str, Any]) -> None:
    """Sets properties by their path from the scene, "shlight.noise_threshold" for instance; ValueError if it cannot."""
    for path, value in settings.items():
        owner_path, _, name = path.rpartition(".")
        try:
            owner = scene.path_resolve(owner_path) if owner_path else scene
            rule = owner.bl_rna.properties[name]
        except (ValueError, KeyError, AttributeError):
            raise ValueError(f"set: the scene has no property '{path}'") from None
        if rule.is_readonly or rule.type not in {*NUMBERS, "BOOLEAN", "ENUM", "STRING"}:
            raise ValueError(f"set: '{path}' cannot be set")
        setattr(owner, name, _value_of(path, value, rule))


def _value_of(path: str, value: Any, rule: Any) -> Any:
    """What is given as the property wants it."""
    try:
        if rule.type in NUMBERS and not getattr(rule, "is_array", False):
            number = NUMBERS[rule.type](value)
            if not rule.hard_min <= number <= rule.hard_max:
                raise ValueError(f"set: {path} must be {rule.hard_min:g} … {rule.hard_max:g}, got {value}")
            return number
        if rule.type == "BOOLEAN":
            return FLAGS[str(value).lower()]
        if rule.type == "ENUM" and str(value) not in rule.enum_items:
            raise ValueError(f"set: {path} must be one of {', '.join(rule.enum_items.keys())}, got {value}")
    except (KeyError, TypeError, ValueError) as error:
        if str(error).startswith("set: "):
            raise
        raise ValueError(f"set: {path} cannot be {value!r}") from None
    return str(value)


def set_size(render: Any, scale: float) -> tuple[int, int]:
    """Scales the picture; width and height of what is rendered of it."""
    for axis in ("resolution_x", "resolution_y"):
        full = getattr(render, axis) * render.resolution_percentage / 100
        setattr(render, axis, max(4, round(full * scale)))  # Blender has no smaller ones
    render.resolution_percentage = 100
    frame = frame_of(render)
    return frame.width, frame.height


def views_of(scene: Any, wanted: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    """Names of views or cameras, and what is added to files' names; nothing of a file gets into those as it is."""
    render = scene.render
    if render.use_multiview:
        suffixes = {view.name: view.file_suffix for view in render.views if view.use}
        chosen = wanted or tuple(suffixes)
    else:
        suffixes = {seen.name: f"_{seen.name}" for seen in scene.objects if seen.type == "CAMERA"}
        chosen = wanted or ("",)
    for name in chosen:
        if name and name not in suffixes:
            raise SceneError(f"there is no view or camera '{name}' in it, but {', '.join(suffixes) or 'none'}")
    views = tuple((name, re.sub(r"[^\w.-]", "_", suffixes[name]) if name else "") for name in dict.fromkeys(chosen))
    if len({suffix for _, suffix in views}) < len(views):
        raise SceneError("views have the same suffix for their files")
    return views


Box = tuple[int, int, int, int]

KEPT_ATTRIBUTES = "cryptomatte/"
# Settings that a picture changes, and that the next must find as they were.
CHANGED = ("use_multiview", "use_border", "border_min_x", "border_max_x", "border_min_y", "border_max_y", "filepath")


def render_picture(
    scene: Any, frame: int, view: str, box: Box | None, for_display: bool, messages: tuple[str, ...]
) -> Rendered:
    """The channels that Blender would write; a file without passes has RGBA.

    for_display: RGB with the scene's view transform, 0 … 1, and alpha where the film is transparent.
    """
    scene.frame_set(frame)
    render = scene.render
    with (
        tempfile.TemporaryDirectory(prefix="shlight-") as folder,
        kept([render], *CHANGED),
        kept(render.views, "use", "file_suffix"),
    ):
        try:
            _set_up(scene, view, box, for_display, Path(folder))
            with quiet():
                bpy.ops.render.render(write_still=True)
        except RuntimeError as error:  # how Blender's operators fail
            raise RuntimeError(record.last.scene_error or one_line(error)) from None
        (path,) = Path(folder).iterdir()
        channels, pixels, attributes = _read(path)
    return Rendered(channels, pixels, attributes, (*messages, *record.last.report.lines()))


def _set_up(scene: Any, view: str, box: Box | None, for_display: bool, folder: Path) -> None:
    """One view, one tile, and one file in a folder."""
    render = scene.render
    multiview = render.use_multiview
    leave_plain(render)
    render.use_multiview = multiview
    _choose_format(scene, for_display)
    if multiview:
        render.image_settings.views_format = "INDIVIDUAL"
        for number, other in enumerate(render.views):
            other.use = other.name == view
            other.file_suffix = f"_{number}"  # what the file gives may lead out of the folder
    elif view:
        scene.camera = scene.objects[view]
    if box is not None:
        _set_border(render, frame_of(render), box)
    render.use_file_extension = True
    render.filepath = str(folder / "picture")


def _choose_format(scene: Any, for_display: bool) -> None:
    """PNG for display, else OpenEXR with a layer of the file for each pass, where there are more than one."""
    if for_display:
        settings = scene.render.image_settings
        settings.file_format = "PNG"
        settings.color_mode = "RGBA" if scene.render.film_transparent else "RGB"
        settings.color_depth = "8"
        return
    layers = [layer for layer in scene.view_layers if layer.use]
    if len(layers) > 1 or any(layer_passes(scene, layer) for layer in layers):
        choose_layers(scene.render.image_settings)


def _set_border(render: Any, whole: Frame, box: Box) -> None:
    """Edges lie in the middle of pixels: Blender multiplies in single precision, and cuts off."""
    left, top, right, bottom = box
    render.use_border = True
    render.border_min_x = (whole.left + left + 0.5) / whole.full_width
    render.border_max_x = (whole.left + right + 0.5) / whole.full_width
    render.border_min_y = (whole.top - bottom + 0.5) / whole.full_height
    render.border_max_y = (whole.top - top + 0.5) / whole.full_height


def _read(path: Path) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    """Channels of all parts of a file."""
    parts = list(image_parts(path, associate=False))
    kept_of = [each for spec, _ in parts for each in spec.extra_attribs if each.name.startswith(KEPT_ATTRIBUTES)]
    names = tuple(name for spec, _ in parts for name in spec.channelnames)
    pixels = np.concatenate([channels for _, channels in parts], axis=2)
    return names, pixels, {each.name: str(each.value) for each in kept_of}
