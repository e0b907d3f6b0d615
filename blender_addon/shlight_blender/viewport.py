# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport: its scene follows Blender's, and it draws what has been rendered of it so far."""

from __future__ import annotations

import time
import traceback
import weakref
from typing import Any

import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d

from . import record
from .picture_maker import Job, Picture, PictureMaker
from .report import ExportError
from .viewport_view import ViewportView


class RenderedViewport:
    """The picture in one viewport; Blender makes a render engine for each."""

    def __init__(self, engine: Any) -> None:
        from .export import ExportedScene, everything

        self._engine = weakref.ref(engine)
        self._maker = PictureMaker(self._redraw)
        self._exported = ExportedScene()
        self._changes = everything()  # that have not been exported
        self._shown: tuple[Any, ...] = ()  # what the picture depends on beside the scene
        self._error = ""
        self._updated = ""
        self._status = ""
        self._picture: Picture | None = None
        self._texture: Any = None
        # Blender frees engines when a viewport is closed or shows something else.
        weakref.finalize(engine, self._maker.end)

    def update(self, context: Any, depsgraph: Any) -> None:
        """Takes over what has changed in the scene; draws nothing."""
        from .export import changes_of

        self._changes.add(changes_of(depsgraph))
        if self._changes:
            self._maker.interrupt()
        self._follow(context, depsgraph, True)

    def draw(self, context: Any, depsgraph: Any) -> None:
        """Draws the newest picture, and has another one made if the view has changed."""
        view_changed = self._needed(context, depsgraph) != self._shown
        if self._changes and (view_changed or not self._error):
            self._follow(context, depsgraph, True)
        elif view_changed:
            self._follow(context, depsgraph, self._exported.is_of_one_camera)
        picture = self._maker.picture
        if picture is not self._picture:
            self._picture, self._texture = picture, _texture(picture)
        if picture is not None:
            self._draw_texture(context.region, depsgraph.scene, picture)
        self._say(self._error or self._maker.error or (picture.status if picture else ""))

    def _needed(self, context: Any, depsgraph: Any) -> tuple[Any, ...]:
        from shlight import has_denoiser

        from .export import viewport_settings

        scene = depsgraph.scene
        denoises = bool(scene.shlight.preview_use_denoising) and has_denoiser()
        return ViewportView.of(context, depsgraph), viewport_settings(scene), denoises

    def _follow(self, context: Any, depsgraph: Any, scene_may_change: bool) -> None:
        """Brings the scene up to date and has its picture made."""
        from .export import Changes, ExportedScene, everything

        needed = view, settings, denoises = self._needed(context, depsgraph)
        start = time.perf_counter()
        try:
            self._exported.look_through(view)
            changes, self._changes = self._changes, Changes()
            changed = scene_may_change and self._exported.update(
                depsgraph, changes, viewport=context.space_data, bake=self._bake
            )
            self._error = ""
        except Exception as error:
            if not isinstance(error, ExportError):
                traceback.print_exc()
            # The scene may have been left half changed.
            self._exported, self._changes = ExportedScene(), everything()
            self._error, self._shown = f"shlight: {error}", needed
            return
        if changed:
            self._updated = f"{changes.parts()} in {1e3 * (time.perf_counter() - start):.0f} ms"
            record.show_viewport(depsgraph.scene, self._exported)
        if (changed or needed != self._shown) and view.frame.width > 0 and view.frame.height > 0:
            self._maker.start(Job(self._exported.scene, view.frame, settings.arguments(), denoises))
        self._shown = needed

    def _bake(self, world: Any, scene: Any) -> Any:
        from .export import bake_in_background

        return bake_in_background(world, scene, self._take_baked_world)

    def _take_baked_world(self) -> None:
        self._changes.world = True
        self._redraw()

    def _redraw(self) -> None:
        try:
            if (engine := self._engine()) is not None:
                engine.tag_redraw()
        except ReferenceError:  # Blender has just freed it
            pass

    def _say(self, text: str) -> None:
        """Shows a line in the viewport."""
        status = " | ".join(part for part in (text, self._updated) if part)
        if status != self._status and (engine := self._engine()) is not None:
            self._status = status
            engine.update_stats("", status)

    def _draw_texture(self, region: Any, scene: Any, picture: Picture) -> None:
        engine, frame = self._engine(), picture.frame
        assert engine is not None
        across, up = region.width / frame.full_width, region.height / frame.full_height
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        place = frame.left * across, frame.bottom * up
        draw_texture_2d(self._texture, place, frame.width * across, frame.height * up)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")


def _texture(picture: Picture | None) -> Any:
    if picture is None:
        return None
    height, width = picture.pixels.shape[:2]
    pixels = gpu.types.Buffer("FLOAT", width * height * 4, np.ascontiguousarray(picture.pixels).ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=pixels)
