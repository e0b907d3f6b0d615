# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker of the panel, in another Blender.

It also leaves difference.npy (height, width), and its figures have "differences". Where no time is given for
a reference there is none, and "rel_mse_of_both".
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight import metrics

from .. import record
from ..other_blender import load_unsaved_images
from ..rendering import leave_plain, use_denoiser
from .differences import largest_differences
from .places import Finder, show_what_is_rendered
from .reference import Image
from .scene import open_blend
from .timing import SampleTime
from .worker import SEEDS_OF_HALVES, Worker, serve_with

MOST_MARKERS = 5
# Samples from which two pictures tell their noise, and the time that each of them may take for so many.
ENOUGH_FOR_NOISE, NOISE_SECONDS = 16, 5.0


class PanelWorker(Worker):
    """A frame as F12 would render it; the scene is a copy of the file."""

    def _open(self) -> Any:
        request = self._request
        open_blend(Path(request.scene), use_scripts=request.use_scripts)
        load_unsaved_images(request.images, self._folder)
        scene = bpy.context.window.scene = bpy.data.scenes[request.scene_name]
        bpy.context.window.view_layer = scene.view_layers[request.view_layer]
        for layer in scene.view_layers:
            layer.use = layer.name == request.view_layer
        return scene

    def _set_up(self) -> None:
        leave_plain(self._scene.render)
        self._scene.render.use_crop_to_border = True
        if self._request.denoise:
            use_denoiser(self._scene.cycles)  # its absence is said before anything is rendered

    def _halves(self, figures: dict[str, Any], time_of: SampleTime) -> list[Image]:
        """The reference, or two pictures that take as long as shlight's or longer and tell Cycles' noise."""
        if self._request.reference_seconds > 0:
            return super()._halves(figures, time_of)
        same = figures["cycles_same_time"]["samples"]
        samples = max(same, min(ENOUGH_FOR_NOISE, time_of.samples(NOISE_SECONDS)))
        is_half = samples == same and not self._request.denoise
        halves = [self.pictures["cycles_same_time"]] if is_half else []
        seeds = SEEDS_OF_HALVES[len(halves) :]
        self._channel.stage("Cycles' noise", len(seeds) * time_of.seconds(samples))
        for seed in seeds:
            self._render_cycles(samples, seed)
            halves.append(self._picture())
        return halves

    def _measure(self, figures: dict[str, Any], halves: list[Image]) -> None:
        shlight, against = self.pictures["shlight"], self.pictures["cycles_same_time"]
        if "reference" in figures:
            super()._measure(figures, halves)
            against = self.pictures["reference"]
        else:
            figures["rel_mse_of_both"] = metrics.rel_mse(shlight, against)
        self._leave("difference", metrics.relative_difference(shlight, against).astype(np.float32))
        figures["differences"] = self._places(shlight, halves)

    def _places(self, shlight: Image, halves: list[Image]) -> list[dict[str, Any]]:
        """The largest differences, one for each thing that is seen there."""
        layer = bpy.context.window.view_layer
        show_what_is_rendered(layer)
        finder = Finder(self._scene, layer)
        found: dict[str, dict[str, Any]] = {}
        for difference in largest_differences(shlight[::-1], (halves[0][::-1], halves[1][::-1])):
            seen = finder.seen_at(difference.x, difference.y)
            place = {"x": difference.x, "y": difference.y, "difference": difference.value}
            found.setdefault(seen.place, place | seen.to_data(record.last.report))
        return list(found.values())[:MOST_MARKERS]


def main(arguments: list[str]) -> None:
    """Serves the request of a folder."""
    serve_with(PanelWorker, arguments)
