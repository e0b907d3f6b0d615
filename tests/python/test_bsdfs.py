# SPDX-License-Identifier: MIT
"""Materials whose colours and roughness are arrays."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import lobe_cubature
import numpy as np
import pytest
from strategies import Floats

import shlight
from shlight import Bsdf, Bsdfs

COUNT = 12
RNG = np.random.default_rng(1)
ROUGHNESS = np.concatenate([[0.2, 1.0], RNG.uniform(0.2, 1, COUNT - 2)])
F0, ALBEDO = RNG.uniform(0, 1, (2, COUNT, 3))
COSINES = RNG.uniform(0.1, 1, COUNT)
CENTERS = np.array([0, 0, 2]) + RNG.uniform(-1, 1, (COUNT, 3))
RADII = RNG.uniform(0.2, 0.9, COUNT)
SQUARES = CENTERS[:, None] + RADII[:, None, None] * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
SHADE: dict[str, tuple[Any, tuple[Floats, ...]]] = {
    "spheres": (shlight.shade_spheres, (CENTERS, RADII)),
    "polygons": (shlight.shade_polygons, (SQUARES,)),
    "disks": (shlight.shade_disks, (CENTERS, RADII[:, None] * [1.0, 0, 0], RADII[:, None] * [0, 0.5, 0.5])),
}


def one(i: int, ior: float | None = None) -> Bsdf:
    return Bsdf.ggx(float(ROUGHNESS[i]), F0[i], ior=ior) + Bsdf.lambert(ALBEDO[i])


def test_each_light_has_its_own_roughness_and_colour() -> None:
    found = shlight.shade_spheres(CENTERS, RADII, Bsdfs.ggx(ROUGHNESS, F0) + Bsdfs.lambert(ALBEDO), COSINES)
    for i in range(COUNT):
        true = lobe_cubature.over_sphere(one(i), COSINES[i], CENTERS[i], RADII[i])
        np.testing.assert_allclose(found[i], true, rtol=0, atol=4 * shlight.DEFAULT_TOLERANCE)


@pytest.mark.parametrize("shape", SHADE)
@pytest.mark.parametrize("order", ["auto", 8])
def test_light_is_reflected_as_by_one_material_after_the_other(shape: str, order: Any) -> None:
    shade, lights = SHADE[shape]
    varying = Bsdfs.ggx(ROUGHNESS, F0, ior=1.5) + Bsdfs.lambert(ALBEDO)
    found, effort = shade(*lights, varying, COSINES, order=order, return_effort=True)
    for i in range(COUNT):
        own = shade(*(light[i] for light in lights), one(i, 1.5), COSINES[i], order=order)
        np.testing.assert_allclose(found[i], own, rtol=0, atol=4 * shlight.DEFAULT_TOLERANCE)
    assert np.all(effort[found.any(axis=-1)] > 0)
    # Neighbours that share a material share its look-up.
    once, twice = (Bsdfs.ggx(np.repeat(ROUGHNESS, n), 0.5) for n in (1, 2))
    pairs = [np.repeat(light, 2, axis=0) for light in lights]
    same = np.repeat(shade(*lights, once, 0.7, order=order), 2, axis=0)
    np.testing.assert_array_equal(shade(*pairs, twice, 0.7, order=order), same)


def test_colours_multiply_what_every_material_reflects() -> None:
    lights, color = (CENTERS, RADII), ALBEDO * 3
    table = Bsdf.from_function(lambda view, light: 0.2 + 0.5 * view[:, 2] * light[:, 2], samples=8)
    layered = Bsdf.layer(Bsdf.ggx(0.4, 0.04), Bsdf.lambert([0.1, 0.5, 0.9]) + table)
    for bsdf in (Bsdf.lambert(0.5), layered, Bsdf.ggx(0, 1.0)):
        alone = shlight.shade_spheres(*lights, bsdf, COSINES)
        for varying in (color * (bsdf + Bsdfs.lambert(0.0)), (0 * Bsdfs.lambert(1) + bsdf) * color):
            np.testing.assert_allclose(
                shlight.shade_spheres(*lights, varying, COSINES), alone * color, rtol=0, atol=5e-3
            )


def test_leading_axes_broadcast_and_a_plain_mirror_is_as_sharp_as_a_lobe_can_be() -> None:
    varying = Bsdfs.ggx(ROUGHNESS[:, None], 0.3) + Bsdfs.lambert(ALBEDO[:2, None, None])
    assert varying.shape == (2, COUNT, 1)
    found = shlight.shade_spheres(CENTERS[:5], RADII[:5], varying, 0.5)
    assert found.shape == (2, COUNT, 5, 3)
    own = shlight.shade_spheres(CENTERS[4], RADII[4], Bsdf.ggx(float(ROUGHNESS[3]), 0.3) + Bsdf.lambert(ALBEDO[1]), 0.5)
    np.testing.assert_allclose(found[1, 3, 4], own, rtol=0, atol=4 * shlight.DEFAULT_TOLERANCE)
    sharp = [shlight.shade_spheres(CENTERS, RADII, Bsdfs.ggx([r], 1.0), COSINES) for r in (0.0, 0.003)]
    np.testing.assert_array_equal(*sharp)


@pytest.mark.parametrize("roughness", [0.5, [0.5, 0.5]])
def test_a_sum_may_begin_with_either_lobe(roughness: Any) -> None:
    shiny, matt = Bsdfs.ggx(roughness, 0.04), Bsdfs.lambert([[0.4, 0.2, 0.1], [0.5, 0.3, 0.2]])
    one_by_one = [Bsdf.ggx(0.5, 0.04) + Bsdf.lambert(color) for color in ((0.4, 0.2, 0.1), (0.5, 0.3, 0.2))]
    expected = [shlight.shade_spheres(CENTERS[0], RADII[0], own, 0.8) for own in one_by_one]
    for varying in (shiny + matt, matt + shiny):
        found = shlight.shade_spheres(CENTERS[0], RADII[0], varying, 0.8)
        np.testing.assert_allclose(found, expected, rtol=0, atol=4 * shlight.DEFAULT_TOLERANCE)


def test_sums_and_copies_reflect_the_same() -> None:
    varying = sum([Bsdfs.ggx(ROUGHNESS, F0), Bsdf.lambert(0.5)])
    assert repr(varying) == f"Bsdfs(shape ({COUNT},), 3 lobes)"
    found = shlight.shade_spheres(CENTERS, RADII, varying, COSINES)
    for again in (
        copy.deepcopy(varying),
        pickle.loads(pickle.dumps(varying)),
        Bsdfs.ggx(ROUGHNESS, F0) + Bsdf.lambert(0.5),
    ):
        np.testing.assert_array_equal(shlight.shade_spheres(CENTERS, RADII, again, COSINES), found)
    with pytest.raises(TypeError):
        varying + 0.5


def test_what_does_not_fit_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^roughness\[1\] must lie in \[0, 1\]"):
        Bsdfs.ggx([0.5, 1.5], 0.5)
    with pytest.raises(ValueError, match=r"^f0\[0, 1\] must lie in \[0, 1e\+10\]"):
        Bsdfs.ggx(0.5, [[[0, 0, 0], [0, np.nan, 0]]])
    with pytest.raises(ValueError, match=r"^roughness .* and f0 .* do not broadcast"):
        Bsdfs.ggx(ROUGHNESS, F0[:5])
    with pytest.raises(ValueError, match=r"^factor times the material's own colour\[0\]"):
        Bsdfs.lambert(1e6) * (1e6 * np.ones((1, 3)))
    with pytest.raises(ValueError, match=r"bsdf \(12,\).*do not broadcast"):
        shlight.shade_spheres(CENTERS[:5], RADII[:5], Bsdfs.ggx(ROUGHNESS, 0.5), 0.5)
    with pytest.raises(ValueError, match=r"^method must be 'auto' for Bsdfs"):
        shlight.shade_spheres(CENTERS, RADII, Bsdfs.ggx(ROUGHNESS, 0.5), 0.5, method="monte_carlo")
    with pytest.raises(ValueError, match=r"^bsdf must be one Bsdf with gradient"):
        shlight.shade_spheres(CENTERS, RADII, Bsdfs.ggx(ROUGHNESS, 0.5), 0.5, gradient=True)
    with pytest.raises(ValueError, match=r"^radii\[3\]"):
        shlight.shade_spheres([[0, 0, 0.5]] * 4, [0.2, 0.2, 0.2, 0.9], Bsdfs.ggx([[0.5], [0.6]], 0.5), 0.5)
