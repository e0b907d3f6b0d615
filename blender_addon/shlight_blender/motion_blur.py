# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur: the mean of pictures of several times while the shutter is open."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .compat import shutter_position
from .passes import Arrays

Pixels = NDArray[np.float32]

CURVE_POINTS = 257
LEAST_SAMPLES = 4  # of a pixel at each time, unless fewer are asked for in all: one goes through its middle
# Passes that have no mean, or are of the first thing that is met; they are those of the middle of all times.
OF_ONE_TIME = ("depth", "object_index", "material_index", "cryptomatte")


def times_of(scene: Any, view_layer: Any) -> list[float]:
    """Times at which a picture is taken, in frames after the scene's; they weigh alike. [0] without motion blur."""
    render = scene.render
    if not (render.use_motion_blur and getattr(view_layer, "use_motion_blur", True)):
        return [0.0]
    shares = _quantiles(render.motion_blur_shutter_curve, int(scene.shlight.motion_times))
    return [middle_of(scene) + float(render.motion_blur_shutter * (share - 0.5)) for share in shares]


def middle_of(scene: Any) -> float:
    """The middle of the time while the shutter is open, in frames after the scene: of it is all that is not blurred."""
    position = {"START": 0.5, "CENTER": 0.0, "END": -0.5}[shutter_position(scene)]
    return float(position * scene.render.motion_blur_shutter)


def _quantiles(curve: Any, count: int) -> NDArray[np.float64]:
    """Places, 0 … 1, between which equal parts of the area below a curve lie."""
    curve.initialize()
    places = np.linspace(0.0, 1.0, CURVE_POINTS)
    heights = np.array([max(curve.evaluate(curve.curves[0], place), 0.0) for place in places])
    below = np.concatenate([[0.0], np.cumsum(0.5 * (heights[1:] + heights[:-1]))])
    if not below[-1] > 0.0:  # as a shutter that is open all the time
        below = places
    return np.interp((np.arange(count) + 0.5) / count, below / below[-1], places)


def settings_of(settings: Mapping[str, Any], number: int, count: int) -> dict[str, Any]:
    """Arguments of `shlight.render` for picture `number` of `count`, whose mean has the samples and noise asked for."""
    if count == 1:
        return dict(settings)
    shared = {
        name: min(max(math.ceil(settings[name] / count), LEAST_SAMPLES), settings[name])
        for name in ("min_samples", "max_samples", "pixel_samples")
        if settings[name] is not None
    }
    limit = settings["time_limit"]
    return {
        **settings,
        **shared,
        "noise_threshold": min(settings["noise_threshold"] * math.sqrt(count), 1.0),
        "time_limit": limit and limit / count,
        "seed": number,
    }


class MeanPicture:
    """The mean of the pictures of a number of times, and of their passes."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._added = 0
        self.layers: Arrays = {}  # of all pictures that were added

    def add(self, layers: Arrays) -> None:
        """Adds the picture of the next time."""
        number, self._added = self._added, self._added + 1
        if number == 0:
            self.layers = layers
            return
        own = dict(self.layers)
        for name, pixels in layers.items():
            if not name.startswith(OF_ONE_TIME):
                own[name] = own[name] + (pixels - own[name]) / self._added
            elif number == self._count // 2:
                own[name] = pixels
        self.layers = own

    def shown(self, image: Pixels) -> Pixels:
        """The mean as it is with an unfinished picture of the next time."""
        if self._added == 0:
            return image
        before = self.layers["combined"]
        return before + (image - before) / (self._added + 1)

    def progress(self, tell: Callable[[float], bool]) -> Callable[[float], bool]:
        """`tell` of the share of all pictures, for the next one's progress."""
        return lambda share: tell((self._added + share) / self._count)
