# SPDX-License-Identifier: MIT
"""Times ÷ those of the methods of the papers, in our own implementation (core/methods)."""

from __future__ import annotations

from . import inputs
from .rounds import Work
from .row import Row
from .run import Run

ORDERS = (2, 4, 8, 16, 32)
SLOW = 40  # they take so much longer: a turn of all lights would take minutes


def measure(run: Run) -> list[Row]:
    count = max(1, run.lights // SLOW)
    clipped, whole = inputs.spheres("clipped", run.lights), inputs.spheres("whole", run.lights)
    quads = inputs.quads(run.lights)
    rows = []
    for i, order in enumerate(ORDERS):
        cases: list[tuple[str, str, inputs.Spheres | inputs.Quads]] = [
            ("clipped sphere", "zhou_wei", clipped),
            ("whole sphere", "zhou_wei", whole),
            ("quad", "wang_ramamoorthi", quads),
        ]
        works: dict[str, Work] = {}
        for name, method, lights in cases:
            works[name] = lights.first(run.count(order)).coefficients(order)
            works[f"{name} by {method}"] = lights.first(count).coefficients(order, method=method)
        seconds = run.alternate(works, (i, len(ORDERS)))
        for name, method, _ in cases:
            rows.append(run.ratio(seconds, name, f"{name} by {method}", unit=f"× {method}", row=f"{name}, n = {order}"))
    return sorted(rows, key=lambda row: row.name.partition(",")[0])
