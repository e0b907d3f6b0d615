# SPDX-License-Identifier: MIT
"""Draws compared pictures side by side, with details of each, and their errors against time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from shlight import images

from .figure import Run
from .picture_measure import Call, Compared
from .style import AMBER, BLUE, DARK, canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

INSET = 0.22  # of the picture's width


def draw_strip(run: Run, done: list[Compared]) -> None:
    picture = canvas(14.5, 5.1 * len(done))
    parts = picture.subfigures(len(done), 1, squeeze=False)[:, 0]
    for part, compared in zip(parts, done, strict=True):
        part.suptitle(compared.setting.title, fontsize=14)
        _draw_scene(part, compared)
    run.save(picture, "pictures", "Equal time, harmonics, equal quality, reference; below, details of each")


def _draw_scene(part: SubFigure, compared: Compared) -> None:
    quality = "same error" if compared.reached else f"same error takes {_round(compared.samples_for_quality)}"
    reference = compared.reference
    columns = [
        ("Monte Carlo, same time", compared.equal_time.image, _said(compared.equal_time)),
        (f"Harmonics of order {compared.setting.order}", compared.shown.image, _said(compared.shown)),
        (f"Monte Carlo, {quality}", compared.equal_quality.image, _said(compared.equal_quality)),
        ("Reference", reference.image, f"{reference.samples} samples a pixel\nnoise {reference.noise:.1e}"),
    ]
    height, width = reference.image.shape[:2]
    grid = part.add_gridspec(2, 2 * len(columns), height_ratios=[height / width, 0.5])
    for i, (title, image, said) in enumerate(columns):
        assert image is not None
        pixels = images.linear_to_srgb8(image)
        panel = part.add_subplot(grid[0, 2 * i : 2 * i + 2])
        _show(panel, pixels, interpolation="antialiased")
        panel.set_title(f"{title}\n{said}", fontsize=11)
        for k, (middle, color) in enumerate(zip(compared.setting.insets, (BLUE, AMBER), strict=True)):
            corner, size = _inset(middle, width, height)
            panel.add_patch(_frame(corner, size, color))
            detail = part.add_subplot(grid[1, 2 * i + k])
            cut = pixels[corner[1] : corner[1] + size, corner[0] : corner[0] + size]
            _show(detail, cut, interpolation="nearest")
            detail.add_patch(_frame((0, 0), size, color, width=4))


def _inset(middle: tuple[float, float], width: int, height: int) -> tuple[tuple[int, int], int]:
    """Left and upper edge, and size, in pixels."""
    size = round(INSET * width)
    left, top = round(middle[0] * width - size / 2), round(middle[1] * height - size / 2)
    return (min(max(left, 0), width - size), min(max(top, 0), height - size)), size


def _frame(corner: tuple[int, int], size: int, color: str, width: float = 1.8) -> Any:
    from matplotlib.patches import Rectangle

    at = (corner[0] - 0.5, corner[1] - 0.5)
    return Rectangle(at, size, size, fill=False, edgecolor=color, linewidth=width)


def _show(panel: Axes, pixels: Any, interpolation: str) -> None:
    panel.imshow(pixels, interpolation=interpolation)
    panel.axis("off")


def _said(call: Call) -> str:
    return f"{call.effort}, {call.time}\nrelMSE {call.error}"


def draw_curves(run: Run, done: list[Compared]) -> None:
    picture = canvas(12, 5)
    panels = picture.subplots(1, len(done), sharey=True)
    for panel, compared in zip(panels, done, strict=True):
        for line in compared.lines:
            seconds = [call.seconds for call in line.calls]
            errors = [call.error for call in line.calls]
            bars = [2 * error.uncertainty for error in errors]
            below = [min(bar, 0.9 * error.bound) for bar, error in zip(bars, errors, strict=True)]
            panel.errorbar(
                seconds,
                [error.bound for error in errors],
                yerr=[below, bars],
                color=line.color,
                marker=line.marker,
                capsize=2,
                elinewidth=0.8,
                label=line.label,
            )
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(compared.setting.title)
        panel.set_xlabel("seconds, whole call, all cores")
        noise = compared.reference.noise
        panel.axhline(noise, color=DARK, lw=0.8, ls=":")
        panel.text(
            0.01, noise, "noise of the reference", transform=panel.get_yaxis_transform(), va="bottom", fontsize=9
        )
        panel.legend(loc="upper right")
    panels[0].set_ylabel("relMSE")
    run.save(picture, "pictures_curves", "Error against time")


def _round(number: float) -> str:
    return f"{float(f'{number:.2g}'):.0f}"
