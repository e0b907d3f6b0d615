# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which another Blender renders for the comparison.

Its messages are those of comparison.same_time. Left in the folder are shlight.npy, cycles_same_time.npy and, if one was
asked for, reference.npy, float32 (height, width, 4), linear, and difference.npy (height, width); row 0 at the bottom.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight import metrics

from .. import record
from ..comparison.measurements import Image, add_measurements
from ..comparison.same_time import SameTimeWorker
from ..comparison.scene import SceneError, leave_plain, open_blend, use_denoiser
from ..comparison.timing import SampleTime
from ..comparison.worker import SEEDS_OF_HALVES, read_picture, serve
from ..other_blender import load_unsaved_images
from .differences import largest_differences
from .options import CompareOptions
from .places import Finder, show_what_is_rendered

MOST_MARKERS = 5
# Samples from which two pictures tell their noise, and the time that each of them may take for so many.
ENOUGH_FOR_NOISE, NOISE_SECONDS = 16, 5.0


class CompareWorker(SameTimeWorker[CompareOptions]):
    """One comparison."""

    def _figures(self) -> dict[str, Any]:
        self._stage("Opening the scene")
        self._prepare(self._open())
        figures = {"shlight": self._figures_of_shlight()}
        time_of = self._same_time(figures)
        halves = self._halves(figures, time_of)
        self._stage("Measuring")
        try:
            self._measure(figures, halves)
        except ValueError as error:  # black or not finite
            raise SceneError(str(error)) from error
        return figures

    def _open(self) -> Any:
        options = self._options
        open_blend(Path(options.scene), use_scripts=options.use_scripts)
        load_unsaved_images(options.images, self._folder)
        scene = bpy.context.window.scene = bpy.data.scenes[options.scene_name]
        bpy.context.window.view_layer = scene.view_layers[options.view_layer]
        for layer in scene.view_layers:
            layer.use = layer.name == options.view_layer
        return scene

    def _set_up(self) -> None:
        leave_plain(self._scene.render)
        self._scene.render.use_crop_to_border = True
        if self._options.denoise:
            use_denoiser(self._scene.cycles)  # its absence is said before anything is rendered

    def _halves(self, figures: dict[str, Any], time_of: SampleTime) -> list[Image]:
        """Two independent pictures of Cycles, which tell its noise: the reference, or as long as shlight or longer."""
        budget = self._options.reference_seconds
        if budget > 0:
            self._stage("Reference", budget)
            halves, figures["reference"] = self._reference(time_of)
            return halves
        same = figures["cycles_same_time"]["samples"]
        samples = max(same, min(ENOUGH_FOR_NOISE, time_of.samples(NOISE_SECONDS)))
        is_half = samples == same and not self._options.denoise
        halves = [read_picture(self._folder / "cycles_same_time.exr")] if is_half else []
        seeds = SEEDS_OF_HALVES[len(halves) :]
        self._stage("Cycles' noise", len(seeds) * time_of.seconds(samples))
        for seed in seeds:
            self._render_cycles(samples, seed)
            halves.append(read_picture(self._save("part.exr")))
        return halves

    def _measure(self, figures: dict[str, Any], halves: list[Image]) -> None:
        pictures = {name: read_picture(self._folder / f"{name}.exr") for name in ("shlight", "cycles_same_time")}
        shlight, cycles = pictures.values()
        if "reference" in figures:
            against = pictures["reference"] = add_measurements(figures, shlight, cycles, (halves[0], halves[1]))
        else:
            against = cycles
            figures["rel_mse_of_both"] = metrics.rel_mse(shlight, cycles)
        difference = metrics.relative_difference(shlight, against)
        for name, picture in (pictures | {"difference": difference}).items():
            np.save(self._folder / f"{name}.npy", picture[::-1].astype(np.float32))
        figures["size"] = [shlight.shape[1], shlight.shape[0]]
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
    """Serves the request of a folder; see comparison.worker.serve."""
    serve(CompareWorker, CompareOptions, arguments)
