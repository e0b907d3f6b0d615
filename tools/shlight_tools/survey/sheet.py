# SPDX-License-Identifier: MIT
"""Pictures of a survey: the strip of one file, and the contact sheet of all."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import numpy as np
import numpy.typing as npt

from shlight import images, metrics
from shlight_blender.compare.pictures import PALETTE
from shlight_blender.record import light_name

from ..preview.picture import common_exposure
from .records import Record, badness, is_measured

Pixels = npt.NDArray[np.uint8]
LIMIT = 0.2  # relative difference at the end of the colour scale: the same for all files
TALLEST = 192  # pixels of a strip on the sheet
TEXT, GAP, HEAD = 260, 8, 22  # pixels: width of the text beside a strip, space between cells, height of the heading
DPI, FONT_SIZE = 100, 8.5
CHARACTERS, LINES = 40, 11
GREY = 128
HEADING = (
    f"shlight, Cycles, and the difference: orange where shlight is darker, full at {LIMIT:.0%}; files, worst first"
)


def strip(image: npt.NDArray[np.float32], reference: npt.NDArray[np.float32]) -> Pixels:
    """shlight, Cycles and the difference side by side (height, 3 width, 3), sRGB; orange: shlight is darker."""
    from matplotlib import colormaps

    exposure = common_exposure(reference)
    shown = [images.linear_to_srgb8(picture[..., :3], exposure) for picture in (image, reference)]
    difference = metrics.relative_difference(image, reference) / LIMIT
    shown.append(np.asarray(colormaps[PALETTE](0.5 + 0.5 * difference, bytes=True))[..., :3])
    return np.concatenate(shown, axis=1)


def write_sheet(path: Path, records: list[Record], strips: dict[str, Path], size: tuple[int, int], most: int) -> None:
    """Writes the sheet of the worst `most` files (0: all), those that failed first, in grey."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = sorted(records, key=lambda record: (-badness(record), record["file"]))[: most or None]
    step = math.ceil(size[1] / TALLEST)
    height, width = math.ceil(size[1] / step), 3 * math.ceil(size[0] / step)
    cell_height, cell_width = height + GAP, width + TEXT + 2 * GAP
    columns = max(round(math.sqrt(len(shown) * cell_height / cell_width)), 1)
    rows = math.ceil(len(shown) / columns)
    sheet = np.full((HEAD + rows * cell_height + GAP, columns * cell_width + GAP, 3), 255, dtype=np.uint8)
    figure = Figure(figsize=(sheet.shape[1] / DPI, sheet.shape[0] / DPI), dpi=DPI)
    figure.text(GAP / sheet.shape[1], 1 - GAP / sheet.shape[0], HEADING, fontsize=FONT_SIZE, va="top", weight="bold")
    for number, record in enumerate(shown):
        x = GAP + number // rows * cell_width
        y = HEAD + GAP + number % rows * cell_height
        pixels = _pixels(strips.get(record["file"]), step)
        sheet[y : y + height, x : x + width] = GREY if pixels is None else pixels
        at = ((x + width + GAP) / sheet.shape[1], 1 - y / sheet.shape[0])
        figure.text(*at, _caption(record), fontsize=FONT_SIZE, va="top", parse_math=False)
    figure.figimage(sheet)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    images.write_png(path, np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., :3]))


def _pixels(path: Path | None, step: int) -> Pixels | None:
    from matplotlib.image import imread

    if path is None or not path.is_file():
        return None
    pixels: Pixels = np.round(255 * imread(path)[::step, ::step, :3]).astype(np.uint8)
    return pixels


def _caption(record: Record) -> str:
    """The name and what is known, wrapped."""
    lines = textwrap.wrap(record["file"], CHARACTERS)
    if is_measured(record):
        lines.append(f"relMSE {record['rel_mse']:.1e}, mean/ref. {record['mean_ratio']:.4f}")
        lines.append(light_name(record["max_bounces"]))
    named = (message["text"] for message in record.get("report", []))
    for text in (record["problem"], *record.get("features", []), *named):
        lines += textwrap.wrap(text, CHARACTERS)
    return "\n".join(lines[:LINES])
