# SPDX-License-Identifier: MIT
"""Equal time and equal quality: a room by harmonics and by Monte Carlo with multiple importance sampling.

Zhou & Wei 2020, Figs. 1 and 5: a matt scene at order 8 and one of rough gold at order 16. Times are wall times of whole
calls on all cores, the fastest of some rounds in which all take turns; the scene is compiled beforehand.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import shlight
from shlight import images, methods, metrics
from shlight._arrays import Floats

from .figure import Drawn, Run, Table
from .scenes import gold_room, matt_room
from .style import AMBER, BLUE, DARK, GREY, ORANGE, SKY, canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

Image = Floats
Step = Callable[[float, str], None]

BIAS_TOLERANCE = 1e-6
INSET = 0.22  # of the picture's width


@dataclass(frozen=True)
class Setting:
    """A scene, and the order it is shown with."""

    name: str
    title: str
    build: Callable[[], shlight.Scene]
    order: int
    insets: tuple[tuple[float, float], tuple[float, float]]  # middles, from the upper left, in parts of the picture


SETTINGS = [
    Setting("matt", "Matt paint, order 8", matt_room, 8, ((0.66, 0.84), (0.22, 0.62))),
    Setting("gold", "Rough gold (roughness 0.5), order 16", gold_room, 16, ((0.45, 0.62), (0.84, 0.66))),
]


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


FULL = Effort(
    240,
    150,
    half_samples=512,
    samples=(1, 4, 16, 64, 256),
    most_samples=1024,
    rays=((1, 1), (1, 4), (4, 4), (16, 4), (16, 16)),
    adaptive_rays=((2, 4), (4, 4), (8, 8)),
    rounds=3,
    seconds=1.0,
)
QUICK = Effort(
    80,
    50,
    half_samples=64,
    samples=(1, 8, 64),
    most_samples=128,
    rays=((1, 1), (4, 4), (16, 4)),
    adaptive_rays=((2, 4), (4, 4)),
    rounds=2,
    seconds=0.3,
)


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

    def scale(self) -> Floats:
        """What relMSE divides squared differences by."""
        r = self.image[..., :3].astype(np.float64)
        return r**2 + 0.01 * r.mean() ** 2

    def error(self, image: Image) -> Error:
        """relMSE without the reference's own noise: (x - a)(x - b) is (x - r)² in the mean if a and b are two
        independent estimates of r."""
        x, a, b = (np.asarray(part[..., :3], dtype=np.float64) for part in (image, *self.halves))
        products = ((x - a) * (x - b) / self.scale()).mean(axis=-1)
        return Error(float(products.mean()), float(products.std() / np.sqrt(products.size)))


@dataclass
class Call:
    """A way to a picture with a certain effort."""

    effort: str
    render: Callable[[], Image]
    image: Image | None = None
    seconds: float = np.inf
    error: Error = Error(np.nan, np.nan)

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


def draw(run: Run) -> Drawn:
    effort = QUICK if run.quick else FULL
    done = []
    for i, setting in enumerate(SETTINGS):

        def step(share: float, text: str, i: int = i, name: str = setting.name) -> None:
            run.step((i + share) / len(SETTINGS), f"{name}: {text}")

        done.append(compare(setting, effort, run.seed, step))
    _draw_strip(run, done)
    _draw_curves(run, done)
    run.csv("pictures", ["scene", "way", "effort", "seconds", "rel_mse", "uncertainty"], _numbers(done))
    return Drawn(_explanation(done), [_table(done)])


def compare(setting: Setting, effort: Effort, seed: int, step: Step) -> Compared:
    scene = setting.build()
    harmonics = functools.partial(_harmonics, scene, effort, adaptive=False)
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
        adaptive = functools.partial(_harmonics, scene, effort, rays, adaptive=True)
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
    image: Image = shlight.render(
        scene, effort.width, effort.height, order=order, pixel_samples=rays[0], shadow_rays=rays[1], **options
    )
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
    """Of the same rays, only the shading differs between this order and whatever meets a small tolerance."""
    rays = (1, 4)
    difference = (harmonics(rays, order) - harmonics(rays, "auto", tolerance=BIAS_TOLERANCE))[..., :3]
    return float(np.mean(difference.astype(np.float64) ** 2 / reference.scale()))


def _samples(count: int) -> str:
    return f"{count} sample{'s' if count != 1 else ''} a pixel"


def _rays(rays: tuple[int, int]) -> str:
    return f"{rays[0]} × {rays[1]} rays a pixel"


# --- drawing --------------------------------------------------------------------------------------------------------


def _draw_strip(run: Run, done: list[Compared]) -> None:
    picture = canvas(14.5, 5.1 * len(done))
    parts = picture.subfigures(len(done), 1, squeeze=False)[:, 0]
    for part, compared in zip(parts, done, strict=True):
        part.suptitle(compared.setting.title, fontsize=14)
        _draw_scene(part, compared)
    run.save(picture, "pictures", "Equal time, harmonics, equal quality, reference; below, details of each")


def _draw_scene(part: SubFigure, compared: Compared) -> None:
    quality = "same error" if compared.reached else f"same error takes {_round(compared.samples_for_quality)}"
    reference = compared.reference
    columns = [
        ("Monte Carlo, same time", compared.equal_time.image, _said(compared.equal_time)),
        (f"Harmonics of order {compared.setting.order}", compared.shown.image, _said(compared.shown)),
        (f"Monte Carlo, {quality}", compared.equal_quality.image, _said(compared.equal_quality)),
        ("Reference", reference.image, f"{reference.samples} samples a pixel\nnoise {_noise(reference)}"),
    ]
    height, width = reference.image.shape[:2]
    grid = part.add_gridspec(2, 2 * len(columns), height_ratios=[height / width, 0.5])
    for i, (title, image, said) in enumerate(columns):
        assert image is not None
        pixels = images.linear_to_srgb8(image)
        panel = part.add_subplot(grid[0, 2 * i : 2 * i + 2])
        _show(panel, pixels, interpolation="antialiased")
        panel.set_title(f"{title}\n{said}", fontsize=11)
        for k, (middle, color) in enumerate(zip(compared.setting.insets, (BLUE, AMBER), strict=True)):
            corner, size = _inset(middle, width, height)
            panel.add_patch(_frame(corner, size, color))
            detail = part.add_subplot(grid[1, 2 * i + k])
            cut = pixels[corner[1] : corner[1] + size, corner[0] : corner[0] + size]
            _show(detail, cut, interpolation="nearest")
            detail.add_patch(_frame((0, 0), size, color, width=4))


def _inset(middle: tuple[float, float], width: int, height: int) -> tuple[tuple[int, int], int]:
    """Left and upper edge, and size, in pixels."""
    size = round(INSET * width)
    left, top = round(middle[0] * width - size / 2), round(middle[1] * height - size / 2)
    return (min(max(left, 0), width - size), min(max(top, 0), height - size)), size


def _frame(corner: tuple[int, int], size: int, color: str, width: float = 1.8) -> Any:
    from matplotlib.patches import Rectangle

    at = (corner[0] - 0.5, corner[1] - 0.5)
    return Rectangle(at, size, size, fill=False, edgecolor=color, linewidth=width)


def _show(panel: Axes, pixels: Any, interpolation: str) -> None:
    panel.imshow(pixels, interpolation=interpolation)
    panel.axis("off")


def _said(call: Call) -> str:
    return f"{call.effort}, {_seconds(call.seconds)}\nrelMSE {call.error}"


def _draw_curves(run: Run, done: list[Compared]) -> None:
    picture = canvas(12, 5)
    panels = picture.subplots(1, len(done), sharey=True)
    for panel, compared in zip(panels, done, strict=True):
        for line in compared.lines:
            seconds = [call.seconds for call in line.calls]
            errors = [call.error for call in line.calls]
            bars = [2 * error.uncertainty for error in errors]
            below = [min(bar, 0.9 * error.bound) for bar, error in zip(bars, errors, strict=True)]
            panel.errorbar(
                seconds,
                [error.bound for error in errors],
                yerr=[below, bars],
                color=line.color,
                marker=line.marker,
                capsize=2,
                elinewidth=0.8,
                label=line.label,
            )
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(compared.setting.title)
        panel.set_xlabel("seconds, whole call, all cores")
        noise = metrics.reference_rel_mse(*compared.reference.halves)
        panel.axhline(noise, color=DARK, lw=0.8, ls=":")
        panel.text(
            0.01, noise, "noise of the reference", transform=panel.get_yaxis_transform(), va="bottom", fontsize=9
        )
        panel.legend(loc="upper right")
    panels[0].set_ylabel("relMSE")
    run.save(picture, "pictures_curves", "Error against time")


# --- numbers --------------------------------------------------------------------------------------------------------


def _numbers(done: list[Compared]) -> list[list[Any]]:
    rows = []
    for compared in done:
        ways = [(line.label, call) for line in compared.lines for call in line.calls]
        ways += [("equal time", compared.equal_time), ("equal quality", compared.equal_quality)]
        for label, call in ways:
            numbers = (call.seconds, call.error.value, call.error.uncertainty)
            rows.append([compared.setting.name, label, call.effort, *(f"{number:.4g}" for number in numbers)])
    return rows


def _noise(reference: Reference) -> str:
    return f"{metrics.reference_rel_mse(*reference.halves):.1e}"


def _seconds(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"


def _round(number: float) -> str:
    return f"{float(f'{number:.2g}'):.0f}"


def _by_monte_carlo(compared: Compared, call: Call) -> float:
    """Seconds that Monte Carlo takes for the same error, which falls with their number as the curve shows."""
    most = compared.lines[0].calls[-1]
    return most.seconds * most.error.value / call.error.bound


def _table(done: list[Compared]) -> Table:
    rows = []
    for compared in done:
        most = compared.lines[0].calls[-1]
        for line in compared.lines[1:]:
            call = line.calls[-1]
            needed = _by_monte_carlo(compared, call)
            rows.append(
                [
                    compared.setting.title,
                    f"{line.label}, {call.effort}",
                    _seconds(call.seconds),
                    str(call.error),
                    f"{most.seconds * most.error.value / call.seconds:.1e}",
                    _seconds(needed),
                    f"{needed / call.seconds:.1f}",
                ]
            )
    header = [
        "scene",
        "camera × shadow rays",
        "time",
        "relMSE",
        "Monte Carlo in that time",
        "to that relMSE",
        "time ratio",
    ]
    return Table("Harmonics and Monte Carlo with MIS, whose error × time is the same all along its curve", header, rows)


def _explanation(done: list[Compared]) -> str:
    parts = []
    for c in done:
        plain = c.lines[1].calls[-1]
        needed = c.seconds_for_quality / c.shown.seconds
        alone = f"a relMSE of {c.bias:.0e}" if c.bias > 0 else "no error"
        parts.append(
            f"{c.setting.title}: with adaptive camera rays {_seconds(c.shown.seconds)} give a relMSE of "
            f"{c.shown.error}; Monte Carlo with MIS has {c.equal_time.error} after the same time and takes "
            f"{needed:.1f} times as long for the same error, {_by_monte_carlo(c, plain) / plain.seconds:.1f} times if "
            f"each pixel of the harmonics gets {plain.effort.removesuffix(' a pixel')}; the order alone keeps {alone}"
        )
    noise = " and ".join(_noise(c.reference) for c in done)
    return (
        f"{'. '.join(parts)}. Errors are against two independent halves of a reference and so free of its own noise, "
        f"{noise}; what harmonics keep are edges and half shadows."
    )
