# SPDX-License-Identifier: MIT
"""How time grows with the order: p of time ∝ nᵖ between two orders."""

from __future__ import annotations

import numpy as np

from . import inputs
from .rounds import Spread, Work
from .row import Row
from .run import Run, duration

SPANS = ((16, 64), (8, 64))
BOUNDS = {("clipped sphere", (16, 64)): 2.05}


def measure(run: Run) -> list[Row]:
    orders = sorted({order for span in SPANS for order in span})
    clipped = inputs.spheres("clipped", run.lights)
    works: dict[str, Work] = {}
    for order in orders:
        few = clipped.first(run.count(order))
        works[f"clipped sphere, n = {order}"] = few.coefficients(order)
        works[f"clipped sphere, fused, n = {order}"] = few.fused(order)
    seconds = run.alternate(works)
    rows = []
    for name in ("clipped sphere", "clipped sphere, fused"):
        for low, high in SPANS:
            at_low, at_high = seconds[f"{name}, n = {low}"], seconds[f"{name}, n = {high}"]
            exponent = Spread.of(np.log(at_high / at_low) / np.log(high / low))
            detail = f"{duration(at_low)} … {duration(at_high)}"
            bound = BOUNDS.get((name, (low, high)))
            row = f"{name}, n = {low} … {high}"
            rows.append(Row.of(run.section, row, exponent, "exponent", bound=bound, detail=detail))
    return rows
