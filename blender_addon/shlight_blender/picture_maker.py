# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread behind a rendered viewport, which makes the picture of the newest state of scene and view.

It knows nothing of Blender, whose data only the main thread may read.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .frame import Frame
from .light_mix import Factors, LightMix
from .passes import denoised, with_features
from .record import status_of

LONGEST_WAIT = 5.0  # seconds, for a thread that is to end
WAITING = "Waits for the render"
LOOK_SECONDS = 0.1  # between looks whether it still does
LARGEST = 65504.0  # of the half floats that a graphics card keeps


@dataclass(frozen=True)
class Picture:
    """Some of a viewport's pixels: linear, premultiplied RGBA, row 0 at the bottom."""

    pixels: NDArray[np.float32]
    frame: Frame
    status: str
    mix: LightMix | None = None  # once it is whole, if the light mixer is on


@dataclass(frozen=True)
class Job:
    """A picture to be made."""

    scene: Any  # shlight.Scene
    frame: Frame
    settings: dict[str, Any]
    denoises: bool = False
    factors: Factors | None = None  # of the light mixer, if it is on


class PictureMaker:
    """A thread that makes the picture of the job it was given last."""

    def __init__(self, redraw: Callable[[], None], waits: Callable[[], bool] = lambda: False) -> None:
        """redraw: called from the thread when there is a new picture. waits: whether something else needs the cores."""
        self._redraw, self._waits = redraw, waits
        self._changed = threading.Condition()
        self._job: Job | None = None
        self._number = 0  # of the job; a picture of another is out of date
        self._ended = False
        self._thread: threading.Thread | None = None
        self._kept_light: Any = None  # a shlight.KeptLight, once there is a job
        self.picture: Picture | None = None
        self.error = ""

    def interrupt(self) -> None:
        """Ends the job: its scene is about to change."""
        with self._changed:
            self._number += 1
            self._job = None

    def start(self, job: Job) -> None:
        """Makes the picture of a job in place of the one before."""
        with self._changed:
            self._number += 1
            self._job = job
            self._changed.notify_all()
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="shlight viewport", daemon=True)
            self._thread.start()

    def end(self) -> None:
        with self._changed:
            self._ended = True
            self._number += 1
            self._changed.notify_all()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(LONGEST_WAIT)

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._ended and (self._job is None or self._waits()):
                    self._changed.wait(None if self._job is None else LOOK_SECONDS)
                job, number, self._job = self._job, self._number, None
            if self._ended or job is None:
                return
            self._make(job, number)

    def _make(self, job: Job, number: int) -> None:
        import shlight

        self._kept_light = self._kept_light or shlight.KeptLight()

        def show(image: NDArray[np.float32], status: str, mix: LightMix | None = None) -> bool:
            pixels = np.minimum(image[::-1], np.float32(LARGEST))
            with self._changed:
                if number != self._number:
                    return False
                self.picture = Picture(pixels, job.frame, status, mix)
                self.error = ""
            self._redraw()
            return True

        def goes_on(share: float) -> bool:
            return number == self._number and not self._waits()

        try:
            result = shlight.render(
                job.scene,
                job.frame.width,
                job.frame.height,
                kept_light=self._kept_light,
                progress=goes_on,
                on_update=lambda image, report: show(image, status_of(report)),
                **(with_features({}) if job.denoises else {}),
                groups=job.factors is not None,
                **job.settings,
            )
            layers = result.layers
            if job.denoises and show(layers["combined"], "Denoising"):
                layers = denoised(layers, "fast", job.settings["threads"], goes_on)
            show(layers["combined"], "", None if job.factors is None else LightMix(layers, job.factors))
        except shlight.RenderCancelled:
            self._keep(job, number)
        except Exception as error:
            if number == self._number:
                self.error = f"{type(error).__name__}: {error}"
                self._redraw()

    def _keep(self, job: Job, number: int) -> None:
        """Makes the picture of a job that had to wait later, unless another has come."""
        with self._changed:
            if number != self._number:
                return
            self._job = job
            if self.picture is not None:
                self.picture = replace(self.picture, status=WAITING)
        self._redraw()
