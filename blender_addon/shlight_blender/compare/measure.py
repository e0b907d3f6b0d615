# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured of the pictures of a comparison, and where they differ most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from shlight import metrics

Image = npt.NDArray[np.float32]
Values = npt.NDArray[np.float64]

FACTOR = 3.0  # standard errors
SMOOTHED_SHARE = 1 / 150  # of the longer side: radius over which differences are averaged twice
LEAST_DIFFERENCE = 0.01  # relative; less is hardly seen
LEAST_ERRORS = 6.0  # standard errors: of all places of a picture, none of noise alone is so far off
EDGE_PIXELS = 1.0  # by which an edge may be off, as it is where pixels have few camera rays
APART = 1 / 10  # of the longer side: nearer places count as one
MOST = 32


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


@dataclass(frozen=True)
class Difference:
    """A place [pixels from the first pixel's outer corner], and the relative difference around it, signed."""

    x: float
    y: float
    value: float


def largest_differences(image: Image, halves: tuple[Image, Image], most: int = MOST) -> list[Difference]:
    """The largest first, away from each other, beyond the noise that the halves tell and what edges explain.

    Pictures (height, width, 3 or more), finite and not black. A difference is x - r over √(r² + 0.01 r̄²) of the means
    x and r of RGB, as `metrics.rel_mse` squares it. x - r and r are averaged by a tent each: a quotient of single
    pixels is biased by noise.
    """
    picture, first, second = (np.mean(each[..., :3], axis=-1, dtype=np.float64) for each in (image, *halves))
    reference = (first + second) / 2
    height, width = reference.shape
    radius = max(round(SMOOTHED_SHARE * max(height, width)), 2)
    scale = np.sqrt(_tent(reference, radius) ** 2 + 0.01 * reference.mean() ** 2)
    smooth = _tent(picture - reference, radius) / scale
    noise = _error_of_tent((first - second) ** 2 / 4, radius)
    edges = _tent(_steepness(reference), radius)
    explained = np.maximum(LEAST_ERRORS * noise, EDGE_PIXELS * edges) / scale
    # The tent filter also spreads a difference to its surroundings: only its peaks count, if the pixels there differ.
    size = np.abs(smooth)
    here = metrics.box_mean(picture - reference, 1) / scale * np.sign(smooth)
    counts = (size > np.maximum(LEAST_DIFFERENCE, explained)) & (here > size / 2) & (size >= _largest(size, radius))
    strength = np.where(counts, size, 0.0)
    apart = max(round(APART * max(height, width)), 1)
    rows, columns = np.ogrid[:height, :width]
    found: list[Difference] = []
    while len(found) < most and strength.max() > 0:
        y, x = np.unravel_index(int(np.argmax(strength)), strength.shape)
        found.append(Difference(float(x) + 0.5, float(y) + 0.5, float(smooth[y, x])))
        strength[(rows - y) ** 2 + (columns - x) ** 2 <= apart**2] = 0.0
    return found


def _tent(values: Values, radius: int) -> Values:
    """Mean with weights that fall off linearly: a peak is in the middle of what is different."""
    return metrics.box_mean(metrics.box_mean(values, radius), radius)


def _largest(values: Values, radius: int) -> Values:
    """Largest of the (2 radius + 1)² neighbours of each pixel."""
    for axis in range(2):
        padded = np.pad(values, [(radius, radius) if each == axis else (0, 0) for each in range(2)], mode="edge")
        values = np.lib.stride_tricks.sliding_window_view(padded, 2 * radius + 1, axis).max(axis=-1)
    return values


def _error_of_tent(variance: Values, radius: int) -> Values:
    """Standard error of `_tent` of pixels whose variances are estimated, each with one degree of freedom.

    Rare bright samples may be missing nearby in both halves: the wider surroundings count where they are noisier.
    """
    side = 2 * radius + 1
    weights2 = (2 * side**2 + 1) / (3 * side**3)  # sum of squares of the weights along one axis, inside the picture
    near_border = np.sqrt(np.multiply.outer(*(side / _neighbours(size, radius) for size in variance.shape[:2])))
    error: Values = weights2 * np.sqrt(np.maximum(_tent(variance, radius), metrics.box_mean(variance, 3 * radius)))
    return error * near_border


def _neighbours(size: int, radius: int) -> Values:
    """How many pixels within `radius` each pixel of a row has."""
    places = np.arange(size, dtype=np.float64)
    return np.minimum(places, radius) + np.minimum(places[::-1], radius) + 1


def _steepness(reference: Values) -> Values:
    """Step from a pixel to the next one, after the noise is averaged a little."""
    height, width = reference.shape[:2]
    calm = np.pad(metrics.box_mean(reference, 1), 1, mode="edge")
    steps = (calm[2:, 1:-1] - calm[:height, 1:-1], calm[1:-1, 2:] - calm[1:-1, :width])
    return np.hypot(*steps) / 2
