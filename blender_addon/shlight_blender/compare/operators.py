# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the comparison."""

from __future__ import annotations

from typing import Any

import bpy

from ..names import name_of, one_line
from . import overlay, results
from .job import CompareError, Job
from .session import session
from .settings import DENOISE, REFERENCE_SECONDS

TICK_SECONDS = 0.2
GRASP = 12.0  # pixels beside the line of the split


class SHLIGHT_OT_compare(bpy.types.Operator):
    """Renders the frame with shlight, and with Cycles in the same time, in another Blender"""

    bl_idname = "shlight.compare"
    bl_label = "Compare with Cycles"
    bl_options = {"REGISTER"}

    denoise: bpy.props.BoolProperty(**DENOISE)
    reference_seconds: bpy.props.FloatProperty(**REFERENCE_SECONDS)

    def execute(self, context: Any) -> set[str]:
        """Compares while Blender waits."""
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            while not self._finish(TICK_SECONDS):
                pass
        except CompareError as error:
            return self._fail(error)
        finally:
            session.end()
        return {"FINISHED"}

    def invoke(self, context: Any, event: Any) -> set[str]:
        """Compares beside Blender's window."""
        if bpy.app.background:
            return self.execute(context)
        if not self._begin(context):
            return {"CANCELLED"}
        session.watch(context, TICK_SECONDS)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set[str]:
        """Follows the other Blender."""
        if session.job is not self._job:
            self.report({"INFO"}, f"shlight: the comparison was ended by {session.ended_by}")
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            session.end()
            self.report({"INFO"}, "shlight: the comparison was cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            finished = self._finish()
        except CompareError as error:
            session.end()
            return self._fail(error)
        if not finished:
            session.show()
            return {"PASS_THROUGH"}
        session.end()
        show_image(results.COMPARISON)
        return {"FINISHED"}

    def cancel(self, context: Any) -> None:
        """Blender ends the operator, as when its window is closed."""
        if session.job is self._job:
            session.end("Blender")

    def _begin(self, context: Any) -> bool:
        try:
            if session.job is not None:
                raise CompareError("a comparison is running; Esc in its window cancels it")
            self._job = session.job = Job(context, denoise=self.denoise, reference_seconds=self.reference_seconds)
        except CompareError as error:
            self._fail(error)
            return False
        self._scene = name_of(context.scene)
        return True

    def _finish(self, seconds: float = 0.0) -> bool:
        """Takes the results over if they are there, for which it waits so long."""
        figures = self._job.figures(seconds)
        if figures is None:
            return False
        try:
            results.load(self._job.folder, figures, self._scene)
        except (OSError, RuntimeError) as error:
            results.remove()
            raise CompareError(one_line(error)) from error
        overlay.add()
        return True

    def _fail(self, error: CompareError) -> set[str]:
        self.report({"ERROR"}, f"shlight: {error}")
        return {"CANCELLED"}


class SHLIGHT_OT_cancel_comparison(bpy.types.Operator):
    """Ends the comparison that runs"""

    bl_idname = "shlight.cancel_comparison"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    def execute(self, context: Any) -> set[str]:
        """Ends it."""
        session.end("its Cancel button")
        return {"FINISHED"}


class SHLIGHT_OT_show_comparison(bpy.types.Operator):
    """Shows an image of the comparison in an image editor"""

    bl_idname = "shlight.show_comparison"
    bl_label = "Show"
    bl_options = {"INTERNAL"}

    image: bpy.props.StringProperty()

    def execute(self, context: Any) -> set[str]:
        """Shows it."""
        results.make_images()  # what a user has removed
        if bpy.data.images.get(self.image) is None:
            self.report({"ERROR"}, f"shlight: there is no image '{self.image}'")
            return {"CANCELLED"}
        show_image(self.image)
        return {"FINISHED"}


def show_image(name: str) -> None:
    """Shows an image in an image editor; where none is open, soon in one that Blender opens for renders."""
    editors = results.image_editors()
    results.show([(editor, name) for editor in editors[:1]])
    if not editors and not bpy.app.background:
        # Blender goes on with a modal operator that opens a window, though it has finished.
        bpy.app.timers.register(lambda: _open_editor(name), first_interval=0.0)


def _open_editor(name: str) -> None:
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.render.view_show("INVOKE_DEFAULT")
    results.show([(editor, name) for editor in results.image_editors()[:1]])


class SHLIGHT_OT_remove_comparison(bpy.types.Operator):
    """Removes the results of the comparison and their images"""

    bl_idname = "shlight.remove_comparison"
    bl_label = "Remove"
    bl_options = {"INTERNAL"}

    def execute(self, context: Any) -> set[str]:
        """Removes them."""
        overlay.remove()
        results.remove()
        return {"FINISHED"}


class SHLIGHT_OT_drag_split(bpy.types.Operator):
    """Drags the line between shlight's picture and Cycles'"""

    bl_idname = "shlight.drag_split"
    bl_label = "Drag the Split"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Whether this editor shows the comparison."""
        image = getattr(context.space_data, "image", None)
        return results.last is not None and image is not None and image.name == results.COMPARISON

    def invoke(self, context: Any, event: Any) -> set[str]:
        """Takes hold of the line if the mouse is at it."""
        if abs(event.mouse_region_x - overlay.split_in(context.region)) > GRASP * context.preferences.system.ui_scale:
            return {"PASS_THROUGH"}
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set[str]:
        """Follows the mouse until its button is released."""
        if not self.poll(context):  # the results were removed meanwhile
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            place, _ = context.region.view2d.region_to_view(event.mouse_region_x, 0)
            context.window_manager.shlight_compare.split = place
            context.area.tag_redraw()
        elif event.type in {"LEFTMOUSE", "ESC"}:
            return {"FINISHED"}
        return {"RUNNING_MODAL"}


CLASSES = (
    SHLIGHT_OT_compare,
    SHLIGHT_OT_cancel_comparison,
    SHLIGHT_OT_show_comparison,
    SHLIGHT_OT_remove_comparison,
    SHLIGHT_OT_drag_split,
)
