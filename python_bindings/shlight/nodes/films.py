# SPDX-License-Identifier: MIT
"""Thin films on microfacets: Fresnel's factor with interference, as a sum of lobes.

Waves that went through the film more often than others are behind by a path difference, and a channel sees the mean of
their phases over its wavelengths (Belcour & Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of
Varying Iridescence").
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, NamedTuple, get_args

import numpy as np

from shlight._arrays import checked_name
from shlight.nodes.program import Table
from shlight.nodes.spectra import LONGEST, SHORTEST, TO_REC709, matching
from shlight.nodes.values import Color, Number, Value, Varying, clamp, color, maximum, number, select, steps, triple

FilmModel = Literal["spectral", "gaussians"]
LONGEST_PATH = 1e4  # [nm], of the core's tables
STEPS = 2048
LEAST_THICKNESS = 0.1  # [nm], below which there is no film
# The thickness [nm] below which a film's index fades to that of air.
FADES = {"spectral": 1.0, "gaussians": 30.0}
# Belcour & Barla have fitted normal distributions over 1 / wavelength to the CIE 1931 matching functions: each row is
# one of x, y or z, with its share of the whole, its place [1/m], and half its variance [1/m²].
PEAKS = (
    (0, 0.84659, 1.6810e6, 4.3278e9),
    (0, 0.15387, 2.2399e6, 4.5282e9),
    (1, 1.00022, 1.7953e6, 9.3046e9),
    (2, 1.00112, 2.2084e6, 6.6121e9),
)
# Kinds of lobes that a factor is a sum of, in the order of the core's results.
FACTORS = ("", "_linear", "_schlick", "_broad_dip", "_wide_dip", "_dip", "_narrow_dip")


class Film(NamedTuple):
    """A film on a surface."""

    thickness: Value  # [nm]
    ior: Value
    phases: Table
    below: Value  # the index of what is below, of dielectrics


def film(thickness: Number, ior: Number, model: FilmModel = "spectral") -> Film | None:
    """The film of a node's inputs; None: it has none. Raises ValueError naming an argument of the node."""
    checked_name("thin_film_model", model, get_args(FilmModel))
    d, index = number(thickness, "thin_film_thickness"), maximum(number(ior, "thin_film_ior"), 1e-5)
    if d.constant is not None and d.constant <= LEAST_THICKNESS:
        return None
    share = clamp(d / FADES[model])
    return Film(d, 1.0 + (index - 1.0) * share * share * (3.0 - 2.0 * share), phases(model), number(1.5))


@lru_cache(maxsize=2)
def phases(model: FilmModel) -> Table:
    """Means over what R, G and B see of light's phase, by path difference: three real parts, three imaginary ones."""
    to_rgb = np.array(TO_REC709)
    path = np.linspace(0.0, LONGEST_PATH, STEPS)
    if model == "spectral":
        seen = to_rgb @ matching()
        waves = np.exp(2j * np.pi * path / np.linspace(SHORTEST, LONGEST, seen.shape[1])[:, None])
        means = seen @ waves / seen.sum(axis=1, keepdims=True)
    else:
        turn = 2.0 * np.pi * path * 1e-9
        xyz = np.zeros((3, STEPS), dtype=np.complex128)
        for channel, share, place, width in PEAKS:
            xyz[channel] += share * np.exp(1j * place * turn - width * turn**2)
        # Equal energy is white.
        means = to_rgb @ (np.linalg.solve(to_rgb, np.ones(3))[:, None] * xyz)
    return Table(np.concatenate([means.real, means.imag]))


def film_factors(
    own: Film, cosine: Value, alpha: Number, n: Varying, k: Varying = 0.0, edge: Varying = -1.0, scale: Varying = 1.0
) -> list[Color]:
    """How much of each of FACTORS makes up Fresnel's factor, for a lobe of microfacets that is seen at a cosine.

    alpha: 0 gives the factor at that cosine, and then zeros. n, k: the index of what is below, by channel; edge: what a
    metal reflects at a cosine of 1/7 without film, -1 of others; scale: by what reflection along the normal is tinted.
    """
    below = [c for channel in zip(*(triple(of) for of in (n, k, edge, scale)), strict=True) for c in channel]
    found = steps("thin_film", cosine, alpha, own.thickness, own.ior, *below, data=own.phases)
    return [Color(*found[i : i + 3]) for i in range(0, len(found), 3)]


def film_passes(own: Film, cosine: Value) -> Color:
    """The light that goes through a dielectric under a film ÷ that without, seen at a cosine from outside."""
    bare = own._replace(thickness=number(0.0), ior=number(1.0))
    with_film, without = (film_factors(of, cosine, 0.0, own.below)[0] for of in (own, bare))
    return color((1.0 - with_film) / (1.0 - without))


def unless_thin(own: Film, reflected: Color, bare: Color) -> Color:
    """Chooses what a film reflects, or what there is without where it is too thin."""
    return Color(*(select(own.thickness > LEAST_THICKNESS, a, b) for a, b in zip(reflected, bare, strict=True)))
