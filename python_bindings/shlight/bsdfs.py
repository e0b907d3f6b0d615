# SPDX-License-Identifier: MIT
"""Materials of many points: what differs from one to the other stands in arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight import _core
from shlight._arrays import broadcast, check_last, check_rows, checked_array, rows

LARGEST_COLOR = 1e10  # docs/conventions.md

Singles = NDArray[np.float32]


@dataclass(frozen=True, eq=False, repr=False)
class Bsdfs:
    """Materials of many points: sums of coloured lobes f·cos whose colours and roughness are arrays.

    What takes them, shade_spheres and its like, broadcasts their leading axes with those of lights and views. They can
    be added to one another and to a Bsdf, and multiplied by a number or colours (..., 3). They are immutable. Colours
    are 0 … 1e10, float32.

    >>> wood = shlight.Bsdfs.lambert([[0.4, 0.2, 0.1], [0.5, 0.3, 0.2]]) + shlight.Bsdfs.ggx([0.2, 0.6], 0.04)
    >>> wood
    Bsdfs(shape (2,), 3 lobes)
    >>> shlight.shade_spheres([0, 0, 2], 0.5, wood, cos_theta_o=0.8).shape
    (2, 3)
    """

    _lobes: _core.Bsdf  # of colour 1
    _colors: Singles  # (..., lobes, 3)
    _alphas: Singles  # (..., lobes); of lobes without a roughness they mean nothing

    __array_ufunc__ = None  # an array of numpy times these are these

    @staticmethod
    def lambert(albedo: ArrayLike) -> Bsdfs:
        """Diffuse: f·cos = albedo · cosθ_i / π. albedo: a number, (3,) or (..., 3)."""
        return Bsdfs(*_parts(_core.Bsdf.lambert(1.0))) * _colors("albedo", albedo)

    @staticmethod
    def ggx(roughness: ArrayLike, f0: ArrayLike, *, ior: float | None = None) -> Bsdfs:
        """GGX microfacets as of Bsdf.ggx.

        roughness: (...), 0 … 1; below 0.003 as at 0.003. f0: a number, (3,) or (..., 3). ior: the same for all.
        Raises ValueError naming the argument and its row.
        """
        width = checked_array("roughness", roughness, np.float64)
        _check("roughness", width, 1.0, core_axes=0)
        color = _colors("f0", f0)
        lobes = _core.varying_ggx(ior)
        _, ones, _ = _parts(lobes)
        alpha = np.square(np.maximum(width, _core.LEAST_ROUGHNESS).astype(np.float32))
        broadcast(roughness=width.shape, f0=color.shape[:-1])
        colors = np.stack([color, 1 - np.minimum(color, 1)][: len(ones)], axis=-2)
        return Bsdfs(lobes, colors, np.stack([alpha] * len(ones), axis=-1))

    @property
    def shape(self) -> tuple[int, ...]:
        """The leading axes of the arrays."""
        return np.broadcast_shapes(self._colors.shape[:-2], self._alphas.shape[:-1])

    @property
    def is_anisotropic(self) -> bool:
        """Whether the azimuth of the view from the surface's tangent on matters."""
        return self._lobes.is_anisotropic

    def __add__(self, other: Bsdfs | _core.Bsdf) -> Bsdfs:
        if isinstance(other, _core.Bsdf):
            other = Bsdfs(*_parts(other))
        elif not isinstance(other, Bsdfs):
            return NotImplemented
        broadcast(bsdf=self.shape, other=other.shape)
        colors = _joined(self._colors, other._colors, -2)
        return Bsdfs(self._lobes + other._lobes, colors, _joined(self._alphas, other._alphas, -1))

    def __radd__(self, other: _core.Bsdf | Literal[0]) -> Bsdfs:  # sum() begins with 0
        if isinstance(other, _core.Bsdf):
            return Bsdfs(*_parts(other)) + self
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __mul__(self, factor: ArrayLike) -> Bsdfs:
        by = _colors("factor", factor)
        broadcast(bsdf=self.shape, factor=by.shape[:-1])
        colors = self._colors * by[..., None, :]
        _check("factor times the material's own colour", colors, LARGEST_COLOR, core_axes=2)
        return replace(self, _colors=colors)

    def __rmul__(self, factor: ArrayLike) -> Bsdfs:
        return self * factor

    def __repr__(self) -> str:
        return f"Bsdfs(shape {self.shape}, {self._colors.shape[-2]} lobes)"


def lobes_of_rows(bsdf: Bsdfs, shape: tuple[int, ...]) -> tuple[_core.Bsdf, Singles, Singles]:
    """The core takes lobes, colours (n, lobes, 3) and alphas (n, lobes) for the n rows of a shape."""
    count = bsdf._colors.shape[-2]
    return bsdf._lobes, rows(bsdf._colors, shape, count, 3), rows(bsdf._alphas, shape, count)


def _parts(bsdf: _core.Bsdf) -> tuple[_core.Bsdf, Singles, Singles]:
    lobes, colors = _core.uncolored(bsdf)
    return lobes, colors, np.ones(len(colors), np.float32)


def _joined(a: Singles, b: Singles, axis: int) -> Singles:
    """Two arrays one after the other along an axis, once those before it are broadcast."""
    shape = np.broadcast_shapes(a.shape[:axis], b.shape[:axis])
    return np.concatenate([np.broadcast_to(own, (*shape, *own.shape[axis:])) for own in (a, b)], axis=axis)


def _colors(name: str, value: ArrayLike) -> Singles:
    """(..., 3)"""
    array = checked_array(name, value, np.float32)
    if array.ndim == 0:
        array = np.full(3, array)
    check_last(name, array, 3)
    _check(name, array, LARGEST_COLOR, core_axes=1)
    return array


def _check(name: str, array: NDArray[Any], largest: float, core_axes: int) -> None:
    good = ((array >= 0) & (array <= largest)).all(axis=tuple(range(-core_axes, 0)))
    check_rows(name, good, f"must lie in [0, {largest:g}]")
