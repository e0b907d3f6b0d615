# SPDX-License-Identifier: MIT
"""The comparison as one picture: shlight, Cycles in the same time, the reference, and where shlight differs from it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from shlight import images, metrics
from shlight_blender.compare.measure import error_text
from shlight_blender.compare.pictures import PALETTE, difference_limit
from shlight_blender.record import light_name

Image = npt.NDArray[np.float32]

# Pixels of the picture.
LEAST_PANEL_WIDTH, MOST_PANEL_WIDTH = 400, 960
MARGIN, CAPTION, BAR = 12, 44, 46
DPI = 100
WHITE_AT = 0.8  # linear value to which the brightest parts are brought


def common_exposure(reference: npt.NDArray[np.float32]) -> float:
    """Stops by which all pictures are brightened: few of the reference's pixels are then brighter than WHITE_AT."""
    bright = float(np.percentile(reference[..., :3].max(axis=-1), 95))
    return math.log2(WHITE_AT / bright) if bright > 0 else 0.0


def comparison(
    name: str, figures: dict[str, Any], shlight: Image, cycles: Image, reference: Image
) -> npt.NDArray[np.uint8]:
    """The picture (height, width, 3), sRGB."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    height, width = reference.shape[:2]
    panel_width = width * math.ceil(LEAST_PANEL_WIDTH / width) if width < LEAST_PANEL_WIDTH else width
    panel_width = min(panel_width, MOST_PANEL_WIDTH)
    panel_height = max(round(panel_width * height / width), 1)
    whole = (2 * panel_width + 3 * MARGIN + BAR, 2 * (panel_height + CAPTION) + MARGIN)
    figure = Figure(figsize=(whole[0] / DPI, whole[1] / DPI), dpi=DPI, facecolor="white")
    canvas = FigureCanvasAgg(figure)

    def axes(column: int, row: int, left: int = 0, panel: int = panel_width) -> Any:
        x = MARGIN + column * (panel_width + MARGIN) + left
        y = whole[1] - (row + 1) * (panel_height + CAPTION)
        return figure.add_axes((x / whole[0], y / whole[1], panel / whole[0], panel_height / whole[1]))

    exposure = common_exposure(reference)
    ours, theirs, long = (figures[key] for key in ("shlight", "cycles_same_time", "reference"))
    light = light_name(ours["settings"]["max_bounces"])
    panels = [
        (shlight, f"{name}: shlight, {light}", f"{_seconds(ours)}, relMSE {error_text(ours)}"),
        (
            cycles,
            f"Cycles, {light}, same time",
            f"{_seconds(theirs)}, {theirs['samples']} samples, relMSE {error_text(theirs)}",
        ),
        (
            reference,
            f"reference: Cycles, {light}",
            f"{_seconds(long)}, {long['samples']} samples, own noise relMSE {long['noise_rel_mse']:.1e}",
        ),
    ]
    for number, (image, title, numbers) in enumerate(panels):
        panel = axes(number % 2, number // 2)
        panel.imshow(images.linear_to_srgb8(image[..., :3], exposure), interpolation="antialiased", aspect="auto")
        _caption(panel, title, numbers)

    difference = metrics.relative_difference(shlight, reference)
    limit = difference_limit(difference)
    panel = axes(1, 1)
    shown = panel.imshow(
        100 * difference, cmap=PALETTE, vmin=-limit, vmax=limit, interpolation="antialiased", aspect="auto"
    )
    _caption(panel, "shlight − reference", "in % of the reference's value (dark parts: of a tenth of its mean)")
    bar = figure.colorbar(shown, cax=axes(1, 1, left=panel_width + 4, panel=12), extend="both", extendfrac=0.03)
    bar.ax.tick_params(labelsize=7, length=2, pad=1)
    canvas.draw()
    return np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., :3])


def _seconds(figures: dict[str, Any]) -> str:
    seconds = figures["seconds"]
    return f"{seconds:.0f} s" if seconds >= 20 else f"{seconds:.2f} s"


def _caption(panel: Any, title: str, numbers: str) -> None:
    panel.set_axis_off()
    common = {"transform": panel.transAxes, "va": "bottom", "linespacing": 1.35}
    panel.text(0, 1.0, f"{title}\n", fontsize=9, weight="bold", **common)
    panel.text(0, 1.0, numbers, fontsize=8, **common)
