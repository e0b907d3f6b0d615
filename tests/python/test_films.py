# SPDX-License-Identifier: MIT
"""Thin films: Fresnel's factor against sums of all waves at each wavelength, and what lobes reflect of it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from test_lobes import LIGHTS, VIEW, in_cone, microfacets, radiance

from shlight import nodes
from shlight.nodes import films
from shlight.nodes.program import ProgramBuilder
from shlight.nodes.spectra import LONGEST, SHORTEST, TO_REC709, matching
from shlight.nodes.values import Step, Value

Doubles = NDArray[np.float64]
VIEWS = np.linspace(0.02, 1.0, 50)
CASES = [(100.0, 1.33, 1.5), (300.0, 1.33, 1.5), (550.0, 1.8, 1.5), (1000.0, 2.4, 1.3), (400.0, 1.4, 0.18 + 3.42j)]


def interface(a: complex, b: complex, sine: Doubles) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Amplitudes reflected from b towards a, perpendicular and parallel; sine: in air, whose index is 1."""
    near, far = (np.sqrt(1 - (sine / index) ** 2 + 0j) for index in (a, b))
    return (a * near - b * far) / (a * near + b * far), (b * near - a * far) / (b * near + a * far)


def exact(cosines: Doubles, thickness: float, index: float, below: complex, wavelengths: Doubles) -> Doubles:
    """(cosines, wavelengths): the reflectance with waves of all orders, wavelengths in nm."""
    sine = np.sqrt(1 - cosines**2)
    path = 2 * thickness * np.sqrt(index**2 - sine**2)
    turn = np.exp(2j * np.pi * path[:, None] / wavelengths)
    pairs = zip(interface(1.0, index, sine), interface(index, below, sine), strict=True)
    waves = [(a[:, None] + b[:, None] * turn) / (1 + (a * b)[:, None] * turn) for a, b in pairs]
    return np.asarray(sum(abs(wave) ** 2 for wave in waves) / 2)


def seen(cosines: Doubles, thickness: float, index: float, below: complex, model: str) -> Doubles:
    """(cosines, 3): what R, G and B see of it."""
    if model == "spectral":
        curves = np.array(TO_REC709) @ matching()
        of_all = exact(cosines, thickness, index, below, np.linspace(SHORTEST, LONGEST, curves.shape[1]))
        return np.asarray(of_all @ curves.T / curves.sum(axis=1))
    waves = np.linspace(1.0e6, 3.2e6, 1500)
    xyz = np.zeros((3, len(waves)))
    for channel, share, place, width in films.PEAKS:
        xyz[channel] += share * np.exp(-((waves - place) ** 2) / (4 * width)) / np.sqrt(4 * np.pi * width)
    white = np.linalg.solve(np.array(TO_REC709), np.ones(3))
    of_all = exact(cosines, thickness, index, below, 1e9 / waves) @ xyz.T * (waves[1] - waves[0])
    return np.clip(of_all * white @ np.array(TO_REC709).T, 0, 1)


@pytest.mark.parametrize(
    ("case", "model"), [*itertools.product(CASES, ("spectral",)), *itertools.product(CASES[:-1], ("gaussians",))]
)
def test_the_factor_is_a_sum_of_waves(case: tuple[float, float, complex], model: films.FilmModel) -> None:
    thickness, index, below = case
    own = films.film(thickness, index, model)
    assert own is not None
    cosine = Value(Step("input", (), ("position", 0, 0)))
    builder = ProgramBuilder()
    builder.result(list(films.film_factors(own, cosine, 0.0, below.real, below.imag)[0]))
    places = np.stack([VIEWS, VIEWS, VIEWS]).astype(np.float32)
    found = builder.program().evaluate([((0, 0, 0), places)], len(VIEWS)).T
    # The sum leaves out waves of the fourth order.
    np.testing.assert_allclose(found, seen(VIEWS, thickness, index, below, model), rtol=4e-3, atol=1e-3)


def test_a_film_of_air_leaves_the_curve_of_a_metal() -> None:
    """The curve is Schlick's but for a dip, by which the metal has its edge's reflectance at a cosine of 1/7."""
    own, n, k, edge = films.film(400.0, 1.0), 0.2, 3.0, 0.6
    assert own is not None
    builder = ProgramBuilder()
    factors = films.film_factors(own, Value(Step("input", (), ("position", 0, 0))), 0.0, n, k, edge)
    builder.result(list(factors[0]))
    places = np.stack([VIEWS, VIEWS, VIEWS]).astype(np.float32)
    found = builder.program().evaluate([((0, 0, 0), places)], len(VIEWS)).T
    head_on = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    schlick, at_edge = (head_on + (1 - head_on) * (1 - c) ** 5 for c in (VIEWS, 1 / 7))
    dip = (at_edge - edge) * VIEWS * (1 - VIEWS) ** 6 / (1 / 7 * (6 / 7) ** 6)
    np.testing.assert_allclose(found, (schlick - dip)[:, None] * np.ones(3), atol=2e-3)


@pytest.mark.parametrize(("roughness", "case"), list(itertools.product((0.3, 0.6, 1.0), CASES)))
def test_lobes_reflect_it(roughness: float, case: tuple[float, float, complex]) -> None:
    """An even world is reflected by the factor's mean over the lobe, and a sun by nearly the factor where it stands."""
    thickness, index, below = case
    shader = nodes.conductor(
        below.real, below.imag, roughness, distribution="ggx", thin_film_thickness=thickness, thin_film_ior=index
    )

    def truth(ways: Doubles) -> tuple[Doubles, Doubles]:
        lobe = microfacets("ggx", "", roughness**2, ways)[:, None]
        half = (ways + VIEW) / np.linalg.norm(ways + VIEW, axis=1, keepdims=True)
        return lobe, lobe * seen(half @ VIEW, thickness, index, below, "spectral")

    ways, share = in_cone(np.array([0.0, 0.0, 1.0]), np.pi)
    lobe, colored = truth(ways)
    mean = share @ colored / (share @ lobe)
    np.testing.assert_allclose(radiance(shader, None), share @ colored, rtol=1.5e-3)
    for sun in LIGHTS:
        lobe, colored = truth(sun[None])
        assert np.abs(radiance(shader, sun) - colored[0]).max() <= (4e-2 * lobe[0] * mean).max()
