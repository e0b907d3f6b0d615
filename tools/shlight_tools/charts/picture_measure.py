# SPDX-License-Identifier: MIT
"""What harmonics and Monte Carlo with multiple importance sampling make of a scene: times and errors of pictures.

Times are wall times of whole calls on all cores, the fastest of some rounds in which all take turns; the scene is
compiled beforehand.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

import shlight
from shlight import metrics
from shlight._arrays import Floats
from shlight_tools import methods

from .style import BLUE, GREY, ORANGE, SKY

Image = Floats
Step = Callable[[float, str], None]

BIAS_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Setting:
    """A scene, and the order it is shown with."""

    name: str
    title: str
    build: Callable[[], shlight.Scene]
    order: int
    insets: tuple[tuple[float, float], tuple[float, float]]  # middles, from the upper left, in parts of the picture


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    width: int
    height: int
    half_samples: int  # of each half of the reference
    samples: Sequence[int]  # of Monte Carlo
    most_samples: int  # of a picture of equal quality
    rays: Sequence[tuple[int, int]]  # camera rays a pixel, shadow rays of each and light
    adaptive_rays: Sequence[tuple[int, int]]  # the same at least; the last is shown
    rounds: int
    seconds: float  # calls that take longer are not repeated


@dataclass(frozen=True)
class Error:
    """relMSE, and the standard error of that number."""

    value: float
    uncertainty: float

    @property
    def bound(self) -> float:
        """The value, or what it may be where it is lost in the reference's noise."""
        return max(self.value, 2 * self.uncertainty)

    def __str__(self) -> str:
        return f"{self.value:.1e}" if self.value > 2 * self.uncertainty else f"≤ {self.bound:.0e}"


@dataclass(frozen=True)
class Reference:
    """Two independent pictures by Monte Carlo."""

    halves: tuple[Image, Image]
    samples: int  # of both

    @property
    def image(self) -> Image:
        return (self.halves[0] + self.halves[1]) / 2

    @property
    def noise(self) -> float:
        """relMSE of the image."""
        return metrics.reference_rel_mse(*self.halves)

    def error(self, image: Image) -> Error:
        """relMSE without the reference's own noise."""
        return Error(*metrics.rel_mse_without_noise(image, *self.halves))


@dataclass
class Call:
    """A way to a picture with a certain effort."""

    effort: str
    render: Callable[[], Image]
    image: Image | None = None
    seconds: float = np.inf
    error: Error = Error(np.nan, np.nan)

    @property
    def time(self) -> str:
        return seconds_text(self.seconds)

    def run(self, reference: Reference) -> None:
        start = time.perf_counter()
        image = self.render()
        self.seconds = min(self.seconds, time.perf_counter() - start)
        if self.image is None:
            self.image, self.error = image, reference.error(image)


@dataclass
class Line:
    """A way to a picture with growing efforts."""

    label: str
    color: str
    marker: str
    calls: list[Call] = field(default_factory=list)


@dataclass(frozen=True)
class Compared:
    """One scene, measured."""

    setting: Setting
    reference: Reference
    lines: list[Line]
    shown: Call
    equal_time: Call
    equal_quality: Call
    samples_for_quality: float
    seconds_for_quality: float
    reached: bool  # whether Monte Carlo ran with as many
    bias: float  # relMSE that harmonics of this order keep however many rays they get

    def by_monte_carlo(self, call: Call) -> float:
        """Seconds that Monte Carlo takes for the same error, which falls with their number as the curve shows."""
        most = self.lines[0].calls[-1]
        return most.seconds * most.error.value / call.error.bound


def seconds_text(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"


def compare(setting: Setting, effort: Effort, seed: int, step: Step) -> Compared:
    scene = setting.build()
    harmonics = functools.partial(_harmonics, scene, effort)
    monte_carlo = functools.partial(_monte_carlo, scene, effort, seed=seed)
    harmonics((1, 1), setting.order)  # compiles the scene and makes the fits
    harmonics((1, 1), "auto")
    reference = _reference(scene, effort, seed + 1, step)
    lines = [
        Line("Monte Carlo with MIS", GREY, "x"),
        Line(f"order {setting.order}", BLUE, "o"),
        Line(f"order {setting.order}, adaptive rays", SKY, "D"),
        Line("order auto, adaptive rays", ORANGE, "s"),
    ]
    for samples in effort.samples:
        lines[0].calls.append(Call(_samples(samples), functools.partial(monte_carlo, samples)))
    for rays in effort.rays:
        lines[1].calls.append(Call(_rays(rays), functools.partial(harmonics, rays, setting.order)))
    for rays in effort.adaptive_rays:
        adaptive = functools.partial(_harmonics, scene, effort, rays, max_samples=16 * rays[0])
        name = f"{_rays(rays)} or more"
        lines[2].calls.append(Call(name, functools.partial(adaptive, setting.order)))
        lines[3].calls.append(Call(name, functools.partial(adaptive, "auto")))
    _take_turns(
        [call for line in lines for call in line.calls], reference, effort, lambda s: step(0.5 + 0.3 * s, "times")
    )
    shown = lines[2].calls[-1]
    most = lines[0].calls[-1]
    samples = max(1, round(shown.seconds / most.seconds * effort.samples[-1]))
    equal_time = Call(_samples(samples), functools.partial(monte_carlo, samples))
    _take_turns([shown, equal_time], reference, effort, lambda s: step(0.8 + 0.05 * s, "equal time"))
    # The error of Monte Carlo falls with the number of samples.
    wanted = effort.samples[-1] * most.error.value / shown.error.bound
    samples = int(np.clip(round(wanted), 1, effort.most_samples))
    equal_quality = Call(_samples(samples), functools.partial(monte_carlo, samples))
    _take_turns([equal_quality], reference, effort, lambda s: step(0.85 + 0.15 * s, "equal quality"))
    return Compared(
        setting,
        reference,
        lines,
        shown,
        equal_time,
        equal_quality,
        wanted,
        equal_quality.seconds * wanted / samples,
        wanted <= effort.most_samples,
        _bias(harmonics, setting.order, reference),
    )


def _harmonics(
    scene: shlight.Scene, effort: Effort, rays: tuple[int, int], order: int | Literal["auto"], **options: Any
) -> Image:
    settings = {"pixel_samples": rays[0], "max_samples": rays[0], "shadow_rays": rays[1]} | options
    image: Image = shlight.render(scene, effort.width, effort.height, order=order, **settings, max_bounces=0)
    return image


def _monte_carlo(scene: shlight.Scene, effort: Effort, samples: int, *, seed: int, **options: Any) -> Image:
    image: Image = methods.render_monte_carlo(scene, effort.width, effort.height, samples=samples, seed=seed, **options)
    return image


def _reference(scene: shlight.Scene, effort: Effort, seed: int, step: Step) -> Reference:
    halves = []
    for i in range(2):

        def progress(share: float, i: int = i) -> None:
            step(0.25 * (i + share), "reference")

        halves.append(_monte_carlo(scene, effort, effort.half_samples, seed=seed + i, progress=progress))
    return Reference((halves[0], halves[1]), 2 * effort.half_samples)


def _take_turns(calls: list[Call], reference: Reference, effort: Effort, step: Callable[[float], None]) -> None:
    for i in range(effort.rounds):
        for k, call in enumerate(calls):
            step((i + k / len(calls)) / effort.rounds)
            if i == 0 or call.seconds <= effort.seconds:
                call.run(reference)


def _bias(harmonics: Callable[..., Image], order: int, reference: Reference) -> float:
    """relMSE between this order and a small tolerance, with the same rays, so that only the shading differs."""
    rays = (1, 4)
    difference: Image = harmonics(rays, order) - harmonics(rays, "auto", tolerance=BIAS_TOLERANCE).astype(np.float64)
    return metrics.rel_mse(reference.image + difference, reference.image)


def _samples(count: int) -> str:
    return f"{count} sample{'s' if count != 1 else ''} a pixel"


def _rays(rays: tuple[int, int]) -> str:
    return f"{rays[0]} × {rays[1]} rays a pixel"
