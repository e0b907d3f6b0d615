# SPDX-License-Identifier: MIT
"""The energy that GGX microfacets reflect, over roughness, cosine of the view and index of refraction.

Cycles layers and brightens its lobes by tables of these sizes, between whose entries it interpolates linearly, and so
is it done here. The tables are kept in `energy.npz`, since integrating them takes a second or two; shlight_tools.energy
does it.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from shlight.nodes.program import Table
from shlight.nodes.values import Number, Value, clamp, number, operation, sqrt

KEPT = Path(__file__).with_name("energy.npz")


@lru_cache(maxsize=1)
def tables() -> dict[str, Table]:
    """The tables "albedo", "mean_albedo" and "rise"."""
    with np.load(KEPT) as kept:
        return {name: Table(kept[name]) for name in kept.files}


def albedo(roughness: Number, cosine: Number) -> Value:
    """Albedo of a GGX lobe without Fresnel's factor at a view."""
    return operation("table2", roughness, cosine, data=tables()["albedo"])


def mean_albedo(roughness: Number) -> Value:
    """The same over all views, weighted by their cosine."""
    return operation("table1", roughness, data=tables()["mean_albedo"])


def rise(roughness: Number, cosine: Number, ior: Number) -> Value:
    """How far Fresnel's curve has risen from its value head-on to 1, on average over the microfacets that are seen."""
    index = number(ior)
    parameter = sqrt(abs((index - 1.0) / (index + 1.0)))
    return operation("table3", roughness, cosine, clamp(parameter), data=tables()["rise"])
