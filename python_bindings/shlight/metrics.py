# SPDX-License-Identifier: MIT
"""How far an image is from a reference, and how far the reference itself can be trusted.

Images are arrays (height, width, 3 or more); only the first three channels, linear RGB, count.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["mean_ratio", "reference_rel_mse", "rel_mse", "relative_difference", "share_within", "standard_error"]


def rel_mse(image: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Relative mean squared error: the mean of (x - r)² / (r² + 0.01 r̄²), r̄ the mean of the reference."""
    x, r = _pair(image, reference)
    return float(np.mean((x - r) ** 2 / _scale2(r)))


def relative_difference(image: npt.ArrayLike, reference: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """(h, w): mean over RGB of (x - r) / √(r² + 0.01 r̄²), signed, on the scale that `rel_mse` squares."""
    x, r = _pair(image, reference)
    difference: npt.NDArray[np.float64] = np.mean((x - r) / np.sqrt(_scale2(r)), axis=-1)
    return difference


def mean_ratio(image: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Mean of the image over the mean of the reference; NaN for a black reference."""
    x, r = _pair(image, reference)
    mean = float(r.mean())
    return float(x.mean()) / mean if mean > 0 else float("nan")


def standard_error(half_a: npt.ArrayLike, half_b: npt.ArrayLike, radius: int = 2) -> npt.NDArray[np.float64]:
    """(h, w, 3): standard error of the average of two independent renderings of the same picture.

    (a - b)² / 4 estimates the variance of (a + b) / 2, but from one degree of freedom it is itself mostly noise;
    it is averaged over the square of neighbours within `radius` pixels.
    """
    a, b = _pair(half_a, half_b, ("half_a", "half_b"))
    return np.sqrt(_box_mean((a - b) ** 2 / 4, radius))


def reference_rel_mse(half_a: npt.ArrayLike, half_b: npt.ArrayLike) -> float:
    """What `rel_mse` of a perfect image would be on average against the reference (a + b) / 2: the noise's share."""
    a, b = _pair(half_a, half_b, ("half_a", "half_b"))
    return float(np.mean((a - b) ** 2 / 4 / _scale2((a + b) / 2)))


def share_within(image: npt.ArrayLike, reference: npt.ArrayLike, error: npt.ArrayLike, *, factor: float = 3.0) -> float:
    """Share of pixels whose every channel is within `factor` standard errors of the reference.

    Differences under a millionth of the reference's mean count as none: float32 holds no more.
    """
    x, r = _pair(image, reference)
    limit = np.maximum(factor * np.asarray(error, dtype=np.float64), 1e-6 * np.abs(r).mean())
    if limit.shape != r.shape:
        raise ValueError(f"error must have the reference's shape {r.shape}, not {limit.shape}")
    return float(np.mean(np.all(np.abs(x - r) <= limit, axis=-1)))


def _pair(
    first: npt.ArrayLike, second: npt.ArrayLike, names: tuple[str, str] = ("image", "reference")
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    arrays = []
    for value, name in zip((first, second), names, strict=True):
        array = np.asarray(value, dtype=np.float64)
        if array.ndim != 3 or array.shape[2] < 3 or array.size == 0:
            raise ValueError(f"{name} must have shape (height, width, 3 or more), not {array.shape}")
        array = array[..., :3]
        if not np.isfinite(array).all():
            raise ValueError(f"{name} holds {np.count_nonzero(~np.isfinite(array))} values that are not finite")
        arrays.append(array)
    if arrays[0].shape != arrays[1].shape:
        raise ValueError(f"{names[0]} and {names[1]} differ in size: {arrays[0].shape} and {arrays[1].shape}")
    return arrays[0], arrays[1]


def _scale2(reference: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    mean2 = float(reference.mean()) ** 2
    if not mean2 > 0:
        raise ValueError("reference is black: no relative error is defined")
    return reference**2 + 0.01 * mean2


def _box_mean(values: npt.NDArray[np.float64], radius: int) -> npt.NDArray[np.float64]:
    """Mean over the (2 radius + 1)² neighbours, at the border over those that exist."""
    height, width = values.shape[:2]
    total = np.zeros_like(values)
    count = np.zeros((height, width, 1))
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            to = (slice(max(0, -dy), min(height, height - dy)), slice(max(0, -dx), min(width, width - dx)))
            source = (slice(max(0, dy), min(height, height + dy)), slice(max(0, dx), min(width, width + dx)))
            total[to] += values[source]
            count[to] += 1
    return total / count
