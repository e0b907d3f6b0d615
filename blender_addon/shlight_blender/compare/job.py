# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison that runs: a copy of the file, the other Blender that renders it, and what windows show meanwhile."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bpy

from ..background import command, environment, save_unsaved_images
from ..names import name_of, one_line
from ..native import native_problem
from ..running import ENGINE
from ..windows import redraw
from ..worker_process import WorkerError, WorkerProcess

WORKER = "compare.render"
MOST_SAMPLES = 2**16  # of the reference
PAINTED_SOURCES = {"FILE", "GENERATED"}  # of images whose pixels may be in no file


class Job:
    """One comparison, in a temporary folder. `end` ends the other Blender at once and removes the folder."""

    def __init__(self, context: Any, *, light: str = "ALL", denoise: bool, reference_seconds: float) -> None:
        """Writes the copy and starts the other Blender; WorkerError where that cannot be."""
        _check(context)
        try:
            with ExitStack() as stack:
                files = TemporaryDirectory(
                    prefix="shlight_compare_", dir=bpy.app.tempdir or None, ignore_cleanup_errors=True
                )
                self.folder = Path(stack.enter_context(files))
                request = {
                    "samples": MOST_SAMPLES,
                    "scene": str(self.folder / "scene.blend"),
                    "scene_name": context.scene.name,
                    "view_layer": context.view_layer.name,
                    "use_scripts": context.preferences.filepaths.use_scripts_auto_execute and not bpy.app.autoexec_fail,
                    "light": light,
                    "denoise": denoise,
                    "reference_seconds": reference_seconds,
                    "images": _save_copy(context.scene, self.folder),
                    "measured": _measured_files(),
                }
                self.worker = WorkerProcess(command(WORKER), request, self.folder, environment())
                stack.callback(self.worker.end)
                self.end = stack.pop_all().close
        except (OSError, RuntimeError) as error:
            raise WorkerError(one_line(error)) from error


def _check(context: Any) -> None:
    """Raises errors that can be found before anything is started."""
    scene = context.scene
    if problem := native_problem():
        raise WorkerError(problem)
    if scene.render.engine != ENGINE:
        raise WorkerError("choose shlight as the scene's render engine first")
    if getattr(scene, "cycles", None) is None:
        raise WorkerError("Cycles is not there: enable its add-on, Cycles Render Engine")
    if scene.camera is None:
        raise WorkerError(f"scene '{name_of(scene)}' has no camera")
    if bpy.app.is_job_running("RENDER"):
        raise WorkerError("a render is running; wait for its end")


def _save_copy(scene: Any, folder: Path) -> dict[str, str]:
    """Writes scene.blend; see `save_unsaved_images` for what is returned.

    After Blender's operator to save a copy the file itself would count as saved.
    """
    for each in scene.objects:
        if each.mode == "EDIT":
            each.update_from_editmode()
    bpy.data.libraries.write(str(folder / "scene.blend"), {scene, *bpy.data.texts}, path_remap="ABSOLUTE")
    return save_unsaved_images((image for image in bpy.data.images if image.source in PAINTED_SOURCES), folder)


def _measured_files() -> dict[str, str]:
    """Absolute paths by names of materials; the copy has them as they were given, perhaps relative to the file."""
    from ..export.materials import measured_path

    own = {name_of(each): measured_path(each) for each in bpy.data.materials if each.library is None}
    return {name: str(path) for name, path in own.items() if path is not None}


class Session:
    """At most one job at a time."""

    def __init__(self) -> None:
        self.job: Job | None = None
        self.ended_by = ""  # what ended the last one before its end
        self._timer: Any = None

    def watch(self, context: Any, seconds: float) -> None:
        """Has the window tick, and shows the state."""
        self._timer = context.window_manager.event_timer_add(seconds, window=context.window)
        self.show()

    def show(self) -> None:
        """Shows the state in the status bar and the panel."""
        text = None
        if self.job:
            stage = self.job.worker.stage
            text = f"Compare with Cycles: {stage.name} ({stage.seconds:.0f} s)   Esc: cancel"
        for window in bpy.context.window_manager.windows:
            with bpy.context.temp_override(window=window):
                bpy.context.workspace.status_text_set(text)
        redraw("PROPERTIES", "IMAGE_EDITOR")

    def end(self, ended_by: str = "") -> None:
        """Ends the job, if there is one, and leaves nothing of it."""
        if self.job is None:
            return
        self.job.end()
        self.job, self.ended_by = None, ended_by
        if self._timer is not None:
            bpy.context.window_manager.event_timer_remove(self._timer)
            self._timer = None
            self.show()


session = Session()
