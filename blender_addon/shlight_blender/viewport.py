# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport: its scene and its view follow Blender's, and it draws what has been rendered of it so far."""

from __future__ import annotations

import time
import traceback
import weakref
from dataclasses import dataclass
from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from numpy.typing import NDArray

from . import record
from .frame import Frame, frame_of
from .light_mix import Factors, factors_of
from .picture_maker import LARGEST, Job, Picture, PictureMaker
from .report import ExportError
from .running import renders
from .windows import redraw

Matrix = NDArray[np.float64]

PIXEL_SIZES = {"1": 1, "2": 2, "4": 4, "8": 8}


@dataclass(frozen=True)
class ViewportView:
    """The view of a region; equal if the pictures are.

    to_world, projection: 4 x 4, row by row, as `export.camera.set_projection` takes them.
    aperture: as of `export.lens.aperture_of`. panorama: as of `export.lens.panorama_of`; None: the picture is plane.
    window: what of the whole panorama the region's frame shows: left, right, bottom and top; 0 ... 1 is all of it.
    """

    frame: Frame
    to_world: tuple[float, ...]
    projection: tuple[float, ...]
    clips: tuple[float, float]
    orthographic: bool
    aperture: dict[str, float]
    panorama: dict[str, Any] | None
    window: tuple[float, ...]

    @staticmethod
    def of(context: Any, depsgraph: Any) -> ViewportView:
        """The view of the region that is drawn."""
        from .export import aperture_of, panorama_of

        scene, view, space = depsgraph.scene, context.region_data, context.space_data
        to_world = np.linalg.inv(np.array(view.view_matrix, dtype=np.float64))
        projection = np.array(view.window_matrix, dtype=np.float64)
        by_camera = view.view_perspective == "CAMERA" and space.camera is not None
        camera = space.camera if by_camera and space.camera.type == "CAMERA" else None
        lens = camera.evaluated_get(depsgraph).data if camera else space
        clips = float(lens.clip_start), float(lens.clip_end)
        if not view.is_perspective and not by_camera:
            # An orthographic view of no camera shows what lies behind its eye too.
            to_world[:3, 3] += clips[1] * to_world[:3, 2]
            clips = 0.0, 2.0 * clips[1]
        frame = _frame(context, scene, projection if by_camera else None)
        panoramic = camera is not None and lens.type == "PANO"
        return ViewportView(
            frame,
            tuple(to_world.ravel()),
            tuple(projection.ravel()),
            clips,
            not view.is_perspective,
            aperture_of(lens, to_world, depsgraph) if camera else {},
            panorama_of(lens, frame_of(scene.render), scene.render) if panoramic else None,
            _panorama_window(scene, camera, projection, frame) if panoramic else (),
        )

    def set_camera(self, scene: Any) -> Any:
        """Gives it to a shlight.Scene; returns the `export.camera.View`; ExportError as of `set_panorama`."""
        from .export import set_panorama, set_projection

        to_world, projection = (np.reshape(matrix, (4, 4)) for matrix in (self.to_world, self.projection))
        if self.window:
            return set_panorama(scene, to_world, self.window, self.frame, self.clips, self.panorama, self.aperture)
        return set_projection(
            scene, to_world, projection, self.frame, self.clips, self.aperture, orthographic=self.orthographic
        )


def pixel_size(scene: Any) -> int:
    """How many pixels of the region one of the picture is wide."""
    chosen = scene.render.preview_pixel_size
    return PIXEL_SIZES.get(chosen) or max(1, round(bpy.context.preferences.system.pixel_size))


def _frame(context: Any, scene: Any, camera_projection: Matrix | None) -> Frame:
    """The region in pixels of the picture, and its render border; the camera's border if its projection is given."""
    size = pixel_size(scene)
    width, height = (max(1, length // size) for length in (context.region.width, context.region.height))
    low, high = np.zeros(2), np.ones(2)
    if camera_projection is not None:
        if scene.render.use_border:
            start, end = _camera_frame(scene, context.space_data.camera, camera_projection)
            low, high = (start + share * (end - start) for share in _border(scene.render, "border"))
    elif context.space_data.use_render_border:
        low, high = _border(context.space_data, "render_border")
    pixels = np.array([width, height])
    left, bottom = (int(c) for c in np.clip(np.floor(low * pixels), 0, pixels))
    right, top = (int(c) for c in np.clip(np.ceil(high * pixels), 0, pixels))
    return Frame(width, height, left, bottom, right, top)


def _camera_frame(scene: Any, camera: Any, projection: Matrix) -> tuple[Matrix, Matrix]:
    """The lower left and upper right corner of what renders show, as shares of the region."""
    corners = np.array([(*corner, 1.0) for corner in camera.data.view_frame(scene=scene)]) @ projection.T
    shares = 0.5 + 0.5 * corners[:, :2] / corners[:, 3:]
    return shares.min(axis=0), shares.max(axis=0)


def _panorama_window(scene: Any, camera: Any, projection: Matrix, frame: Frame) -> tuple[float, ...]:
    """A panorama fills the camera's frame, as in Cycles, and goes on around it where it can."""
    low, high = _camera_frame(scene, camera, projection)
    shift, full = [camera.data.shift_x, camera.data.shift_y], [frame.full_width, frame.full_height]
    start, end = (
        (np.array(corner) / full - low) / (high - low) + shift
        for corner in ((frame.left, frame.bottom), (frame.right, frame.top))
    )
    return float(start[0]), float(end[0]), float(start[1]), float(end[1])


def _border(owner: Any, name: str) -> list[Matrix]:
    """The lower left and upper right corner of a border, as shares of what it is drawn on."""
    return [np.array([getattr(owner, f"{name}_{end}_{axis}") for axis in "xy"]) for end in ("min", "max")]


class RenderedViewport:
    """The picture in one viewport; Blender makes a render engine for each."""

    def __init__(self, engine: Any) -> None:
        from .export import ExportedScene, everything

        self._engine = weakref.ref(engine)
        self._maker = PictureMaker(self._redraw, lambda: renders.is_running)
        self._exported = ExportedScene()
        self._changes = everything()  # that have not been exported
        self._shown: tuple[Any, ...] = ()  # what the picture depends on beside the scene
        self._error = ""
        self._updated = ""
        self._status = ""
        self._picture: Picture | None = None
        self._factors: Factors | None = None  # of the light mixer, that the scene was exported with
        self._mixed: Factors | None = None  # that the texture has
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
        renders.look()
        needed, factors = self._needed(context, depsgraph), factors_of(depsgraph.scene)
        view_changed, mix_changed = needed != self._shown, self._factors_for(factors, needed) != self._factors
        if self._changes and (view_changed or not self._error):
            self._follow(context, depsgraph, True)
        elif view_changed or (mix_changed and not self._error):
            self._follow(context, depsgraph, self._exported.is_of_one_camera or mix_changed)
        picture = self._maker.picture
        if picture is not self._picture or factors != self._mixed:
            self._picture, self._mixed, self._texture = picture, factors, _texture(picture, factors)
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
        start, factors = time.perf_counter(), self._factors_for(factors_of(depsgraph.scene), needed)
        try:
            self._exported.look_through(view)
            changes, self._changes = self._changes, Changes()
            changed = scene_may_change and self._exported.update(
                depsgraph, changes, viewport=context.space_data, factors=factors
            )
            self._factors, self._error = factors if scene_may_change else self._factors, ""
        except Exception as error:
            if not isinstance(error, ExportError):
                traceback.print_exc()
            # The scene may have been left half changed.
            self._exported, self._changes = ExportedScene(), everything()
            self._error, self._shown = f"shlight: {error}", needed
            return
        if changed:
            self._updated = f"{changes.parts()} read in {1e3 * (time.perf_counter() - start):.0f} ms"
            record.show_viewport(depsgraph.scene, self._exported)
            redraw("PROPERTIES")
        if (changed or needed != self._shown) and view.frame.width > 0 and view.frame.height > 0:
            self._maker.start(Job(self._exported.scene, view.frame, settings, denoises, self._factors))
        self._shown = needed

    def _factors_for(self, factors: Factors | None, needed: tuple[Any, ...]) -> Factors | None:
        """Returns the factors to export lamps with: those of the picture as long as it can be mixed by `factors`."""
        mix = self._maker.picture.mix if self._maker.picture is not None else None
        if mix is None or factors is None or self._changes or needed != self._shown or not mix.covers(factors):
            return factors
        return self._factors

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


def _texture(picture: Picture | None, factors: Factors | None) -> Any:
    if picture is None:
        return None
    pixels, (height, width) = picture.pixels, picture.pixels.shape[:2]
    if picture.mix is not None and factors is not None and picture.mix.covers(factors):
        pixels = np.minimum(picture.mix.picture(factors), LARGEST)
    buffer = gpu.types.Buffer("FLOAT", width * height * 4, np.ascontiguousarray(pixels).ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
