# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders for the preview.

Its messages, beside those of every worker:
    {"kind": "stage", "name": ..., "expected_seconds": ...}
    {"kind": "shlight", "seconds": ...}: shlight.exr is there
"""

from __future__ import annotations

import os
import sys
from typing import Any

import bpy

from shlight import images

from .. import record
from ..comparison.scene import SceneError, open_scene
from ..comparison.timing import SampleTime, alternate, calibrate, middle, rounds_for
from ..comparison.worker import Worker, serve
from .options import Options

SEED_SAME_TIME = 0  # a random seed that no half of the reference has


class PreviewWorker(Worker[Options]):
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

    def _figures_of_shlight(self) -> dict[str, Any]:
        """shlight's picture, and what it reports of it."""
        self._stage("shlight")
        seconds, warm_up_seconds = self._shlight()
        if record.last.dark:
            raise SceneError(record.last.dark)
        self._send(kind="shlight", seconds=seconds)
        made, statistics = record.last, record.last.statistics
        return {
            "settings": made.settings,
            "unsupported": made.messages,
            "warm_up_seconds": warm_up_seconds,
            "times": [seconds],
            "export_seconds": made.export_seconds,
            "build_seconds": statistics.build_seconds,
            "render_seconds": statistics.render_seconds,
            "stage_seconds": statistics.stage_seconds,
            "order_shares": {str(order): share for order, share in statistics.order_shares.items()},
            "cubature_share": statistics.cubature_share,
            "mirror_share": statistics.mirror_share,
            "over_tolerance": statistics.over_tolerance,
            "summed_lights": statistics.summed_lights,
            "hits": statistics.hits,
            "shadow_rays": statistics.shadow_rays,
            "operations": made.operations,
            "texture_bytes": made.texture_bytes,
        }

    def _same_time(self, figures: dict[str, Any]) -> SampleTime:
        """Cycles at the samples that take shlight's time; what takes little time is repeated in turns."""
        ours = figures["shlight"]["times"]
        target = ours[0]
        self._stage("Cycles, finding the samples for the same time", target / 2)
        time_of = calibrate(lambda samples: self._render_cycles(samples, SEED_SAME_TIME), target, self._options.samples)
        samples = min(time_of.samples(target), self._options.samples)
        rounds = rounds_for(target)
        again = f", and in turns with shlight {rounds - 1} times more" if rounds > 1 else ""
        self._stage(f"Cycles, same time: {samples} samples{again}", (2 * rounds - 1) * target)
        theirs = [self._render_cycles(samples, SEED_SAME_TIME)]
        self._save("cycles_same_time.exr")
        more = alternate(self._render_shlight, lambda: self._render_cycles(samples, SEED_SAME_TIME), rounds - 1)
        ours += more[0]
        theirs += more[1]
        time_of.add(samples, middle(theirs))
        figures["shlight"]["seconds"] = middle(ours)
        figures["cycles_same_time"] = {"samples": samples, "seconds": middle(theirs), "times": theirs}
        return time_of

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
