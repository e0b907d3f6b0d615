# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the light mixer, and the picture that it mixes in image editors."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy
from bpy.app.handlers import persistent

from .. import record
from ..light_mix import ONE, factors_of, follow_lamps
from ..names import with_name
from ..shown_images import draw_image, make_image, rendered_image
from ..windows import areas, redraw
from .base import draw_text, panel

MIX = "shlight Light Mix"
ROWS = 5

_folder: Path | None = None  # of the image's file


def show_mix(context: Any) -> None:
    """Shows the mix in the place of the render it is made of, and that again where nothing differs."""
    redraw("VIEW_3D")
    factors, mix = factors_of(context.scene), record.last.mix
    if factors is None or mix_problem(context) or (mix.is_rendered and factors == mix.factors):
        _exchange(bpy.data.images.get(MIX), rendered_image())
    else:
        _draw(mix.picture(factors))
        _exchange(rendered_image(), bpy.data.images.get(MIX))


def mix_problem(context: Any) -> str:
    """Why the latest render cannot be mixed; empty if it can, or nothing asks for it."""
    if not record.last.is_of(context.scene) or record.last.statistics is None:
        return "Render, then mix the light in the picture"
    if record.last.mix is None:
        return "Renders with the mixer on, of one view layer and without shadow catchers, can be mixed"
    if not record.last.mix.covers(factors_of(context.scene) or {}):
        return "Render again: the picture lacks light of lamps that are far brighter now"
    return ""


def _draw(pixels: Any) -> None:
    global _folder
    image = bpy.data.images.get(MIX)
    if image is not None and tuple(image.size) == (pixels.shape[1], pixels.shape[0]):
        draw_image(image, pixels)
        return
    if image is not None:
        bpy.data.images.remove(image)
    _folder = _folder or Path(tempfile.mkdtemp(prefix="shlight_mix_", dir=bpy.app.tempdir or None))
    make_image(MIX, pixels, _folder)


def _exchange(before: Any | None, after: Any | None) -> None:
    for area in areas("IMAGE_EDITOR"):
        space = area.spaces.active
        if space.image is not None and space.image == before:
            space.image = after
            area.tag_redraw()


def _remove_image() -> None:
    global _folder
    if (image := bpy.data.images.get(MIX)) is not None:
        bpy.data.images.remove(image)
    if _folder is not None:
        shutil.rmtree(_folder, ignore_errors=True)
    _folder = None


class SHLIGHT_OT_apply_light_mix(bpy.types.Operator):
    """Multiplies the power and colour of lamps by their factors, hides those that are off, and resets the mixer."""

    bl_idname = "shlight.apply_light_mix"
    bl_label = "Apply"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        all_rows = context.scene.shlight.light_mix
        found = {row.name: with_name(bpy.data.objects, row.name) for row in all_rows}
        rows = [row for row in all_rows if not _is_neutral(row)]
        for row in rows:
            if problem := _apply_problem(row, all_rows, found):
                self.report({"ERROR"}, f"shlight: nothing was applied: Light '{row.name}' {problem}")
                return {"CANCELLED"}
        lamps = {found[row.name].data: row for row in rows if row.on}
        for lamp, row in lamps.items():
            lamp.energy *= row.power
            lamp.color = [own * factor for own, factor in zip(lamp.color, row.color, strict=True)]
        for row in rows:
            if not row.on:
                found[row.name].hide_render = found[row.name].hide_viewport = True
        factors, mix = factors_of(context.scene), record.last.mix
        if factors and mix is not None and mix.covers(factors):
            mix.apply(factors)
        _reset(context)
        return {"FINISHED"}


class SHLIGHT_OT_reset_light_mix(bpy.types.Operator):
    """Sets all factors of the mixer to 1."""

    bl_idname = "shlight.reset_light_mix"
    bl_label = "Reset"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        _reset(context)
        return {"FINISHED"}


def _is_neutral(row: Any) -> bool:
    return bool(row.on and row.power == 1.0 and tuple(row.color) == ONE)


def _reset(context: Any) -> None:
    for row in context.scene.shlight.light_mix:
        for name in ("on", "power", "color"):
            row.property_unset(name)  # shows no mix for each of them
    show_mix(context)


def _apply_problem(row: Any, rows: Any, found: Mapping[str, Any]) -> str:
    """Why a lamp cannot have what its row says; empty if it can. found: the lamps of all rows by their names."""
    lamp = found[row.name]
    if lamp is None or lamp.library is not None or lamp.data.library is not None:
        return "is in another file"
    animation = lamp.data.animation_data
    if row.on and animation is not None and (animation.action or animation.drivers or animation.nla_tracks):
        return "has power or colour that may be animated"
    for other in rows:
        owner = found[other.name]
        shares = owner is not None and owner.data == lamp.data
        if row.on and shares and other.on and (other.power, *other.color) != (row.power, *row.color):
            return f"shares its data with '{other.name}', which has other factors"
    return ""


class SHLIGHT_UL_light_mix(bpy.types.UIList):
    """Lamps with their factors."""

    def draw_item(self, context: Any, layout: Any, data: Any, item: Any, icon: int, owner: Any, name: str) -> None:
        split = layout.split(factor=0.45)
        label = split.row(align=True)
        label.prop(item, "on", text="", icon="LIGHT" if item.on else "RADIOBUT_OFF", emboss=False)
        label.label(text=item.name)
        row = split.row(align=True)
        row.active = item.on
        row.prop(item, "power", text="")
        color = row.row(align=True)
        color.ui_units_x = 1.5
        color.prop(item, "color", text="")


@panel(
    "SHLIGHT_RENDER_PT_light_mixer",
    "Light Mixer",
    closed=True,
    names_aside=False,
    draw_header=lambda layout, context: layout.prop(context.scene.shlight, "use_light_mixer", text=""),
)
def light_mixer(layout: Any, context: Any) -> None:
    """A factor for each lamp."""
    settings = context.scene.shlight
    if not settings.use_light_mixer:
        layout.active = False
    elif not settings.light_mix:
        draw_text(layout, context, "There are no lamps; light of surfaces is not mixed", "INFO")
    elif problem := mix_problem(context):
        draw_text(layout, context, problem, "INFO")
    layout.template_list("SHLIGHT_UL_light_mix", "", settings, "light_mix", settings, "light_mix_row", rows=ROWS)
    buttons = layout.row(align=True)
    buttons.operator(SHLIGHT_OT_apply_light_mix.bl_idname)
    buttons.operator(SHLIGHT_OT_reset_light_mix.bl_idname)


@persistent
def _follow(scene: Any, depsgraph: Any) -> None:
    if scene.shlight.use_light_mixer:
        follow_lamps(scene, depsgraph.view_layer)


@persistent
def _undone(*_: Any) -> None:
    """Shows the mix of the sliders' earlier values, unless lamps may have lost what Apply has written to them."""
    mix = record.last.mix
    if mix is not None and not mix.is_rendered:
        record.last.mix = None
    show_mix(bpy.context)


@persistent
def _forget(*_: Any) -> None:
    _remove_image()


_HANDLERS = {"depsgraph_update_post": _follow, "undo_post": _undone, "redo_post": _undone, "load_pre": _forget}


def register() -> None:
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    _remove_image()


CLASSES = (SHLIGHT_OT_apply_light_mix, SHLIGHT_OT_reset_light_mix, SHLIGHT_UL_light_mix, light_mixer)
