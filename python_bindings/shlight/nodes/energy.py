# SPDX-License-Identifier: MIT
"""The energy that GGX microfacets and fibres reflect, over roughness, cosine of the view and index of refraction.

Cycles layers and brightens its lobes by tables of these sizes, between whose entries it interpolates linearly, and so
is it done here. Tables of GGX are kept in `energy.npz`, since integrating them takes a second or two;
shlight_tools.energy does it. Those of sheen are fits of Zeltner, Burley & Chiang 2022 to simulated fibres, of which
shlight_tools.sheen measures what Cycles draws; they are kept in `sheen.npz`.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.program import Table
from shlight.nodes.values import Number, Value, clamp, number, operation, sqrt

KEPT = Path(__file__).with_name("energy.npz")
KEPT_SHEEN = Path(__file__).with_name("sheen.npz")
LEAST_SHEEN = 1e-3  # roughness
SHEEN_STEPS = np.linspace(0.0, 1.0, 32)  # of roughness and of cosine


@lru_cache(maxsize=1)
def tables() -> dict[str, Table]:
    """The tables of `energy.npz` have the names that they have there; "sheen" is another."""
    with np.load(KEPT) as kept, np.load(KEPT_SHEEN) as kept_sheen:
        return {
            **{name: Table(kept[name]) for name in kept.files},
            "sheen": Table(kept_sheen["albedo"]),
        }


def albedo(roughness: Number, cosine: Number) -> Value:
    """Albedo of a GGX lobe without Fresnel's factor at a view."""
    return operation("table2", roughness, cosine, data=tables()["albedo"])


def mean_albedo(roughness: Number) -> Value:
    """The same over all views, weighted by their cosine."""
    return operation("table1", roughness, data=tables()["mean_albedo"])


def rise(roughness: Number, cosine: Number, ior: Number) -> Value:
    """How far Fresnel's curve has risen from its value head-on to 1, on average over the microfacets that are seen."""
    return operation("table3", roughness, cosine, _parameter(ior), data=tables()["rise"])


def _parameter(ior: Number) -> Value:
    """The place of an index in tables over it."""
    index = number(ior)
    return clamp(sqrt(abs((index - 1.0) / (index + 1.0))))


def interface(roughness: Number, cosine: Number, ior: Number, inside: Number) -> Value:
    """The share of light that a rough interface reflects or lets through at once. ior: at least 1; inside: 1 where the
    viewer is on the side of the larger index, else 0."""
    return _of_side("interface", inside, "table3", roughness, cosine, _parameter(ior))


def mean_interface(roughness: Number, ior: Number, inside: Number) -> Value:
    """The same over all views, weighted by their cosine."""
    return _of_side("mean_interface", inside, "table2", roughness, _parameter(ior))


def _of_side(name: str, inside: Number, look_up: str, *place: Number) -> Value:
    outer, inner = (operation(look_up, *place, data=tables()[own]) for own in (name, f"{name}_inside"))
    return outer + (inner - outer) * inside


def sheen(roughness: Number, cosine: Number) -> Value:
    """Albedo of fibres at a view."""
    return operation("table2", clamp(number(roughness), LEAST_SHEEN), cosine, data=tables()["sheen"])


def sheen_transform(name: Literal["a", "b"], roughness: float, cosines: NDArray[np.float64]) -> NDArray[np.float64]:
    """The number a or b of the matrix ((a, 0, b), (0, a, 0), (0, 0, 1)) that turns fibres' lobe into a cosine's."""
    with np.load(KEPT_SHEEN) as kept:
        table = kept[name].astype(np.float64)
    place = min(max(roughness, LEAST_SHEEN), 1.0) * (len(SHEEN_STEPS) - 1)
    low = min(int(place), len(SHEEN_STEPS) - 2)
    of_steps = table[:, low] + (place - low) * (table[:, low + 1] - table[:, low])
    return np.interp(cosines, SHEEN_STEPS, of_steps)
