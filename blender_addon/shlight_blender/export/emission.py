# SPDX-License-Identifier: GPL-3.0-or-later
"""Emitted light that varies over a surface, found at any places of it: what lights are cut by."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.nodes import Value, Vector
from shlight.nodes.program import ProgramBuilder
from shlight.nodes.values import Step, in_order

Array = NDArray[np.float64]
# An input of a program: its source, the index or name, and the component.
Input = tuple[str, int | str, int]
# Inputs that are opposite on the back of a surface.
TURNED = ("normal", "geometric_normal", "towards_viewer")


def divided(
    parts: list[tuple[float, Any]],
    divide: Callable[[Any], list[tuple[float, Any]]],
    enough: float,
    most: int,
) -> tuple[list[Any], float]:
    """Parts of something whose emission varies, few and of even light: always the one that deviates most is divided.

    parts: each with its squared deviation times area. divide: the same of a part's own parts; none where there are no
    smaller ones. It ends where the deviations add up to `enough`, or one division more would make more than `most`
    parts. Returns the parts, sorted, and what their deviations add up to.
    """
    waiting = [(-deviation, part) for deviation, part in parts]
    heapq.heapify(waiting)
    done: list[Any] = []
    left = sum(deviation for deviation, _ in parts)
    while waiting and left > enough:
        worst, part = heapq.heappop(waiting)
        smaller = divide(part) if worst < 0.0 else []
        if len(waiting) + len(done) + len(smaller) > most:
            done.append(part)
            break
        if not smaller:
            done.append(part)
            continue
        left += worst + sum(deviation for deviation, _ in smaller)
        for deviation, own in smaller:
            heapq.heappush(waiting, (-deviation, own))
    return sorted([*done, *(part for _, part in waiting)]), left


def share_of(squares: float, whole: float) -> float:
    """The root of squared deviations ÷ the squared radiance."""
    return float(np.sqrt(max(squares, 0.0) / whole)) if whole > 0.0 else 0.0


def of_both_sides(radiance: Array) -> Array:
    """The radiance of one or two sides, (3 or 6,), as (3,) where they are the same, else (2, 3)."""
    sides = radiance.reshape(-1, 3)
    return sides[0] if np.allclose(sides, sides[:1], rtol=1e-4, atol=0.0) else sides


@dataclass(frozen=True)
class VaryingColor:
    """Three numbers that an expression finds at each place of a surface."""

    color: Vector

    @cached_property
    def _steps(self) -> list[Step]:
        return list(in_order(value.step for value in self.color))

    @property
    def runs_scripts(self) -> bool:
        """Whether a script is run at each place, which may take long."""
        return any(step.name == "script" for step in self._steps)

    @cached_property
    def _places(self) -> list[tuple[tuple[Value, Value], tuple[float, float]]]:
        """The coordinates at which pictures are looked up, and the pictures' sizes."""
        images = [step for step in self._steps if step.name == "image"]
        return [((step.arguments[0], step.arguments[1]), step.data.core.size) for step in images]

    @cached_property
    def _program(self) -> tuple[ProgramBuilder, Any]:
        builder = ProgramBuilder()
        builder.result(tuple(self.color))
        for place, _ in self._places:
            builder.result(place)
        return builder, builder.program()

    @property
    def inputs(self) -> list[Input]:
        """The inputs that a place must supply."""
        return [step.data for step in self._steps if step.name == "input"]

    def _evaluate(self, inputs: Mapping[Input, Array], count: int) -> Array:
        builder, program = self._program
        given = []
        for source, index, component in self.inputs:
            values = np.asarray(inputs.get((source, index, component), np.zeros(count)), dtype=np.float32)
            number = builder.input_number(source, index)
            given.append(((*number, component), np.broadcast_to(values, (3, count))))
        results: Array = program.evaluate(given, count).astype(np.float64)
        return results

    def values(self, inputs: Mapping[Input, Array], count: int) -> Array:
        """The numbers (count, 3). Inputs are (count,), and what is missing is 0; or (3, count) at the places and at
        those right of and below them, between which pictures are filtered."""
        return np.nan_to_num(self._evaluate(inputs, count)[:3].T)


class VaryingEmission(VaryingColor):
    """Radiance, as linear RGB, that an expression finds at each place of a surface."""

    def radiance(self, inputs: Mapping[Input, Array], count: int) -> Array:
        """Linear RGB (count, 3), which is never negative; `inputs` are those of `values`."""
        return np.clip(self.values(inputs, count), 0.0, None)

    def of_sides(self, inputs: Mapping[Input, Array], count: int) -> Array:
        """The radiance of the front, whose inputs are given, and, if it may differ, of the back: (count, 3 or 6)."""
        front = self.radiance(inputs, count)
        if not any(source in (*TURNED, "backfacing") for source, _, _ in self.inputs):
            return front
        back = {entry: -values if entry[0] in TURNED else values for entry, values in inputs.items()}
        back |= {entry: np.ones(count) for entry in self.inputs if entry[0] == "backfacing"}
        return np.concatenate([front, self.radiance(back, count)], axis=1)

    def texels(self, inputs: Mapping[Input, Array], count: int) -> list[Array]:
        """The coordinates of look-ups in texels: (count, 2) for each picture."""
        results = self._evaluate(inputs, count)[3:]
        return [results[2 * i : 2 * i + 2].T * size for i, (_, size) in enumerate(self._places)]
