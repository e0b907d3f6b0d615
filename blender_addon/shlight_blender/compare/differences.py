# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a picture differs most from what two noisy pictures of the same thing agree on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from shlight import metrics

SMOOTHED_SHARE = 1 / 150  # of the longer side: radius over which differences are averaged twice
LEAST_DIFFERENCE = 0.01  # relative; less is hardly seen
LEAST_ERRORS = 6.0  # standard errors: of all places of a picture, none of noise alone is so far off
EDGE_PIXELS = 1.0  # by which an edge may be off, as it is where pixels have few camera rays
APART = 1 / 10  # of the longer side: nearer places count as one
MOST = 32

Image = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Difference:
    """A place [pixels from the first pixel's outer corner], and the mean relative difference around it, signed."""

    x: float
    y: float
    value: float


def largest_differences(image: Image, halves: tuple[Image, Image], most: int = MOST) -> list[Difference]:
    """The largest first, away from each other, beyond the noise that the halves tell and what edges explain.

    Pictures (height, width, 3 or more). Differences are those of `metrics.relative_difference`, averaged by a tent.
    """
    reference = (halves[0] + halves[1]) / 2
    height, width = reference.shape[:2]
    radius = max(round(SMOOTHED_SHARE * max(height, width)), 2)
    smooth = _tent(metrics.relative_difference(image, reference), radius)
    noise = np.subtract(*(metrics.relative_difference(half, reference) for half in halves)) / 2
    explained = np.maximum(
        LEAST_ERRORS * _error_of_tent(noise**2, radius), EDGE_PIXELS * _tent(_steepness(reference), radius)
    )
    strength = np.where(np.abs(smooth) > np.maximum(LEAST_DIFFERENCE, explained), np.abs(smooth), 0.0)
    apart = max(round(APART * max(height, width)), 1)
    rows, columns = np.ogrid[:height, :width]
    found: list[Difference] = []
    while len(found) < most and strength.max() > 0:
        y, x = np.unravel_index(int(np.argmax(strength)), strength.shape)
        found.append(Difference(float(x) + 0.5, float(y) + 0.5, float(smooth[y, x])))
        strength[(rows - y) ** 2 + (columns - x) ** 2 <= apart**2] = 0.0
    return found


def _tent(values: npt.NDArray[np.float64], radius: int) -> npt.NDArray[np.float64]:
    """Mean with weights that fall off linearly: a peak is in the middle of what is different."""
    return metrics.box_mean(metrics.box_mean(values, radius), radius)


def _error_of_tent(variance: npt.NDArray[np.float64], radius: int) -> npt.NDArray[np.float64]:
    """Standard error of `_tent` of pixels whose variances are estimated, each with one degree of freedom.

    Rare bright samples may be missing nearby in both halves: the wider surroundings count where they are noisier.
    """
    side = 2 * radius + 1
    weights2 = (2 * side**2 + 1) / (3 * side**3)  # sum of squares of the weights along one axis
    return weights2 * np.sqrt(np.maximum(_tent(variance, radius), _tent(variance, 3 * radius)))


def _steepness(reference: Image) -> npt.NDArray[np.float64]:
    """Relative step from a pixel to the next one, after the noise is averaged a little."""
    height, width = reference.shape[:2]
    calm = np.pad(metrics.box_mean(reference, 1), ((1, 1), (1, 1), (0, 0)), mode="edge")
    steps = (calm[2:, 1:-1] - calm[:height, 1:-1], calm[1:-1, 2:] - calm[1:-1, :width])
    return np.hypot(*(metrics.relative_difference(reference + step / 2, reference) for step in steps))
