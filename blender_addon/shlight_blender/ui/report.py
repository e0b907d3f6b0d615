# SPDX-License-Identifier: GPL-3.0-or-later
"""What the latest render drew in another way than Cycles, as a panel that leads to each place."""

from __future__ import annotations

import re
from typing import Any

import bpy

from .. import record
from ..names import name_of, with_name
from ..report import Effect, Message
from .base import draw_depth, draw_text, panel

MOST_PLACES = 4
ICONS = {Effect.DARK: "ERROR", Effect.LIGHT: "ERROR", Effect.THING: "ERROR"}
PLACE = re.compile(r"(?P<kind>[A-Z][a-z ]+?) '(?P<name>.+?)'(?:, node '(?P<node>.+)')?(?:, .*)?")
OBJECT_KINDS = {"Object", "Light", "Camera"}


class SHLIGHT_OT_show_place(bpy.types.Operator):
    """Selects the object, or the object with the material and its node."""

    bl_idname = "shlight.show_place"
    bl_label = "Show"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    place: bpy.props.StringProperty()

    def execute(self, context: Any) -> set[str]:
        found = PLACE.fullmatch(self.place)
        kind, name, node = found.group("kind", "name", "node") if found else ("", "", None)
        if kind == "World":
            _select_node(bpy.data.worlds.get(name), node)
            if getattr(context.space_data, "type", "") == "PROPERTIES":
                context.space_data.context = "WORLD"
            return {"FINISHED"}
        shown = (
            _user_of(context.view_layer, name) if kind == "Material" else with_name(context.view_layer.objects, name)
        )
        if shown is None:
            self.report({"ERROR"}, f"shlight: {self.place} is not in this view layer")
            return {"CANCELLED"}
        for other in context.view_layer.objects.selected:
            other.select_set(False)
        shown.select_set(True)
        context.view_layer.objects.active = shown
        if kind == "Material":
            shown.active_material_index = [name_of(slot) for slot in shown.material_slots].index(name)
            _select_node(with_name(bpy.data.materials, name), node)
        else:
            _select_node(shown.data, node)
        return {"FINISHED"}


def _user_of(view_layer: Any, material: str) -> Any:
    for each in view_layer.objects:
        if any(name_of(slot) == material for slot in each.material_slots):
            return each
    return None


def _select_node(owner: Any, name: str | None) -> None:
    tree: Any = getattr(owner, "node_tree", None)
    for node in tree.nodes if tree and name else ():
        node.select = name in (name_of(node), name_of(node, "label"))
        if node.select:
            tree.nodes.active = node


def draw_place(layout: Any, place: str, text: str) -> None:
    """A button that selects a place of the report, or its text alone where nothing can be selected."""
    found = PLACE.fullmatch(place)
    if found is not None and found["kind"] in OBJECT_KINDS | {"Material", "World"}:
        layout.operator(SHLIGHT_OT_show_place.bl_idname, text=text, icon="RESTRICT_SELECT_OFF").place = place
    else:
        layout.label(text=text, icon="BLANK1")


@panel("SHLIGHT_RENDER_PT_report", "Report", names_aside=False)
def report(layout: Any, context: Any) -> None:
    """Unsupported features, those with the largest effect first."""
    if not record.shown.is_of(context.scene):
        draw_text(layout, context, "Render to see what shlight draws otherwise than Cycles", "INFO")
        return
    if record.shown.scene_error:
        draw_text(layout, context, record.shown.scene_error, "ERROR")
    messages = [message for message in record.shown.report if message.effect < Effect.SLIGHT]
    bounces = record.shown.settings.get("max_bounces")
    if bounces is not None:
        draw_depth(layout, context, bounces)
    if not messages and not record.shown.scene_error and bounces is not None:
        layout.label(text=f"As Cycles draws {'it with ' * (bounces > 0)}{record.light_name(bounces)}", icon="CHECKMARK")
    for message in messages:
        _draw_message(layout, context, message)


def _slight() -> list[Message]:
    return [message for message in record.shown.report if message.effect == Effect.SLIGHT]


@panel(
    "SHLIGHT_RENDER_PT_report_slight",
    "Hardly Seen",
    parent="SHLIGHT_RENDER_PT_report",
    closed=True,
    names_aside=False,
    shown=lambda context: record.shown.is_of(context.scene) and bool(_slight()),
)
def report_slight(layout: Any, context: Any) -> None:
    """What is hardly seen."""
    for message in _slight():
        _draw_message(layout, context, message)


def _draw_message(layout: Any, context: Any, message: Message) -> None:
    box = layout.box().column(align=True)
    draw_text(box, context, message.text[:1].upper() + message.text[1:], ICONS.get(message.effect, "INFO"))
    for place in message.places[:MOST_PLACES]:
        draw_place(box, place, place)
    if len(message.places) > MOST_PLACES:
        box.label(text=f"and {len(message.places) - MOST_PLACES} more", icon="BLANK1")


CLASSES = (SHLIGHT_OT_show_place, report, report_slight)
