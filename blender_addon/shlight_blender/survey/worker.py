# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders one file of a survey.

Its messages, beside those of every worker:
    {"kind": "stage", "name": ..., "expected_seconds": ...}
    {"kind": "known", "figures": ...}: what of the result is known already
"""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from shlight import images, metrics

from .. import record
from ..comparison.scene import SceneError, few_pixels
from ..comparison.timing import SampleTime
from ..comparison.worker import Worker, serve
from .features import features_of
from .options import FileOptions
from .sheet import strip
from .staging import add_camera, add_lamps, open_file

SEED_PROBE = 0  # a random seed that no half of the reference has
PROBE_PIXELS, PROBE_SAMPLES = 64, 4  # on the longer side; of each pixel
BLACK = 1e-5  # a picture whose every pixel is darker


class SurveyWorker(Worker[FileOptions]):
    """One file."""

    def run(self) -> None:
        """Runs like every worker, and also reports errors in Python."""
        try:
            super().run()
        except Exception as error:
            text = " ".join(str(error).split())
            self._send(kind="error", text=f"{type(error).__name__}: {text}", exit_code=1)
            raise

    def _figures(self) -> dict[str, Any]:
        self._known(versions={"blender": bpy.app.version_string, "shlight": metadata.version("shlight")})
        self._stage("opening the file")
        self._prepare(open_file(Path(self._options.scene)))
        self._known(added=self._stage_scene())
        self._known(features=features_of(self._scene))
        self._stage("rendering with shlight")
        seconds, warm_up_seconds = self._shlight()
        self._known(report=record.last.messages, shlight_seconds=seconds, warm_up_seconds=warm_up_seconds)
        self._stage("rendering with Cycles")
        return self._measured()

    def _stage_scene(self) -> list[str]:
        """Adds a camera and lamps where the file has none, and where it is black; says what was added."""
        added = []
        if self._scene.camera is None:
            add_camera(self._scene)
            added.append("camera")
        if self._is_black():
            add_lamps(self._scene)
            added.append("lamps")
            if self._is_black():
                raise SceneError("it is black in Cycles, even with lamps")
        return added

    def _is_black(self) -> bool:
        """True if Cycles sees nothing of the scene."""
        with few_pixels(self._scene.render, PROBE_PIXELS):
            self._render_cycles(PROBE_SAMPLES, SEED_PROBE)
            return not images.read_exr(self._save("probe.exr"))[..., :3].max() > BLACK

    def _measured(self) -> dict[str, Any]:
        """Renders the reference; measures shlight's picture, and leaves both and their strip."""
        time_of = SampleTime()
        time_of.add(1, self._render_cycles(1, SEED_PROBE))
        halves, figures = self._reference(time_of, self._options.noise)
        image, reference = images.read_exr(self._folder / "shlight.exr"), (halves[0] + halves[1]) / 2
        rel_mse, error = metrics.rel_mse_without_noise(image, *halves)
        images.write_exr(self._folder / "shlight.exr", image)
        images.write_exr(self._folder / "cycles.exr", reference)
        images.write_png(self._folder / "strip.png", strip(image, reference))
        return {
            "max_bounces": self._scene.shlight.max_bounces,
            "rel_mse": rel_mse,
            "rel_mse_standard_error": error,
            "rel_mse_measured": metrics.rel_mse(image, reference),
            "mean_ratio": metrics.mean_ratio(image, reference),
            "largest_difference": float(np.abs(metrics.relative_difference(image, reference)).max()),
            "noise_rel_mse": metrics.reference_rel_mse(*halves),
            "cycles_seconds": figures["seconds"],
            "cycles_samples": figures["samples"],
            "stopped_by": figures["stopped_by"],
        }

    def _known(self, **figures: Any) -> None:
        self._send(kind="known", figures=figures)


if __name__ == "__main__":
    serve(SurveyWorker, FileOptions, sys.argv[1:])
