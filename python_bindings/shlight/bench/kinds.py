# SPDX-License-Identifier: MIT
"""One call of each kind, for what is measured of all of them."""

from __future__ import annotations

import shlight

from . import inputs
from .rounds import Work


def works(count: int, order: int, threads: int = 1) -> dict[str, Work]:
    """By the name of the kind."""
    directions = inputs.directions(count)
    clipped, whole, mixed = (inputs.spheres(kind, count) for kind in ("clipped", "whole", "mixed"))
    quads = inputs.quads(count)
    return {
        "basis": Work(lambda: shlight.sh_basis(directions, order, threads=threads), count),
        "clipped sphere": clipped.coefficients(order, threads=threads),
        "clipped sphere, fused": clipped.fused(order, threads=threads),
        "whole sphere": whole.coefficients(order, threads=threads),
        "warped lobe": mixed.warped(order, threads=threads),
        "quad": quads.coefficients(order, threads=threads),
        "quad, fused": quads.fused(order, threads=threads),
    }
