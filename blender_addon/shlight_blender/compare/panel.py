# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the comparison: what to compare, progress, and what was found."""

from __future__ import annotations

from typing import Any

import bpy

from .. import report_panel
from ..compat import draw_progress
from ..engine_panel import EnginePanel, with_names_aside
from . import operators, results
from .pictures import light_name
from .session import session


class SHLIGHT_RENDER_PT_compare(EnginePanel, bpy.types.Panel):
    """The comparison."""

    bl_label = "Compare with Cycles"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        """Draws the panel."""
        layout = self.layout
        if session.job is not None:
            stage = session.job.stage
            draw_progress(layout, f"{stage.name} ({stage.seconds:.0f} s)", stage.share)
            layout.operator(operators.SHLIGHT_OT_cancel_comparison.bl_idname, text="Cancel", icon="X")
            return
        settings = context.window_manager.shlight_compare
        column = with_names_aside(layout.column())
        column.prop(settings, "denoise", text="Denoise Cycles")
        column.prop(settings, "reference_seconds")
        button = layout.operator(operators.SHLIGHT_OT_compare.bl_idname, text="Compare", icon="RENDER_STILL")
        button.denoise, button.reference_seconds = settings.denoise, settings.reference_seconds
        if results.are_of(context.scene):
            _draw_results(layout, context, results.last)


def _draw_results(layout: Any, context: Any, found: Any) -> None:
    row = layout.row(align=True)
    for name in found.names:
        show = row.operator(
            operators.SHLIGHT_OT_show_comparison.bl_idname, text=name.removeprefix("shlight "), icon="IMAGE_DATA"
        )
        show.image = name
    row.operator(operators.SHLIGHT_OT_remove_comparison.bl_idname, text="", icon="TRASH")
    layout.prop(context.window_manager.shlight_compare, "split", slider=True)
    column = layout.column(align=True)
    for line in lines(found.figures):
        report_panel.draw_text(column, context, line, "BLANK1")
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
        return [light, *times, f"No reference; relMSE between the two: {figures['rel_mse_of_both']:.2e}"]
    reference = figures["reference"]
    return [
        light,
        *(f"{line}, relMSE {part['rel_mse_measured']:.2e}" for line, part in zip(times, (ours, theirs), strict=True)),
        f"Reference: {reference['seconds']:.1f} s, {reference['samples']} samples; of each relMSE "
        f"{reference['noise_rel_mse']:.2e} is its noise",
    ]


def _draw_place(layout: Any, context: Any, number: int, place: dict[str, Any]) -> None:
    box = layout.box().column(align=True)
    text = f"{number}  {place['place']}: {100 * place['difference']:+.0f} %"
    if report_panel.leads_somewhere(place["place"]):
        show = box.operator(report_panel.SHLIGHT_OT_show_place.bl_idname, text=text, icon="RESTRICT_SELECT_OFF")
        show.place = place["place"]
    else:
        box.label(text=text)
    for message in place["messages"]:
        report_panel.draw_text(box, context, message[:1].upper() + message[1:], "INFO")
    if not place["messages"]:
        box.label(text="The report names nothing here", icon="BLANK1")
    for message in place["of_light"]:
        report_panel.draw_text(box, context, message, "LIGHT")


CLASSES = (*operators.CLASSES, SHLIGHT_RENDER_PT_compare)
