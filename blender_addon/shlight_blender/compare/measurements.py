# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured of the pictures of a comparison."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from shlight import metrics

Image = npt.NDArray[np.float32]
FACTOR = 3.0  # standard errors


def add_measurements(figures: dict[str, Any], pictures: Mapping[str, Image], halves: tuple[Image, Image]) -> Image:
    """Adds the errors of all pictures and of the reference to their figures; returns the reference."""
    reference: Image = (halves[0] + halves[1]) / 2
    error = metrics.standard_error(*halves)
    figures["reference"]["noise_rel_mse"] = metrics.reference_rel_mse(*halves)
    for name, image in pictures.items():
        rel_mse, its_error = metrics.rel_mse_without_noise(image, *halves)
        figures[name] |= {
            "rel_mse": rel_mse,
            "rel_mse_standard_error": its_error,
            "rel_mse_measured": metrics.rel_mse(image, reference),
            "mean_ratio": metrics.mean_ratio(image, reference),
            "largest_difference": float(np.abs(metrics.relative_difference(image, reference)).max()),
            "within_3_standard_errors": metrics.share_within(image, reference, error, factor=FACTOR),
        }
    return reference


def error_text(measured: dict[str, Any]) -> str:
    """relMSE without the reference's noise; where that noise hides it, what it is at most (two standard errors)."""
    value, error = measured["rel_mse"], measured["rel_mse_standard_error"]
    return f"{value:.1e} ± {error:.0e}" if value > 2 * error else f"≤ {max(value, 0.0) + 2 * error:.1e}"
