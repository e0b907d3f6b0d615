# SPDX-License-Identifier: MIT
"""A sheet of scenes whose light bounces: what a user sees of each soon and at the end, beside full Cycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from shlight import images
from shlight.metrics import rel_mse_without_noise

from .picture_renderers import Cycles, Image, Renderer, Shlight

SOON, LATEST = 1.0, 20.0  # seconds
PANEL = 2.35  # inches
WHITE = 0.8  # of few of a row's pixels, at least
JPEG = {"quality": 88}


@dataclass(frozen=True)
class Panel:
    """A picture of a scene; error: its relMSE, or None for the reference."""

    title: str
    seconds: float
    image: Image
    error: float | None = None

    @property
    def label(self) -> str:
        """Its title and, below, how long it took and how far it is off."""
        return self.title if self.error is None else f"{self.title}, {self.seconds:.1f} s\nrelMSE {self.error:.1e}"


def panels(renderers: Sequence[Renderer], halves: tuple[Image, Image]) -> list[Panel]:
    """The row of a scene. halves: full Cycles."""
    shown: list[Panel] = []

    def add(title: str, seconds: float, image: Image) -> None:
        shown.append(Panel(title, seconds, image, max(rel_mse_without_noise(image, *halves)[0], 0.0)))

    for renderer in renderers:
        if isinstance(renderer, Shlight):
            add(renderer.name, *renderer.picture(SOON))
            if renderer.denoised:
                continue
            seconds, image = renderer.picture(LATEST)
            add(f"{renderer.name}, whole" if seconds < LATEST else renderer.name, seconds, image)
        elif isinstance(renderer, Cycles) and renderer.denoised:
            add(renderer.name, *list(renderer.pictures(SOON))[-1])
    reference = np.mean(halves, axis=0, dtype=np.float32)
    return [*shown, Panel("Cycles, converged", math.inf, reference)]


def draw(path: Path, rows: dict[str, list[Panel]]) -> None:
    """Writes the rows, each under its scene's name, with one exposure for all pictures of a row."""
    from shlight_tools.charts.style import canvas, look

    columns = max(len(row) for row in rows.values())
    with look():
        figure = canvas(PANEL * columns, (PANEL + 0.45) * len(rows))
        axes = figure.subplots(len(rows), columns, squeeze=False)
        for axis in axes.flat:
            axis.axis("off")
        for (name, row), line in zip(rows.items(), axes, strict=True):
            bright = float(np.percentile(row[-1].image[..., :3].max(axis=-1), 95))
            exposure = math.log2(WHITE / bright) if bright > 0 else 0.0
            for i, (panel, axis) in enumerate(zip(row, line, strict=False)):
                axis.imshow(images.linear_to_srgb8(panel.image[..., :3], exposure), interpolation="antialiased")
                axis.set_title(f"{name}: {panel.label}" if i == 0 else panel.label, fontsize=8)
        figure.savefig(path, pil_kwargs=JPEG)
