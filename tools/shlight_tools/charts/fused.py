# SPDX-License-Identifier: MIT
"""Series of the calls that give reflected radiance at once (Eq. 5), beside those that give coefficients."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

import shlight
from shlight._arrays import MAX_ORDER

from .lights import Kind, Lights
from .measure import Series
from .style import BLUE, SKY

LIBRARY = "exact"
COS_VIEW = 0.6
ROUGHNESS = 0.3


@dataclass(frozen=True)
class Fused(Series):
    """shade_spheres and shade_polygons at a fixed order. Their "coefficients" are a column: the radiance."""

    glossy: bool = False

    def coefficients(self, lights: Lights, order: int, dtype: DTypeLike) -> NDArray[Any]:
        given = [np.asarray(array, dtype=dtype) for array in lights.arrays]
        views: float | NDArray[Any] = COS_VIEW
        bsdf = shlight.Bsdf.lambert(1.0)
        if self.glossy:
            # Views differ, like those of a picture's hits, and so do their warps.
            views, bsdf = np.linspace(0.05, 1, len(lights)), shlight.Bsdf.ggx(ROUGHNESS, 1.0)
        call: Any = shlight.shade_spheres if lights.kind == "sphere" else shlight.shade_polygons
        shaded: NDArray[Any] = call(*given, bsdf, views, order=order, threads=1)
        return shaded[:, :1]

    def errors(self, values: NDArray[Any], true: NDArray[np.float64]) -> NDArray[np.float64]:
        """Errors under Lambert's lobe, a harmonic of band 1; its fit of order 1 is the mean over the hemisphere."""
        mean, slope = math.sqrt(4 * math.pi) / (2 * math.pi), math.sqrt(4 * math.pi / 3) / math.pi
        columns = true.shape[1]
        radiance = mean * true[:, 0] if columns == 1 else slope * true[:, 2]
        errors: NDArray[np.float64] = abs(values[:, 0] - radiance) / true[:, 0]
        errors[~np.isfinite(values[:, 0])] = np.inf
        return errors


def fused_series(precision: str) -> list[Series]:
    """The library's shading with Lambert's lobe, for all kinds of lights; it exists in float32 only."""
    if precision != "float32":
        return []
    return [Fused("exact, with Eq. 5", LIBRARY, MAX_ORDER, BLUE, "*", ":")]


def glossy_series(kind: Kind, precision: str) -> list[Series]:
    """Under a glossy lobe, warp and table included."""
    if precision != "float32" or kind != "sphere":
        return []
    return [Fused("glossy lobe, with Eq. 5", LIBRARY, MAX_ORDER, SKY, "*", ":", glossy=True)]
