# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: final renders in Blender's render window and in the background."""

from __future__ import annotations

import math
import time
import traceback
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import record, running
from .catchers import PARTS_WITH_PASSES, Part, Pictures, parts_of
from .compat import write_pass
from .frame import Frame, frame_of, memory_problem
from .light_mix import LightMix, factors_of
from .motion_blur import MeanPicture, middle_of, settings_of, times_of
from .names import is_utf8, name_of, printable
from .native import native_problem
from .passes import (
    Arrays,
    LayerPass,
    denoised,
    layer_passes,
    pass_arguments,
    stamp_cryptomattes,
    stores_shadows,
    with_features,
    write_passes,
)
from .record import inexact_light, status_of
from .report import Effect, ExportCancelled, ExportError
from .running import ENGINE

MOST_WARNINGS = 20
# Times of updates with unfinished pictures [s].
FIRST_UPDATE = 0.05
UPDATE_INTERVAL = 0.25
LARGEST_UPDATE_SHARE = 0.1  # of the time


class ShlightRenderEngine(bpy.types.RenderEngine):
    """Noise-free direct light from area lights."""

    bl_idname = ENGINE
    bl_label = "shlight"
    bl_use_preview = True
    bl_use_eevee_viewport = True  # and so does the viewport's Material Preview
    bl_use_shading_nodes_custom = False
    bl_use_custom_freestyle = True  # EEVEE would draw the lines, which takes long, or fails, without a graphics card

    def render(self, depsgraph: Any) -> None:
        """Renders one view layer. Blender prints exceptions and goes on, so all of them are reported here."""
        # Freestyle's scenes of strokes are in no file.
        if self.is_preview or depsgraph.scene.original not in bpy.data.scenes.values():
            self._render_aside(depsgraph)
            return
        frame = frame_of(depsgraph.scene.render)
        try:
            self._begin(depsgraph)
            if problem := native_problem() or memory_problem(frame):
                raise ExportError(problem)
            views: dict[str, Arrays | None] = {}
            self._is_new_frame = True
            if not depsgraph.scene.render.use_persistent_data:
                self._exported.clear()
            for view in _views(depsgraph.scene.render):
                views[view] = self._render(depsgraph, frame, view)
            if running.renders.stopped:
                text = f"the render was stopped because {running.renders.stopped} was disabled"
                self._say_error(text)  # after an error Blender begins no other frame
            if self.test_break():
                running.renders.broken_at = time.monotonic()
            self._deliver(depsgraph, frame, views)
        except ExportError as error:
            record.last.scene_error = str(error)
            self._fail(depsgraph, frame, str(error))
        except Exception as error:
            traceback.print_exc()
            self._fail(depsgraph, frame, f"{type(error).__name__}: {error}")

    def _render_aside(self, depsgraph: Any) -> None:
        """The picture of a scene that Blender makes: a material, a light or a world in a panel, or Freestyle's strokes.

        It is empty if there can be none.
        """
        frame, image = frame_of(depsgraph.scene.render), None
        if native_problem():
            self._deliver(depsgraph, frame, {})
            return
        import shlight

        from .export import ExportedScene, everything, preview_settings, stroke_settings

        settings = preview_settings if self.is_preview else stroke_settings
        try:
            exported = ExportedScene()
            exported.look_from(depsgraph, frame=frame)
            exported.update(depsgraph, everything())
            image = shlight.render(
                exported.scene,
                frame.width,
                frame.height,
                progress=lambda _: not self.test_break(),
                **settings(depsgraph.scene),
            )
        except (ExportError, shlight.RenderCancelled):
            pass
        except Exception:
            traceback.print_exc()
        made = None if image is None else {"combined": image}
        self._deliver(depsgraph, frame, dict.fromkeys(_views(depsgraph.scene.render), made))

    def _begin(self, depsgraph: Any) -> None:
        """Starts the record of a render with its first view layer; the others add to it."""
        view_layer = name_of(depsgraph.view_layer)
        # Blender makes an engine for each frame, or keeps one for all (Persistent Data).
        if view_layer in getattr(self, "_view_layers", {view_layer}):
            record.begin(depsgraph.scene)
            self._view_layers: set[str] = set()
            self._shown: set[str] = set()
            self._delivered: dict[tuple[str, str], tuple[list[LayerPass], Arrays]] = {}  # by layer and view
            self._said = ""
            self._exported: dict[str, Any] = getattr(self, "_exported", {})  # by view layer
        self._view_layers.add(view_layer)

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        """Names the passes of a view layer, for the compositor."""
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for own in layer_passes(scene, renderlayer):
            self.register_pass(scene, renderlayer, own.name, len(own.channels), own.channels, own.kind)

    def _render(self, depsgraph: Any, frame: Frame, view: str) -> Arrays | None:
        """The picture of a view and its passes, or as much as there is when the user stops; None: nothing."""
        pictures = Pictures(parts_of(depsgraph), stores_shadows(depsgraph.view_layer))
        for part in pictures.parts:
            layers = self._render_part(depsgraph, frame, view, part, pictures)
            if layers is None or (not pictures.is_last(part) and not self._wait("Rendering")):
                return None
            pictures.made[part] = layers
        return pictures.whole(pictures.made[pictures.parts[-1]])

    def _render_part(self, depsgraph: Any, frame: Frame, view: str, part: Part, pictures: Pictures) -> Arrays | None:
        """The picture of a part of the scene; `pictures` has those before."""
        # Imported here: an installation without the native module still registers.
        import shlight

        from .export import render_settings
        from .export.images import TEXTURES

        start = time.perf_counter()
        times, now_at = times_of(depsgraph.scene, depsgraph.view_layer), depsgraph.scene.frame_current_final
        mean = MeanPicture(len(times))
        try:
            self._check("Exporting the scene")
            if len(times) > 1:
                self._set_time(now_at + middle_of(depsgraph.scene))
            exported = self._export(depsgraph, frame, view, part, pictures.parts == [Part.WHOLE])
            settings = pictures.shared(render_settings(depsgraph.scene), part)
            passes = pass_arguments(depsgraph.scene, depsgraph.view_layer) if part in PARTS_WITH_PASSES else {}
            denoises = depsgraph.scene.shlight.use_denoising and shlight.has_denoiser()
            record.last.export_seconds = time.perf_counter() - start
            if pictures.is_last(part):
                record.last.report.extend(exported.report)
                record.last.dark = exported.dark or record.last.dark
            record.last.settings = settings
            record.last.operations.update(exported.meshes.operations())
            record.last.texture_bytes = TEXTURES.size_in_bytes
            self._show(record.last.report.lines())
            self._check("Rendering")
            latest: NDArray[np.float32] | None = None
            next_update = start + FIRST_UPDATE
            self._ends_with_passes = False

            def show(image: NDArray[np.float32], report: Any) -> bool:
                nonlocal latest, next_update
                latest = image = mean.shown(image)
                self._ends_with_passes = bool(passes)
                self._status = status_of(report)
                if pictures.is_last(part) and (now := time.perf_counter()) >= next_update:
                    self._deliver(depsgraph, frame, {view: pictures.whole({"combined": image})})
                    taken = time.perf_counter() - now
                    next_update = now + max(UPDATE_INTERVAL, taken / LARGEST_UPDATE_SHARE)
                return self._wait(self._status)

            self._status = "Rendering"
            for number, offset in enumerate(times):
                if len(times) > 1:
                    self._move(depsgraph, exported, frame, view, now_at + offset)
                result = shlight.render(
                    exported.scene,
                    frame.width,
                    frame.height,
                    progress=mean.progress(pictures.progress(self._progress)),
                    on_update=show,
                    **(with_features(passes) if denoises else passes),
                    **settings_of(settings, number, len(times)),
                )
                mean.add(result.layers)
                if not self._wait(self._status):
                    break
        except ExportCancelled:
            return None
        except shlight.RenderCancelled:
            return None if latest is None else {"combined": latest}  # what the user has seen stays
        finally:
            if len(times) > 1:
                self._set_time(now_at)
                self._exported.clear()  # it has things where they were last
        record.last.statistics = result.report
        if inexact := inexact_light(record.last.statistics):
            record.last.report.add("Light", inexact, Effect.SLIGHT)
        exported.meshes.remark_doubled(record.last.statistics.doubled, record.last.report)
        stamp_cryptomattes(self.get_result(), depsgraph.view_layer, exported.meshes.names())
        layers = mean.layers
        if denoises:
            layers = denoised(layers, "high", settings["threads"], lambda _: self._wait("Denoising"))
        factors, views = factors_of(depsgraph.scene), _views(depsgraph.scene.render)
        if factors is not None and pictures.parts == [Part.WHOLE] and len(self._view_layers) == len(views) == 1:
            record.last.mix = LightMix(layers, factors)
        else:
            record.last.mix = None
        return layers

    def _export(self, depsgraph: Any, frame: Frame, view: str, part: Part, keeps: bool) -> Any:
        """The scene as one view sees it. With Persistent Data, what has not changed since the last render is kept.

        keeps: False for one of several parts, each of which has all of the scene.
        """
        from .export import Changes, ExportedScene, changes_of, everything

        layer = name_of(depsgraph.view_layer)
        exported = self._exported.pop(layer, None)  # one whose export ends half way is not kept
        if exported is None or not keeps:
            exported, changes = ExportedScene(part), everything()
        else:
            changes = changes_of(depsgraph) if self._is_new_frame else Changes()
        exported.look_from(depsgraph, frame=frame, camera=self._eye(depsgraph, view))
        exported.update(depsgraph, changes, waiting=self._wait, factors=factors_of(depsgraph.scene))
        if keeps:
            self._exported[layer], self._is_new_frame = exported, False
        return exported

    def _set_time(self, time_: float) -> None:
        self.frame_set(math.floor(time_), subframe=time_ - math.floor(time_))

    def _move(self, depsgraph: Any, exported: Any, frame: Frame, view: str, time_: float) -> None:
        """Brings an exported scene, and the depsgraph, to another time."""
        from .export import motion_of

        self._set_time(time_)
        camera = self._eye(depsgraph, view)
        exported.move(depsgraph, motion_of(depsgraph), frame=frame, camera=camera, waiting=self._wait)

    def _eye(self, depsgraph: Any, view: str) -> Any:
        """The camera of a view, or one of its two eyes."""
        from .export import Eye

        if not view:
            return self.camera_override
        self.active_view_set(view)
        camera = self.camera_override or depsgraph.scene.camera
        if camera is None or camera.type != "CAMERA":
            return camera
        return Eye(camera, self.camera_model_matrix(camera), self.camera_shift_x(camera))

    def _progress(self, fraction: float) -> bool:
        """Passes stay with a picture that has been shown: then only `show` stops the render."""
        self.update_progress(fraction)
        return self._wait(self._status) or self._ends_with_passes

    def _wait(self, text: str) -> bool:
        """Says what is done; False if it is to stop."""
        if text != self._said:
            self.update_stats("", text)
            self._said = text
        return not (running.renders.stopped or self.test_break())

    def _check(self, text: str) -> None:
        if not self._wait(text):
            raise ExportCancelled

    def _show(self, lines: list[str]) -> None:
        """Shows what is new of the render's warnings, the weightiest last: Blender's status bar keeps that."""
        fresh = [line for line in lines if line not in self._shown]
        self._shown.update(fresh)
        shown, more = fresh[:MOST_WARNINGS], fresh[MOST_WARNINGS:]
        if more:
            self.report({"WARNING"}, f"shlight: and {len(more)} more warnings, see the console")
            print(*(f"shlight: {line}" for line in more), sep="\n")
        if shown and shown[0] != lines[0]:  # that of a view layer before
            shown.insert(0, lines[0])
        for line in reversed(shown):
            self.report({"WARNING"}, f"shlight: {line}")

    def _fail(self, depsgraph: Any, frame: Frame, text: str) -> None:
        self._say_error(text)
        try:
            self._deliver(depsgraph, frame, {})
        except Exception:  # about passes: any result will do
            traceback.print_exc()
            self.end_result(self.begin_result(0, 0, frame.width, frame.height))

    def _say_error(self, text: str) -> None:
        self.report({"ERROR"}, printable(f"shlight: {text}"))

    def _deliver(self, depsgraph: Any, frame: Frame, views: dict[str, Arrays | None]) -> None:
        """Hands over pictures of views; empty ones for all if there are none: without, saving crashes Blender."""
        passes = layer_passes(depsgraph.scene, depsgraph.view_layer)
        name = name_of(depsgraph.view_layer)
        # Blender takes no other names than UTF-8; without one it gives all layers, and forgets what they had.
        asked = name if is_utf8(depsgraph.view_layer) else ""
        keeps = not all(is_utf8(layer) for layer in depsgraph.scene.view_layers)
        for own in passes:
            self.add_pass(own.name, len(own.channels), own.channels, layer=asked)
        for view, arrays in (views or dict.fromkeys(_views(depsgraph.scene.render))).items():
            result = self.begin_result(0, 0, frame.width, frame.height, layer=asked, view=view)
            made = {} if arrays is None else {(name, view): (passes, arrays)}
            if keeps:
                made = self._delivered = self._delivered | made
            for layer in result.layers:
                for own_passes, own_arrays in [made[key]] if (key := (name_of(layer), view)) in made else ():
                    write_pass(layer.passes["Combined"], own_arrays["combined"][::-1].reshape(-1, 4))
                    write_passes(layer, own_passes, own_arrays)
            self.end_result(result)

    def view_update(self, context: Any, depsgraph: Any) -> None:
        """Takes over what has changed for a viewport, or says there why it stays empty."""
        if not hasattr(self, "_viewport"):
            if problem := native_problem():
                self.update_stats("", f"shlight: {problem}")
                return
            from .viewport import RenderedViewport

            self._viewport = RenderedViewport(self)
        self._viewport.update(context, depsgraph)

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        """Draws a viewport as far as it is rendered; Blender has called `view_update` before."""
        if hasattr(self, "_viewport"):
            self._viewport.draw(context, depsgraph)


def _views(render: Any) -> list[str]:
    """Names of the views of a render; that of a picture without views is empty."""
    return [name_of(view) for view in render.views if view.use] if render.use_multiview else [""]


def register() -> None:
    running.register()
    if not ShlightRenderEngine.is_registered:
        bpy.utils.register_class(ShlightRenderEngine)


def unregister() -> None:
    """Stops the render that runs, and removes the engine."""
    if running.renders.stop(ShlightRenderEngine.bl_label):  # else Blender would use what is removed
        try:
            bpy.utils.unregister_class(ShlightRenderEngine)
        except RuntimeError:  # where Blender lets no script write the add-on stays as it is, and renders
            running.renders.resume()
            raise
    running.unregister()
