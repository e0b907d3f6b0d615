# SPDX-License-Identifier: GPL-3.0-or-later
"""The light mixer's factors, and pictures whose lamps can be mixed by others after they are rendered.

A lamp is exported with its factor, so that a picture is right from its first pass. Light is linear: once the picture is
whole, what a lamp gives to it is multiplied by the quotient of its factor and the one it was rendered with.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .passes import SEPARATOR, Arrays, lamps_of

Pixels = NDArray[np.float32]
Factors = dict[str, tuple[float, float, float]]  # by the names of lamps; of others they are 1

ONE = (1.0, 1.0, 1.0)
# A lamp that is brightened more than this is rendered again: its noise and errors are multiplied too.
MOST_TIMES = 8.0


def factors_of(scene: Any) -> Factors | None:
    """The factors of a scene's lamps; None: its mixer is off."""
    settings = scene.shlight
    if not settings.use_light_mixer:
        return None
    rows = ((row.name, row.power * row.on, row.color) for row in settings.light_mix)
    factors = {name: tuple(float(power * channel) for channel in color) for name, power, color in rows}
    return {name: factor for name, factor in factors.items() if factor != ONE}  # type: ignore[misc]


def follow_lamps(scene: Any, view_layer: Any) -> None:
    """Gives the mixer a row for each lamp of a view layer."""
    rows, names = scene.shlight.light_mix, list(dict.fromkeys(lamps_of(view_layer)))
    known = {row.name for row in rows}
    if known == set(names):
        return
    for number in reversed(range(len(rows))):
        if rows[number].name not in names:
            rows.remove(number)
    for name in names:
        if name not in known:
            rows.add().name = name


class LightMix:
    """A picture, and what each lamp gives to it: row 0 at the bottom, RGBA in one row of numbers."""

    def __init__(self, layers: Arrays, factors: Factors) -> None:
        """factors: that the picture was rendered with."""
        self.factors = factors
        self.is_rendered = True  # the picture with these factors
        picture = layers["combined"][::-1]
        self._shape = picture.shape
        self._whole = np.ascontiguousarray(picture).reshape(len(picture), -1)
        self._lights: dict[str, Pixels] = {}
        for name, light in layers.items():
            lamp = name.removeprefix("combined_").partition(SEPARATOR)[0]
            if SEPARATOR in name and lamp:
                row = self._lights.setdefault(lamp, np.zeros_like(self._whole))
                row.reshape(self._shape)[..., :3] += light[::-1]
        self._mixed = np.empty_like(self._whole)
        self._begin()

    def _begin(self) -> None:
        self._held = self._whole.copy()  # the picture with all changes but that of one lamp
        self._moved, self._held_sum = "", dict[str, tuple[float, ...]]()
        self._changes: dict[str, tuple[float, ...]] = {}

    def apply(self, factors: Factors) -> None:
        """Takes the picture by these factors for the one by none: the lamps themselves have them from now on."""
        self._whole = self.picture(factors).reshape(len(self._whole), -1).copy()
        for name, light in self._lights.items():
            light += light * self._per_row(self._change(name, factors))
        self.factors, self.is_rendered = {}, False
        self._begin()

    def covers(self, factors: Factors) -> bool:
        """Whether the picture has the light that these factors ask for, with little more noise."""
        return all(
            own == rendered or own <= MOST_TIMES * rendered
            for name in {*factors, *self.factors}
            for own, rendered in zip(factors.get(name, ONE), self.factors.get(name, ONE), strict=True)
        )

    def picture(self, factors: Factors) -> Pixels:
        """The picture (height, width, 4) by factors that it `covers`, until the next call."""
        changes = {name: self._change(name, factors) for name in self._lights}
        # While a slider is drawn, one lamp changes and the sum of the others is kept.
        moved = next((name for name, change in changes.items() if change != self._changes.get(name)), self._moved)
        self._changes = changes
        if moved != self._moved or self._sum_of(moved) != self._held_sum:
            self._moved, self._held_sum = moved, self._sum_of(moved)
            self._held[:] = self._whole
            for name, change in self._held_sum.items():
                self._held += np.multiply(self._lights[name], self._per_row(change), out=self._mixed)
        if not moved:
            return self._held.reshape(self._shape)
        mixed = np.multiply(self._lights[moved], self._per_row(changes[moved]), out=self._mixed)
        mixed += self._held
        return np.maximum(mixed, np.float32(0.0), out=mixed).reshape(self._shape)

    def _sum_of(self, moved: str) -> dict[str, tuple[float, ...]]:
        """What is added to the picture for the other lamps."""
        return {name: change for name, change in self._changes.items() if name != moved and any(change)}

    def _change(self, lamp: str, factors: Factors) -> tuple[float, ...]:
        """How many times its part of the picture is to be added."""
        pairs = zip(factors.get(lamp, ONE), self.factors.get(lamp, ONE), strict=True)
        return tuple(own / rendered - 1.0 if rendered > 0.0 else 0.0 for own, rendered in pairs)

    def _per_row(self, change: tuple[float, ...]) -> Pixels:
        """For a whole row of pixels, since sums over four channels at a time are slow."""
        return np.tile(np.array([*change, 0.0], np.float32), self._shape[1])
