# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders for the preview; `command` starts it and listens to its messages.

usage: python -m shlight_blender.preview.worker <folder> <file descriptor for messages>

The folder holds request.json, the options; the pictures are written there. A message is a line of JSON:
    {"kind": "stage", "name": ..., "expected_seconds": ...}
    {"kind": "shlight", "seconds": ...}: shlight.exr is there
    {"kind": "error", "text": ..., "exit_code": ...}
    {"kind": "result", "figures": ...}
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import sys
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import numpy.typing as npt

import shlight_blender
from shlight import images

from .. import record
from .options import Options
from .reference import render_halves
from .scene import SceneError, few_pixels, open_scene, prepare, use_cycles, use_shlight, without_shadows
from .timing import SampleTime, alternate, calibrate, middle, rounds_for

PR_SET_PDEATHSIG = 1  # from linux/prctl.h

# Random seeds: no two of the pictures of Cycles may share one.
SEED_SAME_TIME, SEEDS_OF_HALVES = 0, (1, 2)


class Worker:
    """One preview: the scene, the folder for the pictures, and the channel to the command."""

    def __init__(self, options: Options, folder: Path, channel: Any) -> None:
        self._options = options
        self._folder = folder
        self._channel = channel
        self._scene: Any = None

    def run(self) -> None:
        """Renders everything and sends the figures, or an error."""
        try:
            self._send(kind="result", figures=self._figures())
        except SceneError as error:
            self._send(kind="error", text=str(error), exit_code=2)
        except RuntimeError as error:  # how Blender's operators fail
            self._send(kind="error", text=_one_line(error), exit_code=1)

    def _figures(self) -> dict[str, Any]:
        self._stage("Opening the scene")
        self._scene = open_scene(self._options.scene_file)
        bpy.ops.preferences.addon_enable(module="cycles")
        shlight_blender.register()
        prepare(self._scene, self._options)
        render = self._scene.render
        figures: dict[str, Any] = {
            "scene": {"name": self._scene.name, "frame": self._scene.frame_current},
            "size": [render.resolution_x, render.resolution_y],
            "threads": self._options.threads or len(os.sched_getaffinity(0)),
            "blender": bpy.app.version_string,
            "shlight": self._shlight(),
        }
        time_of = self._same_time(figures)
        figures["reference"] = self._reference(time_of)
        return figures

    def _shlight(self) -> dict[str, Any]:
        """shlight's picture, and what it reports of it. A render of few pixels fills its tables before."""
        self._stage("shlight")
        try:
            with few_pixels(self._scene.render):
                warm_up_seconds = self._render_shlight()
            seconds = self._render_shlight()
        except RuntimeError as error:
            if record.last.scene_error:
                raise SceneError(record.last.scene_error) from error
            raise
        if record.last.dark:
            raise SceneError(record.last.dark)
        self._save("shlight.exr")
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

    def _reference(self, time_of: SampleTime) -> dict[str, Any]:
        samples, budget = self._options.samples, self._options.reference_seconds
        expected = 2 * time_of.seconds((samples + 1) // 2)
        self._stage(f"reference, at most {samples} samples", min(expected, budget or expected))
        halves, figures = render_halves(self._part_of_half, time_of, samples, budget)
        for number, half in enumerate(halves, start=1):
            images.write_exr(self._folder / f"half_{number}.exr", half)
        return figures | {"seeds": SEEDS_OF_HALVES}

    def _render_shlight(self) -> float:
        use_shlight(self._scene, self._options)
        return _render()

    def _render_cycles(self, samples: int, seed: int, **part: int) -> float:
        use_cycles(self._scene, samples, seed, **part)
        with nullcontext() if self._scene.shlight.use_shadows else without_shadows():
            return _render()

    def _part_of_half(self, half: int, first: int, samples: int) -> tuple[float, npt.NDArray[np.float32]]:
        """See reference.Render. Blender hands a picture out through a file only; its time counts too."""
        start = time.perf_counter()
        self._render_cycles(samples, SEEDS_OF_HALVES[half], first=first, of=(self._options.samples + 1) // 2)
        image = images.read_exr(self._save("part.exr"))
        return time.perf_counter() - start, image

    def _save(self, name: str) -> Path:
        path = self._folder / name
        bpy.data.images["Render Result"].save_render(str(path), scene=self._scene)
        return path

    def _stage(self, name: str, expected_seconds: float = 0.0) -> None:
        self._send(kind="stage", name=name, expected_seconds=expected_seconds)

    def _send(self, **message: Any) -> None:
        self._channel.write(json.dumps(message) + "\n")
        self._channel.flush()


def _render() -> float:
    """Blender's own render call: wall time from the scene in Blender to the finished picture."""
    start = time.perf_counter()
    bpy.ops.render.render()
    return time.perf_counter() - start


def _one_line(error: Exception) -> str:
    return " ".join(str(error).removeprefix("Error: ").split())


def main(argv: list[str]) -> None:
    """Runs the request of the folder argv[0], messages to the open file descriptor argv[1]."""
    if sys.platform == "linux":
        # A command that is killed cannot end the worker; then the system does.
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    folder = Path(argv[0])
    request = json.loads((folder / "request.json").read_text(encoding="utf-8"))
    if request["size"] is not None:
        request["size"] = tuple(request["size"])
    with os.fdopen(int(argv[1]), "w", encoding="utf-8") as channel:
        Worker(Options(**request), folder, channel).run()


if __name__ == "__main__":
    main(sys.argv[1:])
