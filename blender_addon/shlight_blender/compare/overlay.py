# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over the images of a comparison: the line of the split, and numbered markers with names."""

from __future__ import annotations

import math
from typing import Any

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ..compat import FLAT_SHADER
from ..record import light_name
from . import results

RADIUS, CORNERS = 14.0, 32
LETTERS = 13.0
MARGIN, PADDING = 10.0, 4.0
WHITE, BLACK = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 0.6)

_handler: Any = None


def add() -> None:
    """Draws in all image editors from now on."""
    global _handler
    if _handler is None and not bpy.app.background:
        _handler = bpy.types.SpaceImageEditor.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def remove() -> None:
    """Draws no longer."""
    global _handler
    if _handler is not None:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handler, "WINDOW")
    _handler = None


def split_in(region: Any) -> float:
    """The position of the split's line [pixels of the region]."""
    return float(region.view2d.view_to_region(bpy.context.window_manager.shlight_compare.split, 0.0, clip=False)[0])


def _draw() -> None:
    context = bpy.context
    image, found = context.space_data.image, results.last
    if found is None or image is None or image.name not in found.names:
        return
    region, scale = context.region, context.preferences.system.ui_scale
    margin = MARGIN * scale
    (left, bottom), (_, top) = (region.view2d.view_to_region(end, end, clip=False) for end in (0.0, 1.0))
    if image.name == results.COMPARISON:
        x = split_in(region)
        _line([(x, bottom), (x, top)])
        light = light_name(found.figures["shlight"]["settings"]["max_bounces"])
        _text(f"shlight, {light}", x - margin, top - 2 * margin, scale, to_the_left=True)
        _text(f"Cycles, {light}", x + margin, top - 2 * margin, scale)
    elif image.name == results.DIFFERENCE:
        legend = f"brown: shlight is darker, violet: brighter; {found.limit:g} % and more at the ends"
        _text(legend, left + margin, bottom + margin, scale)
    width, height = found.figures["size"]
    for number, place in enumerate(found.figures["differences"], start=1):
        x, y = region.view2d.view_to_region(place["x"] / width, place["y"] / height, clip=False)
        _line([_on_circle(x, y, RADIUS * scale, corner) for corner in range(CORNERS + 1)])
        _text(f"{number}  {place['place']}", x + (RADIUS + 4) * scale, y - 4 * scale, scale)


def _on_circle(x: float, y: float, radius: float, corner: int) -> tuple[float, float]:
    angle = 2 * math.pi * corner / CORNERS
    return x + radius * math.cos(angle), y + radius * math.sin(angle)


def _line(points: list[tuple[float, float]]) -> None:
    """White in black, to be seen on everything."""
    shader = gpu.shader.from_builtin(FLAT_SHADER)
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": points})
    gpu.state.blend_set("ALPHA")
    for width, color in ((4.0, BLACK), (1.5, WHITE)):
        gpu.state.line_width_set(width)
        shader.uniform_float("color", color)
        batch.draw(shader)
    gpu.state.line_width_set(1.0)
    gpu.state.blend_set("NONE")


def _text(text: str, x: float, y: float, scale: float, *, to_the_left: bool = False) -> None:
    """White on black, from x on or up to it."""
    blf.size(0, LETTERS * scale)
    width = blf.dimensions(0, text)[0]
    if to_the_left:
        x -= width
    edge, height = PADDING * scale, LETTERS * scale
    left, right, bottom, top = x - edge, x + width + edge, y - edge, y + height
    shader = gpu.shader.from_builtin(FLAT_SHADER)
    corners = [(left, bottom), (right, bottom), (left, top), (right, top)]
    gpu.state.blend_set("ALPHA")
    shader.uniform_float("color", BLACK)
    batch_for_shader(shader, "TRI_STRIP", {"pos": corners}).draw(shader)
    gpu.state.blend_set("NONE")
    blf.color(0, *WHITE)
    blf.position(0, x, y, 0)
    blf.draw(0, text)
