# SPDX-License-Identifier: MIT
"""The worker of one file of a survey. It makes no picture of shlight's time, and says what it has added to the scene.

Known figures beside those of every worker: "versions", "added" and "features".
"""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import bpy

from shlight_blender.background import few_pixels
from shlight_blender.compare.reference import SampleTime
from shlight_blender.compare.render import SEED_SAME_TIME
from shlight_blender.worker_process import SceneError

from ..preview.worker import SceneWorker, serve_with
from .features import features_of
from .staging import add_camera, add_lamps, open_file

PROBE_PIXELS, PROBE_SAMPLES = 64, 4  # on the longer side; of each pixel
BLACK = 1e-5  # a picture whose every pixel is darker


class SurveyWorker(SceneWorker):
    """One file."""

    REFUSES_DARK = False

    def _open(self) -> Any:
        self._channel.known(versions={"blender": bpy.app.version_string, "shlight": metadata.version("shlight")})
        return open_file(Path(self._request.scene))

    def _set_up(self) -> None:
        super()._set_up()
        self._channel.known(added=self._stage_scene())
        self._channel.known(features=features_of(self._scene))

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
            self._render_cycles(PROBE_SAMPLES, SEED_SAME_TIME)
            return not self._picture()[..., :3].max() > BLACK

    def _same_time(self, figures: dict[str, Any]) -> SampleTime:
        return SampleTime({1: self._render_cycles(1, SEED_SAME_TIME)})


if __name__ == "__main__":
    serve_with(SurveyWorker, sys.argv[1:])
