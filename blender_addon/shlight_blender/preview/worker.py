# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders for the preview; `command` starts it and listens to its messages.

usage: python -m shlight_blender.preview.worker <folder> <file descriptor for messages>

The folder holds request.json, the options; the pictures are written there. A message is a line of JSON:
    {"kind": "stage", "name": ..., "expected_seconds": ...}
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

import shlight_blender

from .. import record
from .options import Options
from .scene import SceneError, open_scene, prepare, use_cycles, use_shlight, without_shadows
from .timing import alternate, calibrate, middle, rounds_for

PR_SET_PDEATHSIG = 1  # from linux/prctl.h

# Random seeds: no two of the three Cycles pictures may share one.
SEED_SAME_TIME, SEED_FIRST_HALF, SEED_SECOND_HALF = 0, 1, 2


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
            "shlight": self._first_render(),
        }
        figures["shlight"], figures["cycles_same_time"], per_sample = self._same_time(figures["shlight"])
        figures["reference"] = self._reference(per_sample)
        return figures

    def _first_render(self) -> dict[str, Any]:
        """What shlight reports of its first render, which also fills its tables."""
        self._stage("shlight, first render")
        use_shlight(self._scene, self._options)
        try:
            seconds = _render()
        except RuntimeError as error:
            if record.last.scene_error:
                raise SceneError(record.last.scene_error) from error
            raise
        first, statistics = record.last, record.last.statistics
        return {
            "settings": first.settings,
            "unsupported": first.messages,
            "first_seconds": seconds,
            "export_seconds": first.export_seconds,
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

    def _same_time(self, shlight_figures: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], float]:
        self._stage("shlight, timing", shlight_figures["first_seconds"])
        target = self._render_shlight()
        self._stage("Cycles, finding the samples for the same time", 2 * target)
        time_of = calibrate(lambda samples: self._render_cycles(samples, SEED_SAME_TIME), target, self._options.samples)
        samples = min(time_of.samples(target), self._options.samples)
        rounds = rounds_for(target)
        self._stage(f"shlight and Cycles in turns, {rounds} times", rounds * (target + time_of.seconds(samples)))
        ours, theirs = alternate(
            self._saved(self._render_shlight, "shlight.exr"),
            self._saved(lambda: self._render_cycles(samples, SEED_SAME_TIME), "cycles_same_time.exr"),
            rounds,
        )
        return (
            shlight_figures | {"seconds": middle(ours), "times": ours},
            {"samples": samples, "seconds": middle(theirs), "times": theirs},
            time_of.per_sample,
        )

    def _reference(self, per_sample: float) -> dict[str, Any]:
        """Two independent halves; their average is the reference, their difference tells its noise."""
        half = (self._options.samples + 1) // 2
        seconds = 0.0
        for number, seed in enumerate((SEED_FIRST_HALF, SEED_SECOND_HALF), start=1):
            self._stage(f"reference, half {number} of 2, {half} samples", half * per_sample)
            render = self._saved(lambda seed=seed: self._render_cycles(half, seed), f"half_{number}.exr")
            seconds += render()
        return {"samples": 2 * half, "seconds": seconds, "seeds": [SEED_FIRST_HALF, SEED_SECOND_HALF]}

    def _render_shlight(self) -> float:
        use_shlight(self._scene, self._options)
        return _render()

    def _render_cycles(self, samples: int, seed: int) -> float:
        use_cycles(self._scene, samples, seed)
        with nullcontext() if self._scene.shlight.use_shadows else without_shadows():
            return _render()

    def _saved(self, render: Any, name: str) -> Any:
        """`render`, its picture saved afterwards, outside of its time."""

        def render_and_save() -> float:
            seconds: float = render()
            bpy.data.images["Render Result"].save_render(str(self._folder / name), scene=self._scene)
            return seconds

        return render_and_save

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
