# SPDX-License-Identifier: MIT
"""Sphere lights about a glossy lobe, what shading methods make of them, and how long they take."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import shlight
from shlight._arrays import Floats

from .lobes import view_direction

BATCH_SECONDS = 1e-3
FEWEST_LIGHTS, MOST_LIGHTS = 3, 1920  # of a batch
SHARING = 16


@dataclass(frozen=True)
class LobeLights:
    """Lights of unit radiance at distance 1, in the shading frame, and the view ω_o = (sinθ_o, 0, cosθ_o)."""

    cos_o: float
    centers: Floats  # (k, 3)
    radii: Floats  # (k,)

    def __len__(self) -> int:
        return len(self.radii)

    def shade(self, bsdf: shlight.Bsdf, method: str, **options: Any) -> Floats:
        """(k,) reflected radiance, of the first channel."""
        shaded: Floats = shlight.shade_spheres(
            self.centers, self.radii, bsdf, self.cos_o, method=method, threads=options.pop("threads", 1), **options
        )
        return shaded[:, 0].astype(np.float64)

    def timed(self, bsdf: shlight.Bsdf, method: str, count: int, **options: Any) -> Callable[[], object]:
        """Work for a clock: `count` lights, these over and over, SHARING neighbours under one view as the lights at a
        hit are; what a method prepares for a view is paid for by that many."""
        which = np.arange(count) % len(self)
        centers, radii = self.centers[which], self.radii[which]
        cosines = self.cos_o - 1e-6 * (np.arange(count) // SHARING) / count
        return lambda: shlight.shade_spheres(centers, radii, bsdf, cosines, method=method, threads=1, **options)


def about_lobe(rng: np.random.Generator, alpha: float, cos_o: float, half_angles: Floats) -> LobeLights:
    """A third of the lights cut by the horizon, half of those below the mirror direction; a third about the mirror
    direction, as far off as lobe and light reach; a third anywhere above."""
    count = len(half_angles)
    axes = rng.normal(size=(count, 3))
    kind = np.arange(count) % 3
    height = np.sin(rng.uniform(-0.9, 1, count) * half_angles)
    azimuth = np.where(rng.random(count) < 0.5, np.pi + rng.uniform(-0.6, 0.6, count), rng.uniform(0, 2 * np.pi, count))
    flat = np.sqrt(1 - height**2)
    cut = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), height], axis=-1)
    near = view_direction(cos_o) * [-1, 1, 1] + 0.4 * (half_angles + 2 * alpha)[:, None] * axes
    axes[:, 2] = abs(axes[:, 2])
    near[:, 2] = abs(near[:, 2])
    axes = np.where((kind == 0)[:, None], cut, np.where((kind == 1)[:, None], near, axes))
    return LobeLights(cos_o, axes / np.linalg.norm(axes, axis=-1, keepdims=True), np.sin(half_angles))


def best_seconds(works: Sequence[Callable[[], object]], rounds: int) -> list[float]:
    """Processor seconds of the fastest of some rounds in which the works take turns: other work only adds to it."""
    best = [float("inf")] * len(works)
    for _ in range(rounds):
        for i, work in enumerate(works):
            start = time.process_time()
            work()
            best[i] = min(best[i], time.process_time() - start)
    return best


@dataclass(frozen=True)
class Timed:
    """A shading method and its options, for the clock."""

    method: str
    options: dict[str, Any]

    @property
    def seconds(self) -> float:
        """About, of a light; for the size of batches."""
        if self.method == "auto":
            return 3e-7
        order, samples = self.options.get("order", 0), self.options.get("samples", 0)
        return 1e-7 + 3e-10 * order**2 + 6e-8 * samples + (4e-6 if "tolerance" in self.options else 0)


class Clock:
    """Microseconds per light, without what a call from Python costs by itself."""

    def __init__(self, rounds: int) -> None:
        self._rounds = rounds
        light = LobeLights(0.5, np.array([[0.0, 0.0, 1.0]]), np.array([0.1]))
        call = light.timed(shlight.Bsdf.ggx(0.5, 1.0), "plain_harmonics", 1, order=2)
        self._overhead = min(best_seconds([call], 50))

    def microseconds(self, lights: LobeLights, bsdf: shlight.Bsdf, calls: Sequence[Timed]) -> list[float]:
        works, counts = [], []
        for call in calls:
            counts.append(int(np.clip(BATCH_SECONDS / call.seconds, FEWEST_LIGHTS, MOST_LIGHTS)))
            works.append(lights.timed(bsdf, call.method, counts[-1], **call.options))
            lights.timed(bsdf, call.method, 1, **call.options)()  # the first call makes a fit
        times = best_seconds(works, self._rounds)
        return [1e6 * (t - self._overhead) / count for t, count in zip(times, counts, strict=True)]
