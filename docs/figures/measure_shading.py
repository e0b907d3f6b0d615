# SPDX-License-Identifier: MIT
"""Measures shade_spheres: errors, times and points over roughness and view (docs/theory.md, 6).

.venv/bin/python docs/figures/measure_shading.py        (a few minutes)

For each roughness and view, 240 random lights of half angles 0.01 … 1.4, a third of them cut by the horizon and a third
about the mirror direction, against brute force, relative to the brightest of them; and the time that one of them
takes, on one thread, if every light has a view of its own, as the hits of a picture with one light have.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from warped_lobes import Array, Warp, brute_force, random_lights

import shlight

ROUGHNESSES = [0.05, 0.1, 0.2, 0.4, 0.7, 1.0]
VIEWS = [1.0, 0.7, 0.4, 0.2, 0.1, 0.05]
TOLERANCES = [1e-2, 1e-3, 1e-4]
LIGHTS = 240
POINTS = 200


def seconds(work: Callable[[], object]) -> float:
    """The time of the fastest of some runs, since other processes only add to it."""
    times = []
    for _ in range(25):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


@dataclass
class Case:
    """One roughness and view, under random lights."""

    roughness: float
    cos_o: float
    axes: Array
    half: Array
    truth: Array

    @classmethod
    def random(cls, rng: np.random.Generator, roughness: float, cos_o: float) -> Case:
        alpha = roughness**2
        axes, half = random_lights(rng, alpha, cos_o, LIGHTS)
        bsdf, warp = shlight.Bsdf.ggx(roughness, 1.0), Warp(alpha, cos_o)
        truth = [brute_force(bsdf, warp, cos_o, a, h, POINTS) for a, h in zip(axes, half, strict=True)]
        return cls(roughness, cos_o, axes, half, np.array(truth))

    def reference_error(self) -> float:
        """The largest change of some lights' radiance with fewer points."""
        bsdf, warp = shlight.Bsdf.ggx(self.roughness, 1.0), Warp(self.roughness**2, self.cos_o)
        lights = list(zip(self.axes, self.half, self.truth, strict=True))[::10]
        worst = max(abs(brute_force(bsdf, warp, self.cos_o, a, h, 140) - t) for a, h, t in lights)
        return float(worst / self.truth.max())

    def measure(self, tolerance: float) -> tuple[Array, Array, float]:
        """Sorted errors ÷ the brightest light, efforts, microseconds per light."""
        bsdf = shlight.Bsdf.ggx(self.roughness, 1.0)

        def shade(views: Array) -> tuple[Array, Array]:
            return shlight.shade_spheres(
                self.axes, np.sin(self.half), bsdf, views, tolerance=tolerance, threads=1, return_effort=True
            )

        radiance, effort = shade(np.full(LIGHTS, self.cos_o))
        errors = np.sort(abs(radiance[:, 0] - self.truth)) / self.truth.max()
        views = self.cos_o - 1e-6 * np.arange(LIGHTS) / LIGHTS
        return errors, effort, 1e6 * seconds(lambda: shade(views)) / LIGHTS

    def outline_values(self) -> float:
        """Values of f·cos that the outline takes where harmonics are not accurate enough, in the mean over lights."""
        bsdf = shlight.Bsdf.ggx(self.roughness, 1.0)
        _, effort = shlight.shade_spheres(
            self.axes, np.sin(self.half), bsdf, self.cos_o, tolerance=1e-6, return_effort=True
        )
        along = effort[effort > 24]
        return float(along.mean()) if len(along) else 0.0


def print_table(title: str, cells: list[str]) -> None:
    print(f"| {title} | " + " | ".join(f"cosθ_o = {c:g}" for c in VIEWS) + " |")
    print("|---" * (len(VIEWS) + 1) + "|")
    for i, roughness in enumerate(ROUGHNESSES):
        print(f"| roughness {roughness} | " + " | ".join(cells[i * len(VIEWS) : (i + 1) * len(VIEWS)]) + " |")
    print()


def main() -> None:
    start = time.perf_counter()
    shlight.Bsdf.ggx(0.5, 1.0)
    print(f"the table of GGX lobes: {time.perf_counter() - start:.2f} s")
    rng = np.random.default_rng(3)
    cases = [Case.random(rng, roughness, cos_o) for roughness in ROUGHNESSES for cos_o in VIEWS]
    print(f"brute force agrees with that of fewer points to {max(c.reference_error() for c in cases):.0e}\n")
    for tolerance in TOLERANCES:
        results = [case.measure(tolerance) for case in cases]
        every = np.sort(np.concatenate([errors for errors, _, _ in results]))
        steep = np.concatenate([r[1] for r, c in zip(results, cases, strict=True) if c.cos_o >= 0.3])
        print(
            f"tolerance {tolerance:g}: error {every[len(every) // 2]:.1e} (median), "
            f"{every[len(every) * 99 // 100]:.1e} (99 % of lights), {every[-1]:.1e} (largest); "
            f"{np.mean([r[2] for r in results]):.1f} µs; cosθ_o ≥ 0.3: at most 16 bands or points for "
            f"{100 * np.mean(steep <= 16):.0f} %\n"
        )
        print_table("99 % error · µs", [f"{e[len(e) * 99 // 100]:.0e} · {t:.1f}" for e, _, t in results])
    cells = [f"{case.outline_values():.0f}" for case in cases]
    print_table("values of f·cos along an outline, tolerance 1e-06, mean", cells)


if __name__ == "__main__":
    main()
