# SPDX-License-Identifier: MIT
"""How far an image is from a reference, and how far the reference itself can be trusted.

Images are arrays (height, width, 3 or more); only the first three channels, linear RGB, count.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from shlight._arrays import check_finite, checked_array, checked_integer, checked_number

__all__ = [
    "box_mean",
    "mean_ratio",
    "reference_rel_mse",
    "rel_mse",
    "rel_mse_without_noise",
    "relative_difference",
    "share_within",
    "standard_error",
]


def rel_mse(image: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Relative mean squared error: the mean of (x - r)² / (r² + 0.01 r̄²), r̄ the mean of the reference.

    >>> round(shlight.metrics.rel_mse(np.full((2, 2, 3), 1.1), np.ones((2, 2, 3))), 4)
    0.0099
    """
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
    return np.sqrt(box_mean((a - b) ** 2 / 4, radius))


def reference_rel_mse(half_a: npt.ArrayLike, half_b: npt.ArrayLike) -> float:
    """The expected `rel_mse` of a perfect image against the reference (a + b) / 2: the reference's noise."""
    a, b = _pair(half_a, half_b, ("half_a", "half_b"))
    return float(np.mean((a - b) ** 2 / 4 / _scale2((a + b) / 2)))


def rel_mse_without_noise(image: npt.ArrayLike, half_a: npt.ArrayLike, half_b: npt.ArrayLike) -> tuple[float, float]:
    """`rel_mse` against the truth of which a and b are independent renderings of equal variance; its standard error.

    `rel_mse` against r = (a + b) / 2 also counts the noise of r. Here it is the mean over pixels and channels of

        (x - a)(x - b) (1 / s(a) + 1 / s(b)) / 2,    s(v) = v² + 0.01 r̄².

    With δ the error of x and e, f the noise of a and b, one of the two terms is (δ - e) / s(a) times δ - f, and these
    are independent: its expectation is δ E[(δ - e) / s(a)]. It vanishes with δ, however the noise is distributed, and
    is else δ² / s up to the relative variance of the noise. `rel_mse` less `reference_rel_mse` has the same numerator,
    (x - r)² - (a - b)² / 4, but divides by s(r), which the noise of both factors moves: for a perfect image that
    leaves E[ef / s(r)], which the square of the noise's variance and its skewness decide.

    The value scatters around the true one and may be negative. For Gaussian noise of variance v in r the variance of
    the numerator is 4δ²v + 4v², the expectation of (x - r)² (a - b)²; the standard error is the root of the sum of
    that over pixels, each the mean of its channels, whose noise is one. A firefly of a half is not clamped: it counts
    once, not squared, and makes the standard error larger.
    """
    x, a = _pair(image, half_a, ("image", "half_a"))
    x, b = _pair(image, half_b, ("image", "half_b"))
    r = (a + b) / 2
    mean = float(r.mean())
    weight = (1 / _scale2(a, mean) + 1 / _scale2(b, mean)) / 2
    spread = np.mean((x - r) * (a - b) * weight, axis=-1)
    return float(np.mean((x - a) * (x - b) * weight)), float(np.sqrt(np.sum(spread**2)) / spread.size)


def share_within(image: npt.ArrayLike, reference: npt.ArrayLike, error: npt.ArrayLike, *, factor: float = 3.0) -> float:
    """Share of pixels whose every channel is within `factor` standard errors of the reference.

    Differences under a millionth of the reference's mean count as none: float32 holds no more.
    """
    x, r = _pair(image, reference)
    limit = np.maximum(
        checked_number("factor", factor) * checked_array("error", error, np.float64), 1e-6 * np.abs(r).mean()
    )
    if limit.shape != r.shape:
        raise ValueError(f"error must have the reference's shape {r.shape}, not {limit.shape}")
    return float(np.mean(np.all(np.abs(x - r) <= limit, axis=-1)))


def _pair(
    first: npt.ArrayLike, second: npt.ArrayLike, names: tuple[str, str] = ("image", "reference")
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    arrays = []
    for value, name in zip((first, second), names, strict=True):
        array = checked_array(name, value, np.float64)
        if array.ndim != 3 or array.shape[2] < 3 or array.size == 0:
            raise ValueError(f"{name} must have shape (height, width, 3 or more), not {array.shape}")
        array = array[..., :3]
        check_finite(name, array)
        arrays.append(array)
    if arrays[0].shape != arrays[1].shape:
        raise ValueError(f"{names[0]} and {names[1]} differ in size: {arrays[0].shape} and {arrays[1].shape}")
    return arrays[0], arrays[1]


def _scale2(reference: npt.NDArray[np.float64], mean: float | None = None) -> npt.NDArray[np.float64]:
    mean = float(reference.mean()) if mean is None else mean
    if not mean**2 > 0:
        raise ValueError("reference is black: no relative error is defined")
    return reference**2 + 0.01 * mean**2


def box_mean(values: npt.ArrayLike, radius: int) -> npt.NDArray[np.float64]:
    """Mean over the (2 radius + 1)² neighbours of pixels (height, width, …), at the border over those that exist."""
    mean = checked_array("values", values, np.float64, core_axes=2)
    radius = checked_integer("radius", radius, 0, 2**31 - 1)
    for axis in range(2):
        mean = np.moveaxis(mean, axis, 0)
        size = len(mean)
        total, count = np.zeros_like(mean), np.zeros((size, *[1] * (mean.ndim - 1)))
        for step in range(-min(radius, size - 1), min(radius, size - 1) + 1):
            to = slice(max(0, -step), min(size, size - step))
            source = slice(max(0, step), min(size, size + step))
            total[to] += mean[source]
            count[to] += 1
        mean = np.moveaxis(total / count, 0, axis)
    return mean
