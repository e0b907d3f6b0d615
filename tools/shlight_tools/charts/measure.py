# SPDX-License-Identifier: MIT
"""The methods as series of points, their times and their errors."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from shlight._methods import coefficient_function
from shlight_tools import methods

from .lights import Kind, Lights
from .style import styles

PRECISIONS = ("float32", "float64")
TRUTH = "reference"
SAMPLES = (64, 1024)  # of random methods
LOOSE = 1e-3  # tolerance of adaptive methods, beside what the type can hold


@dataclass(frozen=True)
class Series:
    """One method with its options: a line in a figure."""

    label: str
    method: str
    largest_order: int
    color: str
    marker: str
    dashes: str = "-"
    options: dict[str, Any] = field(default_factory=dict)

    def coefficients(self, lights: Lights, order: int, dtype: DTypeLike) -> NDArray[Any]:
        return coefficients(lights, self.method, order, dtype, **self.options)

    def errors(self, values: NDArray[Any], true: NDArray[np.float64]) -> NDArray[np.float64]:
        """relative_errors() of what coefficients() gave; true: of the same order."""
        return relative_errors(values, true)


def all_series(kind: Kind) -> list[Series]:
    """Whatever is registered for this kind of light, "exact" first: random methods with few and with many samples,
    adaptive ones to the last digit and to a loose tolerance."""
    known = {
        method.name: method
        for method in methods.coefficient_methods().values()
        if method.name != TRUTH and (method.knows_caps if kind == "sphere" else method.knows_polygons)
    }
    look = styles(list(known))
    found = []
    for name, method in known.items():
        variants: list[tuple[str, str, dict[str, Any]]] = [(name, "-", {})]
        if method.random:
            variants = [
                (f"{name}, {samples} samples", dashes, {"samples": samples})
                for samples, dashes in zip(SAMPLES, (":", "-"), strict=True)
            ]
        elif method.adaptive:
            variants.append((f"{name} to {LOOSE:g}", ":", {"tolerance": LOOSE}))
        for label, dashes, options in variants:
            found.append(Series(label, name, method.largest_order, *look[name], dashes, options))
    return found


def main_series(kind: Kind) -> list[Series]:
    """One series for each method: adaptive ones to the last digit, random ones with many samples."""
    last = {series.method: series for series in all_series(kind) if "tolerance" not in series.options}
    return list(last.values())


def coefficients(
    lights: Lights, method: str, order: int, dtype: DTypeLike, *, clip: bool = True, threads: int = 1, **options: Any
) -> NDArray[Any]:
    """(lights, order²), by the way that the package's own functions take for this method."""
    compute = coefficient_function(f"{lights.kind}_coefficients", method, **options)
    found: NDArray[Any] = compute(*(np.asarray(a, dtype=dtype) for a in lights.arrays), order, clip, threads)
    return found


def truth(lights: Lights, order: int, step: Callable[[float], None] | None = None) -> NDArray[np.float64]:
    """The coefficients in 113 bits, rounded to double; those of lower orders are the first of them."""
    parts = []
    for first in range(0, len(lights), 128):
        if step is not None:
            step(first / len(lights))
        part = lights.take(slice(first, first + 128))
        parts.append(coefficients(part, TRUTH, order, np.float64, threads=0))
    return np.concatenate(parts)


def relative_errors(
    values: NDArray[Any], true: NDArray[np.float64], least: NDArray[np.float64] | float = 0.0
) -> NDArray[np.float64]:
    """The largest |coefficient − truth| ÷ L_00 of each light; infinite where a coefficient is not finite.

    least: L_00 counts as no less. true: of the same or of a larger order.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        errors = np.abs(values.astype(np.float64) - true[:, : values.shape[1]]).max(axis=1)
    errors[~np.isfinite(values).all(axis=1)] = np.inf
    return errors / np.maximum(true[:, 0], least)


def batch_size(series: Series, lights: Lights, order: int, dtype: DTypeLike, budget: float, most: int) -> int:
    """How many lights take about `budget` seconds: 1 … most."""
    count = 1
    while True:
        batch = lights.repeated(count).in_type(dtype)
        # The smaller of two times, because the first call may initialise something.
        spent = min(_seconds(lambda b=batch: series.coefficients(b, order, dtype)) for _ in range(2))  # type: ignore[misc]
        if spent >= budget / 4 or count == most:
            return int(np.clip(count * budget / spent, 1, most))
        # A call's overhead dominates the time of so few lights.
        count = min(4 * count, most)


def best_seconds(
    all_of: Sequence[Series],
    lights: Lights,
    order: int,
    dtype: DTypeLike,
    *,
    rounds: int,
    budget: float = 0.005,
    least: int = 4,
) -> list[float]:
    """Seconds per light on one core, of the fastest of some rounds in which the series take turns: other work of the
    machine only adds to it. budget: about the seconds of one batch; least: lights in it, however slow the method is.
    NaN: above the largest order of the method."""
    works: list[tuple[Callable[[], object], int] | None] = []
    for series in all_of:
        if order > series.largest_order:
            works.append(None)
            continue
        # Batches as a user has them, whose results fit into a cache, and of slow methods more than one light, for their
        # times differ.
        most = 2**21 // order**2
        count = max(batch_size(series, lights, order, dtype, budget, most), least)
        batch = lights.repeated(count).in_type(dtype)
        works.append((lambda s=series, b=batch: s.coefficients(b, order, dtype), count))  # type: ignore[misc]
    times: list[list[float]] = [[] for _ in works]
    for turn in range(rounds):
        for work, own in zip(works, times, strict=True):
            # Three rounds suffice for slow methods.
            if work is not None and (turn < 3 or min(own) * work[1] < 4 * budget):
                own.append(_seconds(work[0]) / work[1])
    # The clock of the processor rarely misses a part: the fastest but one.
    return [sorted(own)[1] if len(own) > 1 else (own[0] if own else np.nan) for own in times]


def _seconds(work: Callable[[], object]) -> float:
    """CPU time of the work in this process, in which waiting for a core does not count."""
    start = time.process_time()
    work()
    return time.process_time() - start


def exponent(orders: Sequence[int], seconds: Sequence[float], first: int = 8) -> float:
    """p of seconds ∝ orderᵖ, fitted from order `first` on."""
    pairs = [(n, t) for n, t in zip(orders, seconds, strict=True) if n >= first and np.isfinite(t)]
    if len(pairs) < 2:
        return float("nan")
    n, t = np.log(np.array(pairs)).T
    return float(np.polyfit(n, t, 1)[0])
