# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders for the preview.

Its messages are those of comparison.same_time.
"""

from __future__ import annotations

import os
import sys
from typing import Any

import bpy

from shlight import images

from ..comparison.same_time import SameTimeWorker
from ..comparison.scene import open_scene
from ..comparison.timing import SampleTime
from ..comparison.worker import serve
from .options import Options


class PreviewWorker(SameTimeWorker[Options]):
    """One preview."""

    def _figures(self) -> dict[str, Any]:
        self._stage("Opening the scene")
        self._prepare(open_scene(self._options.scene_file))
        render = self._scene.render
        figures: dict[str, Any] = {
            "scene": {"name": self._scene.name, "frame": self._scene.frame_current},
            "size": [render.resolution_x, render.resolution_y],
            "threads": self._options.threads or len(os.sched_getaffinity(0)),
            "blender": bpy.app.version_string,
            "shlight": self._figures_of_shlight(),
        }
        time_of = self._same_time(figures)
        figures["reference"] = self._figures_of_reference(time_of)
        return figures

    def _figures_of_reference(self, time_of: SampleTime) -> dict[str, Any]:
        samples, budget = self._options.samples, self._options.reference_seconds
        expected = 2 * time_of.seconds((samples + 1) // 2)
        self._stage(f"reference, at most {samples} samples", min(expected, budget or expected))
        halves, figures = self._reference(time_of)
        for number, half in enumerate(halves, start=1):
            images.write_exr(self._folder / f"half_{number}.exr", half)
        return figures


if __name__ == "__main__":
    serve(PreviewWorker, Options, sys.argv[1:])
