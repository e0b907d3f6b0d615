# SPDX-License-Identifier: MIT
"""The package's functions for many lights at once, each called as a user would."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal

import numpy as np

import shlight
from shlight._arrays import Floats

from .inputs import directions, disks, quads, spheres, views
from .rounds import Work

Order = int | Literal["auto"]
Call = tuple[Callable[..., object], Callable[[int], tuple[Any, ...]]]  # a function, and what it is given for so many

ORDERS = (8, 16, 32)
MATT, METAL = shlight.Bsdf.lambert(1.0), shlight.Bsdf.ggx(0.3, 1.0)
SLOW = 10  # ellipses take so much longer than other lights, at least
VIEW = 0.6  # its cosine where all lights share one


def _evaluate(points: Floats, *, order: int, threads: int) -> object:
    return shlight.evaluate(np.ones(order**2, np.float32), points, threads=threads)


KINDS: Mapping[str, Mapping[str, Call]] = {  # by section
    "basis": {
        "basis": (shlight.sh_basis, lambda n: (directions(n),)),
        "evaluate": (_evaluate, lambda n: (directions(n),)),
    },
    "spheres": {
        "clipped sphere": (shlight.sphere_coefficients, lambda n: spheres("clipped", n)),
        "clipped sphere, Lambert": (shlight.shade_spheres, lambda n: (*spheres("clipped", n), MATT, VIEW)),
        "whole sphere": (shlight.sphere_coefficients, lambda n: spheres("whole", n)),
        "cap": (shlight.cap_coefficients, lambda n: spheres("clipped", n)),
    },
    "warped": {
        "warped lobe": (shlight.shade_spheres, lambda n: (*spheres("mixed", n), METAL, views(n))),
        "warped lobe, one view": (shlight.shade_spheres, lambda n: (*spheres("mixed", n), METAL, VIEW)),
        "warped lobe, all clipped": (shlight.shade_spheres, lambda n: (*spheres("clipped", n), METAL, views(n))),
    },
    "quads": {
        "quad": (shlight.polygon_coefficients, lambda n: (quads(n),)),
        "quad, Lambert": (shlight.shade_polygons, lambda n: (quads(n), MATT, VIEW)),
        "quad, glossy": (shlight.shade_polygons, lambda n: (quads(n), METAL, views(n))),
    },
    "disks": {
        "ellipse": (shlight.disk_coefficients, lambda n: disks(n)),
        "ellipse, Lambert": (shlight.shade_disks, lambda n: (*disks(n), MATT, VIEW)),
        "ellipse, glossy": (shlight.shade_disks, lambda n: (*disks(n), METAL, views(n))),
    },
}
ALL: Mapping[str, Call] = {name: call for kinds in KINDS.values() for name, call in kinds.items()}
# Calls that also run with order "auto": their time then depends on the lights, not on an order.
AUTO = tuple(name for name in ALL if "Lambert" in name or "warped" in name or "glossy" in name)


def label(name: str, order: Order) -> str:
    """The name of a row."""
    return f"{name}, auto" if order == "auto" else f"{name}, n = {order}"


def work(name: str, count: int, order: Order, threads: int = 1) -> Work:
    """One call for so many lights, or for fewer that take long."""
    function, given = ALL[name]
    taken = max(1, count // SLOW) if name in KINDS["disks"] else count
    return Work(partial(function, *given(taken), order=order, threads=threads), taken)
