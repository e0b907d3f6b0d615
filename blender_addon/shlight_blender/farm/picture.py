# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame or a tile of one, as Blender renders it with shlight."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight.farm import Rendered
from shlight.quiet import quiet

from .. import record
from ..background import leave_plain
from ..compat import choose_layers
from ..frame import Frame, frame_of
from ..names import one_line
from ..passes import layer_passes

Box = tuple[int, int, int, int]

KEPT_ATTRIBUTES = "cryptomatte/"


def render_picture(scene: Any, frame: int, view: str, box: Box | None, messages: tuple[str, ...]) -> Rendered:
    """The channels that Blender would write; a file without passes has RGBA."""
    scene.frame_set(frame)
    render = scene.render
    own = _Kept(render)
    with tempfile.TemporaryDirectory(prefix="shlight-") as folder:
        try:
            own.change(scene, view, box, Path(folder))
            with quiet():
                bpy.ops.render.render(write_still=True)
        except RuntimeError as error:  # how Blender's operators fail
            raise RuntimeError(record.last.scene_error or one_line(error)) from None
        finally:
            own.restore()
        (path,) = Path(folder).iterdir()
        channels, pixels, attributes = _read(path)
    return Rendered(channels, pixels, attributes, (*messages, *record.last.report.lines()))


class _Kept:
    """Render settings that a picture changes, and that the next must find as they were."""

    NAMES = (
        "use_multiview", "use_border", "border_min_x", "border_max_x", "border_min_y", "border_max_y", "filepath",
        "use_file_extension",
    )  # fmt: skip

    def __init__(self, render: Any) -> None:
        self._render = render
        self._values = {name: getattr(render, name) for name in self.NAMES}
        self._views = [(view, view.use, view.file_suffix) for view in render.views]

    def change(self, scene: Any, view: str, box: Box | None, folder: Path) -> None:
        """One view, one tile, and one file in a folder."""
        render = self._render
        multiview = render.use_multiview
        leave_plain(render)
        render.use_multiview = multiview
        _choose_format(scene)
        if multiview:
            render.image_settings.views_format = "INDIVIDUAL"
            for number, (other, _, _) in enumerate(self._views):
                other.use = other.name == view
                other.file_suffix = f"_{number}"  # what the file gives may lead out of the folder
        elif view:
            scene.camera = scene.objects[view]
        if box is not None:
            _set_border(render, frame_of(render), box)
        render.use_file_extension = True
        render.filepath = str(folder / "picture")

    def restore(self) -> None:
        """Restores the settings."""
        for name, value in self._values.items():
            setattr(self._render, name, value)
        for view, use, suffix in self._views:
            view.use, view.file_suffix = use, suffix


def _choose_format(scene: Any) -> None:
    """A layer of the file for each pass, where there are more than one."""
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
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: {oiio.geterror().strip()}")
    names: list[str] = []
    attributes: dict[str, str] = {}
    parts: list[Any] = []
    part = 0
    while source.seek_subimage(part, 0):
        spec = source.spec()
        names += spec.channelnames
        pixels: Any = source.read_image(part, 0, 0, spec.nchannels, "float")
        parts.append(np.atleast_3d(pixels))
        attributes |= {a.name: str(a.value) for a in spec.extra_attribs if a.name.startswith(KEPT_ATTRIBUTES)}
        part += 1
    source.geterror()
    source.close()
    return tuple(names), np.concatenate(parts, axis=2), attributes
