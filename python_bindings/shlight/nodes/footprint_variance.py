# SPDX-License-Identifier: MIT
"""How much a number varies in a footprint where the noises that it is made of are their means.

A function that bends a number much, as a ramp does, needs that to give the mean of what it makes of the noise, which is
taken for normally distributed. Variances are those of the first order. Different noises are independent.
"""

from __future__ import annotations

import math
from functools import lru_cache
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.noises import FRACTALS
from shlight.nodes.program import Table
from shlight.nodes.values import Step, Value, clamp, in_order, number, operation, select, sqrt

# Standard deviations for which means are tabulated; the largest is about that of one octave.
DEVIATIONS = np.linspace(0.0, 0.16, 17)
PLACES = np.array([NormalDist().inv_cdf((i + 0.5) / 64) for i in range(64)])


@lru_cache(maxsize=4)
def _weights(count: int, interpolate: bool) -> NDArray[np.float64]:
    """Weights of a table's entries (last axis) in its means, by deviation and place; interpolate: between entries, in
    place of the entry before."""
    last = count - 1
    at = last * np.clip(np.linspace(0.0, 1.0, count) + DEVIATIONS[:, None, None] * PLACES[:, None], 0.0, 1.0)
    low = np.minimum(at.astype(int), last - 1)
    share = (at if interpolate else np.floor(at)) - low
    weights = np.zeros((len(DEVIATIONS), count, count))
    deviation, _, place = np.indices(at.shape, sparse=True)
    np.add.at(weights, (deviation, place, low), 1.0 - share)
    np.add.at(weights, (deviation, place, low + 1), share)
    return weights / len(PLACES)


class _Means(Table):
    """Means of a table over normal distributions, by their mean and deviation; `variance` is another such table."""

    def __init__(self, table: NDArray[np.float32], interpolate: bool) -> None:
        weights, values = _weights(len(table), interpolate), table.astype(np.float64)
        mean = weights @ values
        super().__init__(mean)
        self.variance = Table(np.maximum(weights @ (values * values) - mean * mean, 0.0))


def mean_of(table: NDArray[np.float32], place: Value, exact: Value, variance: Value, *, interpolate: bool) -> Value:
    """The mean of a table over 0 … 1 where the number that it is read at varies around `place`; exact: what it has for
    one that does not; interpolate: between entries, in place of the entry before."""
    deviation = clamp(sqrt(variance) * (1.0 / DEVIATIONS[-1]))
    return select(variance > 0.0, operation("table2", place, deviation, data=_Means(table, interpolate)), exact)


class _Varying(NamedTuple):
    """A variance, and the ids of the noises that make it."""

    variance: Value
    noises: frozenset[int]


def unresolved_variance(value: Value) -> Value | None:
    """The variance; None where no noise is known to make it other than 0."""
    known: dict[Step, _Varying | None] = {}
    for step in in_order([value.step]):
        given = [known[argument.step] for argument in step.arguments]
        known[step] = _of_noise(step) if step.name.startswith("noise") else _propagated(step, given)
    found = known[value.step]
    return None if found is None else found.variance


def _of_noise(step: Step) -> _Varying | None:
    count, kind = int(step.name.removeprefix("noise")), FRACTALS[step.data]
    octaves, roughness = (argument.constant for argument in step.arguments[count : count + 2])
    if kind == "fbm":
        scale = 0.5
    elif kind in ("fbm_sum", "musgrave_sum") and octaves is not None and roughness is not None:
        scale = sum(min(octaves - i, 1.0) * roughness**i for i in range(math.ceil(octaves)))
    else:
        return None
    # Without the longer axis of the footprint, along which a mean is of several places.
    loss = operation(step.name, *step.arguments[:-count], *([0.0] * count), data=FRACTALS.index("fbm_loss"))
    return _Varying(loss * (scale * scale), frozenset({id(step)}))


def _propagated(step: Step, given: list[_Varying | None]) -> _Varying | None:
    varying = [each for each in given if each is not None]
    if not varying:
        return None
    noises = frozenset().union(*(each.noises for each in varying))
    if step.name == "table2" and isinstance(step.data, _Means):
        return _Varying(operation("table2", *step.arguments, data=step.data.variance), noises)
    v = [number(0.0) if each is None else each.variance for each in given]
    a = step.arguments
    if step.name == "multiply":
        v = [a[1] * a[1] * v[0], a[0] * a[0] * v[1]]
    elif step.name == "divide":
        v = [v[0] / (a[1] * a[1])]
    elif step.name == "select":
        v = [select(a[0], v[1], v[2])]
    elif step.name not in _SUMS:
        return None
    # Deviations that one noise makes add up, as where a grey becomes its luminance.
    is_shared = len(varying) == 2 and not varying[0].noises.isdisjoint(varying[1].noises)
    total = 2.0 * sqrt(v[0] * v[1]) if is_shared and len(v) == 2 else number(0.0)
    return _Varying(sum(v, start=total), noises)


# A clamped number is taken for one that is not.
_SUMS = ("add", "subtract", "minimum", "maximum", "absolute")
