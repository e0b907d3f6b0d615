# SPDX-License-Identifier: MIT
"""Times ÷ that of sphericart's basis of the same order, in the same rounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import shlight
from shlight import _core

from . import inputs, peer
from .rounds import Work, alternate
from .row import Row
from .run import Run

PEER = "sphericart"
UNIT = "× sphericart's basis"
Bounds = Mapping[int, float]  # by order

BASIS: Bounds = {8: 0.9, 16: 0.9, 32: 0.9}
CLIPPED: Bounds = {8: 0.5, 16: 0.4, 32: 0.3}
FUSED: Bounds = {8: 0.30, 16: 0.25, 32: 0.15}
WHOLE: Bounds = {8: 0.4, 16: 0.4, 32: 0.4}
WARPED: Bounds = {8: 0.8, 16: 0.5}
QUADS: Bounds = {8: 2.0, 16: 2.0}
AVX2, LANES = "AVX2", 2.2  # a machine with no more than this may take so much longer than the bounds


def measure_basis(run: Run) -> list[Row]:
    directions = inputs.directions(run.lights)

    def works(order: int) -> dict[str, Work]:
        return {"basis": Work(lambda: shlight.sh_basis(directions, order, threads=1), run.lights)}

    return _rows(run, works, {"basis": BASIS}) + _of_fewer(run)


def _of_fewer(run: Run) -> list[Row]:
    """What sphericart takes where its result is no larger than what the allocator keeps: beyond that it asks the system
    for memory in each call."""
    directions = inputs.directions(run.lights)
    few = directions[: run.lights // 10]
    rows = []
    for order in BASIS:
        name = f"{PEER}, n = {order}"
        works = {name: peer.basis(directions, order), "few": peer.basis(few, order)}
        rows.append(run.ratio(alternate(works, run.rounds), name, "few", unit=f"× for {len(few)}"))
    return rows


def measure_spheres(run: Run) -> list[Row]:
    clipped, whole = inputs.spheres("clipped", run.lights), inputs.spheres("whole", run.lights)

    def works(order: int) -> dict[str, Work]:
        return {
            "clipped sphere": clipped.coefficients(order),
            "clipped sphere, fused": clipped.fused(order),
            "clipped sphere, Lambert": clipped.lambert(order),
            "whole sphere": whole.coefficients(order),
        }

    bounds = {
        "clipped sphere": CLIPPED,
        "clipped sphere, fused": FUSED,
        "clipped sphere, Lambert": FUSED,
        "whole sphere": WHOLE,
    }
    return _rows(run, works, bounds)


def measure_warped(run: Run) -> list[Row]:
    lights = {kind: inputs.spheres(kind, run.lights) for kind in ("mixed", "clipped")}

    def works(order: int) -> dict[str, Work]:
        return {
            "warped lobe": lights["mixed"].warped(order),
            "warped lobe, one view": lights["mixed"].warped(order, shared_view=True),
            "warped lobe, all clipped": lights["clipped"].warped(order),
        }

    return _rows(run, works, dict.fromkeys(works(8), WARPED))


def measure_quads(run: Run) -> list[Row]:
    quads = inputs.quads(run.lights)

    def works(order: int) -> dict[str, Work]:
        return {
            "quad, fused": quads.fused(order),
            "quad, Lambert": quads.lambert(order),
            "quad": quads.coefficients(order),
        }

    return _rows(run, works, {"quad, fused": QUADS, "quad, Lambert": QUADS, "quad": dict.fromkeys(QUADS)})


def _rows(
    run: Run, works: Callable[[int], dict[str, Work]], bounds: Mapping[str, Mapping[int, float | None]]
) -> list[Row]:
    """A row for each work and order that has an entry in `bounds`."""
    directions = inputs.directions(run.lights)
    factor = LANES if _core.kernel_target() == AVX2 else 1.0
    orders = sorted({order for of_work in bounds.values() for order in of_work})
    rows = []
    for i, order in enumerate(orders):
        seconds = run.alternate({PEER: peer.basis(directions, order), **works(order)}, (i, len(orders)))
        for name, of_work in bounds.items():
            usual = of_work[order]
            bound = None if usual is None else factor * usual
            rows.append(run.ratio(seconds, name, PEER, unit=UNIT, bound=bound, row=f"{name}, n = {order}"))
    return sorted(rows, key=lambda row: list(bounds).index(row.name.rpartition(", ")[0]))
