# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders; `process` starts it and reads its messages.

usage: python -m <module of the worker> <folder> <file descriptor for messages>

The folder holds request.json, the options; the pictures are written there. A message is a line of JSON:
    {"kind": "error", "text": ..., "exit_code": ...}
    {"kind": "result", "figures": ...}
and before these what the command that started the worker wants to know.
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
from typing import Any, Generic, TypeVar

import bpy
import numpy as np
import numpy.typing as npt

from .. import record
from .. import register as register_addon
from .options import RenderOptions
from .reference import render_halves
from .scene import SceneError, few_pixels, prepare, use_cycles, use_shlight, without_shadows
from .timing import SampleTime

PR_SET_PDEATHSIG = 1  # from linux/prctl.h

SEEDS_OF_HALVES = (1, 2)  # random seeds; no two pictures of Cycles may share one

Options = TypeVar("Options", bound=RenderOptions)


class Worker(Generic[Options]):
    """One scene, the folder for its pictures, and the channel to the command."""

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
        raise NotImplementedError

    def _prepare(self, scene: Any) -> None:
        """Takes a scene that Blender has opened."""
        self._scene = scene
        bpy.ops.preferences.addon_enable(module="cycles")
        register_addon()
        self._set_up()

    def _set_up(self) -> None:
        prepare(self._scene, self._options)

    def _shlight(self) -> tuple[float, float]:
        """Leaves shlight's picture in shlight.exr and what is known of it in `record`; seconds of it and its warm-up.

        The warm-up is a render of few pixels, which fills shlight's tables.
        """
        try:
            with few_pixels(self._scene.render):
                warm_up_seconds = self._render_shlight()
            seconds = self._render_shlight()
        except RuntimeError as error:
            if record.last.scene_error:
                raise SceneError(record.last.scene_error) from error
            raise
        self._save("shlight.exr")
        return seconds, warm_up_seconds

    def _reference(self, time_of: SampleTime, noise: float = 0.0) -> tuple[list[npt.NDArray[np.float32]], Any]:
        """See render_halves."""
        options = self._options
        halves, figures = render_halves(self._part_of_half, time_of, options.samples, options.reference_seconds, noise)
        return halves, figures | {"seeds": SEEDS_OF_HALVES}

    def _render_shlight(self) -> float:
        use_shlight(self._scene, self._options)
        return _render()

    def _render_cycles(self, samples: int, seed: int, **further: Any) -> float:
        use_cycles(self._scene, samples, seed, **further)
        with nullcontext() if self._scene.shlight.use_shadows else without_shadows():
            return _render()

    def _part_of_half(self, half: int, first: int, samples: int) -> tuple[float, npt.NDArray[np.float32]]:
        """See reference.Render. Blender hands a picture out through a file only; its time counts too."""
        start = time.perf_counter()
        self._render_cycles(samples, SEEDS_OF_HALVES[half], first=first, of=(self._options.samples + 1) // 2)
        image = read_picture(self._save("part.exr"))
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


def read_picture(path: Path) -> npt.NDArray[np.float32]:
    """A picture that Blender has saved: (height, width, 4), row 0 on top. Not every Blender has OpenImageIO."""
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return np.ascontiguousarray(pixels.reshape(height, width, 4)[::-1])


def _one_line(error: Exception) -> str:
    return " ".join(str(error).removeprefix("Error: ").split())


def serve(worker: type[Worker[Options]], options: type[Options], argv: list[str]) -> None:
    """Runs the request of the folder argv[0], messages to the open file descriptor argv[1]."""
    if sys.platform == "linux":
        # A command that is killed cannot end the worker; then the system does.
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    folder = Path(argv[0])
    request = json.loads((folder / "request.json").read_text(encoding="utf-8"))
    if request["size"] is not None:
        request["size"] = tuple(request["size"])
    with os.fdopen(int(argv[1]), "w", encoding="utf-8") as channel:
        worker(options(**request), folder, channel).run()
