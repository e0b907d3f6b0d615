# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the comparison, and its operators: what to compare, progress, and what was found."""

from __future__ import annotations

from typing import Any

import bpy

from ..compat import draw_progress
from ..names import name_of, one_line
from ..record import light_name
from ..ui.base import draw_text, panel, with_names_aside
from ..ui.report import draw_place
from ..windows import areas
from ..worker_process import WorkerError
from . import overlay, results
from .job import Job, session

TICK_SECONDS = 0.2
MOST_REL_MSE = 1.0  # above, the figure says nothing
GRASP = 12.0  # pixels beside the line of the split


LIGHTS = [
    ("ALL", "All Light", "Both render the bounces of the scene's settings"),
    ("DIRECT", "Direct Light", "Both render direct light alone"),
]


class Effort:
    """What is asked of Cycles, in the panel and by the operator."""

    light: bpy.props.EnumProperty(name="Light", description="What both render", items=LIGHTS, default="ALL")
    denoise: bpy.props.BoolProperty(
        name="Denoise", description="Cycles denoises its picture, which counts as its time", default=False
    )
    reference_seconds: bpy.props.FloatProperty(
        name="Reference",
        description="Time for a reference, which Cycles renders. At 0 there is none",
        default=0.0,
        min=0.0,
        soft_max=600.0,
        unit="TIME_ABSOLUTE",
        step=100,
    )


def _move_split(settings: Any, context: Any) -> None:
    results.show_split(settings.split)


class SHLIGHT_CompareSettings(Effort, bpy.types.PropertyGroup):
    """Settings of the comparison, and the position of the split."""

    split: bpy.props.FloatProperty(
        name="Split",
        description="Share of the width that shows shlight's picture; the rest shows Cycles'",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_move_split,
    )


class SHLIGHT_OT_compare(Effort, bpy.types.Operator):
    """Renders the frame with shlight, and with Cycles in the same time, in another Blender"""

    bl_idname = "shlight.compare"
    bl_label = "Compare with Cycles"
    bl_options = {"REGISTER"}

    def execute(self, context: Any) -> set[str]:
        """Compares while Blender waits."""
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            while not self._finish(TICK_SECONDS):
                pass
        except WorkerError as error:
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
        except WorkerError as error:
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
                raise WorkerError("a comparison is running; Esc in its window cancels it")
            effort = {name: getattr(self, name) for name in Effort.__annotations__}
            self._job = session.job = Job(context, **effort)
        except WorkerError as error:
            self._fail(error)
            return False
        self._scene = name_of(context.scene)
        return True

    def _finish(self, seconds: float = 0.0) -> bool:
        """Takes the results over if they are there, for which it waits so long."""
        figures = self._job.worker.result(seconds)
        if figures is None:
            return False
        try:
            results.load(self._job.folder, figures, self._scene)
        except (OSError, RuntimeError) as error:
            results.remove()
            raise WorkerError(one_line(error)) from error
        overlay.add()
        return True

    def _fail(self, error: WorkerError) -> set[str]:
        self.report({"ERROR"}, f"shlight: {error}")
        return {"CANCELLED"}


class SHLIGHT_OT_cancel_comparison(bpy.types.Operator):
    """Ends the comparison that runs"""

    bl_idname = "shlight.cancel_comparison"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    def execute(self, context: Any) -> set[str]:
        session.end("its Cancel button")
        return {"FINISHED"}


class SHLIGHT_OT_show_comparison(bpy.types.Operator):
    """Shows an image of the comparison in an image editor"""

    bl_idname = "shlight.show_comparison"
    bl_label = "Show"
    bl_options = {"INTERNAL"}

    image: bpy.props.StringProperty()

    def execute(self, context: Any) -> set[str]:
        results.make_images()  # what a user has removed
        if bpy.data.images.get(self.image) is None:
            self.report({"ERROR"}, f"shlight: there is no image '{self.image}'")
            return {"CANCELLED"}
        show_image(self.image)
        return {"FINISHED"}


def show_image(name: str) -> None:
    """Shows an image in an image editor; where none is open, soon in one that Blender opens for renders."""
    editors = areas("IMAGE_EDITOR")
    results.show([(editor, name) for editor in editors[:1]])
    if not editors and not bpy.app.background:
        # Blender goes on with a modal operator that opens a window, though it has finished.
        bpy.app.timers.register(lambda: _open_editor(name), first_interval=0.0)


def _open_editor(name: str) -> None:
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.render.view_show("INVOKE_DEFAULT")
    results.show([(editor, name) for editor in areas("IMAGE_EDITOR")[:1]])


class SHLIGHT_OT_remove_comparison(bpy.types.Operator):
    """Removes the results of the comparison and their images"""

    bl_idname = "shlight.remove_comparison"
    bl_label = "Remove"
    bl_options = {"INTERNAL"}

    def execute(self, context: Any) -> set[str]:
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


@panel("SHLIGHT_RENDER_PT_compare", "Compare with Cycles", closed=True, names_aside=False)
def comparison(layout: Any, context: Any) -> None:
    """The comparison."""
    if session.job is not None:
        stage = session.job.worker.stage
        draw_progress(layout, f"{stage.name} ({stage.seconds:.0f} s)", stage.share)
        layout.operator(SHLIGHT_OT_cancel_comparison.bl_idname, text="Cancel", icon="X")
        return
    settings = context.window_manager.shlight_compare
    column = with_names_aside(layout.column())
    column.row().prop(settings, "light", expand=True)
    column.prop(settings, "denoise", text="Denoise Cycles")
    column.prop(settings, "reference_seconds")
    button = layout.operator(SHLIGHT_OT_compare.bl_idname, text="Compare", icon="RENDER_STILL")
    for name in Effort.__annotations__:
        setattr(button, name, getattr(settings, name))
    if results.are_of(context.scene):
        _draw_results(layout, context, results.last)


def _draw_results(layout: Any, context: Any, found: Any) -> None:
    row = layout.row(align=True)
    for name in found.names:
        show = row.operator(SHLIGHT_OT_show_comparison.bl_idname, text=name.removeprefix("shlight "), icon="IMAGE_DATA")
        show.image = name
    row.operator(SHLIGHT_OT_remove_comparison.bl_idname, text="", icon="TRASH")
    layout.prop(context.window_manager.shlight_compare, "split", slider=True)
    column = layout.column(align=True)
    for line in lines(found.figures):
        draw_text(column, context, line, "BLANK1")
    if not found.figures["differences"]:
        layout.label(text="No difference beyond Cycles' noise", icon="CHECKMARK")
    for number, place in enumerate(found.figures["differences"], start=1):
        _draw_place(layout, context, number, place)


def lines(figures: dict[str, Any]) -> list[str]:
    """Times and errors in words."""
    ours, theirs = figures["shlight"], figures["cycles_same_time"]
    light = f"All pictures: {light_name(ours['settings']['max_bounces'])}"
    times = [f"shlight: {ours['seconds']:.2f} s", f"Cycles: {theirs['seconds']:.2f} s, {theirs['samples']} samples"]
    if "reference" not in figures:
        return [light, *times, f"No reference; between the two: {_rel_mse(figures['rel_mse_of_both'])}"]
    reference = figures["reference"]
    return [
        light,
        *(f"{line}, {_rel_mse(part['rel_mse_measured'])}" for line, part in zip(times, (ours, theirs), strict=True)),
        f"Reference: {reference['seconds']:.1f} s, {reference['samples']} samples; of each relMSE "
        f"{reference['noise_rel_mse']:.2e} is its noise",
    ]


def _rel_mse(value: float) -> str:
    return f"relMSE {value:.2e}" if value <= MOST_REL_MSE else "differs strongly"


def _draw_place(layout: Any, context: Any, number: int, place: dict[str, Any]) -> None:
    box = layout.box().column(align=True)
    text = f"{number}  {place['place']}: {100 * place['difference']:+.0f} %"
    draw_place(box, place["place"], text)
    for message in place["messages"]:
        draw_text(box, context, message[:1].upper() + message[1:], "INFO")
    if not place["messages"]:
        box.label(text="The report names nothing here", icon="BLANK1")
    for message in place["of_light"]:
        draw_text(box, context, message, "LIGHT")


CLASSES = (
    SHLIGHT_OT_compare,
    SHLIGHT_OT_cancel_comparison,
    SHLIGHT_OT_show_comparison,
    SHLIGHT_OT_remove_comparison,
    SHLIGHT_OT_drag_split,
    comparison,
)
