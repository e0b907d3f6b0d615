# SPDX-License-Identifier: MIT
"""`shlight bench picture`: error against time of shlight and of other renderers, each beside its own converged picture.

Whole renders of small scenes on two threads, in turns; a point is the median of the rounds. shlight's pictures are
those that one render shows meanwhile; the others render anew with twice as many samples each time.
"""

from __future__ import annotations

import csv
import importlib.util
import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from shlight.commands import CommandError, Parser, check_folder, run_command, work_folder
from shlight.metrics import rel_mse, rel_mse_without_noise
from shlight.progress import Progress

from .bounced_scenes import BOUNCED_SCENES
from .picture_renderers import Cycles, Image, Mitsuba, Renderer, Shlight
from .picture_scenes import PICTURE_SCENES, PictureScene

TIMES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
GOALS = (1e-2, 1e-3, 1e-4)
OURS = "shlight"
SCENES = PICTURE_SCENES | BOUNCED_SCENES
DENOISED = "Cycles + OpenImageDenoise"


@dataclass(frozen=True)
class Effort:
    """How much is rendered."""

    size: int
    rounds: int
    seconds: float  # of the longest render
    reference_seconds: float  # of each half of a converged picture


FULL = Effort(512, 3, 8.0, 40.0)
QUICK = Effort(256, 1, 2.0, 8.0)
QUICK_SCENES, QUICK_BOUNCED = ("balls", "fence"), ("cornell", "product")


@dataclass
class Curve:
    """Pictures of one renderer of one scene: (seconds, relMSE) by effort, of all rounds."""

    scene: str
    renderer: str
    rounds: list[list[tuple[float, float]]] = field(default_factory=list)

    def error_at(self, seconds: float) -> float:
        """The median over the rounds of the error after so many seconds; infinite before the first picture."""
        return statistics.median(_error_at(points, seconds, steps=self.renderer == OURS) for points in self.rounds)

    def seconds_to(self, error: float) -> float:
        """The median time to the first picture with at most this error; infinite if none has."""
        return statistics.median(min((t for t, e in points if e <= error), default=math.inf) for points in self.rounds)


def _error_at(points: list[tuple[float, float]], seconds: float, *, steps: bool) -> float:
    """steps: pictures as they are; or else between two efforts what one in between would give."""
    before = [point for point in points if point[0] <= seconds]
    after = [point for point in points if point[0] > seconds]
    if not before:
        return math.inf
    if steps or not after:
        return before[-1][1]
    (t0, e0), (t1, e1) = before[-1], after[0]
    share = math.log(seconds / t0) / math.log(t1 / t0)
    return math.exp(math.log(max(e0, 1e-12)) * (1 - share) + math.log(max(e1, 1e-12)) * share)


def main(argv: list[str]) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 for what is missing to meet it."""
    return run_command("bench picture", lambda: _work(argv), when_interrupted="nothing was written")


def _work(argv: list[str]) -> None:
    parser = Parser(prog="shlight bench picture", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="scene", help=f"of {', '.join(SCENES)}")
    parser.add_argument(
        "--bounces", action="store_true", help="by default scenes whose light bounces, not direct light"
    )
    parser.add_argument("--quick", action="store_true", help="small pictures of two scenes, in three minutes")
    parser.add_argument("--out", type=Path, default=Path("out") / "bench" / "picture", metavar="DIR")
    options = parser.parse_args(argv)
    unknown = [name for name in options.scenes if name not in SCENES]
    if unknown:
        raise CommandError(f"there is no scene '{unknown[0]}', but {', '.join(SCENES)}", 2)
    check_folder(options.out)
    whole, quick = (BOUNCED_SCENES, QUICK_BOUNCED) if options.bounces else (PICTURE_SCENES, QUICK_SCENES)
    names = list(options.scenes or (quick if options.quick else whole))
    renderers = _renderers()
    curves = _measured(names, QUICK if options.quick else FULL, renderers)
    with work_folder(options.out) as folder:
        _write_csv(folder / "picture.csv", curves)
        _draw(folder / "picture.png", curves)
        options.out.mkdir(parents=True, exist_ok=True)
        for name in ("picture.csv", "picture.png"):
            (folder / name).replace(options.out / name)
    print(_tables(curves))
    print(f"results: {options.out}/picture.{{csv,png}}")


Make = Callable[[PictureScene, int], Renderer]


def _renderers() -> list[Make]:
    """All that can be used here; a line says why another cannot."""
    made: list[Make] = [Shlight]
    if importlib.util.find_spec("bpy") is None:
        print("Cycles is left out: there is no module bpy")
    else:
        made += [lambda scene, size: Cycles(scene, size, denoised=False)]
        made += [lambda scene, size: Cycles(scene, size, denoised=True)]
    why_not = Mitsuba.missing()
    if why_not:
        print(f"Mitsuba is left out: {why_not}")
    else:
        made.append(Mitsuba)
    return made


def _measured(names: list[str], effort: Effort, makes: list[Make]) -> list[Curve]:
    progress = Progress(len(names))
    curves = []
    try:
        for name in names:
            progress.begin(name)
            curves += _measured_scene(name, effort, makes, progress)
            progress.end()
    except BaseException:
        progress.interrupt()
        raise
    return curves


def _measured_scene(name: str, effort: Effort, makes: list[Make], progress: Progress) -> list[Curve]:
    renderers = [make(SCENES[name](), effort.size) for make in makes]
    curves = [Curve(name, renderer.name) for renderer in renderers]
    references: dict[Any, tuple[Image, Image]] = {}
    steps = len(renderers) * (1 + effort.rounds)
    for i, renderer in enumerate(renderers):
        progress.step(i / steps, f"{renderer.name}: converged picture")
        if type(renderer) not in references:  # it is not denoised
            references[type(renderer)] = renderer.halves(effort.reference_seconds)
    for number in range(effort.rounds):
        for i, (renderer, curve) in enumerate(zip(renderers, curves, strict=True)):
            progress.step((len(renderers) * (1 + number) + i) / steps, f"{renderer.name}: round {number + 1}")
            halves = references[type(renderer)]
            pictures = renderer.pictures(effort.seconds)
            curve.rounds.append([(seconds, _error(image, halves)) for seconds, image in pictures])
    return curves


def _error(image: Image, halves: tuple[Image, Image]) -> float:
    first, second = halves
    if first is second:
        return rel_mse(image, first)
    return max(rel_mse_without_noise(image, first, second)[0], 0.0)


def _write_csv(path: Path, curves: list[Curve]) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["scene", "renderer", "round", "seconds", "rel_mse"])
        for curve in curves:
            for number, points in enumerate(curve.rounds):
                writer.writerows([curve.scene, curve.renderer, number + 1, f"{t:.4g}", f"{e:.4g}"] for t, e in points)


def _draw(path: Path, curves: list[Curve]) -> None:
    from shlight.charts.style import BLUE, GREEN, GREY, ORANGE, canvas, look

    colors = {OURS: BLUE, "Cycles": GREY, DENOISED: ORANGE, "Mitsuba direct": GREEN, "Mitsuba path": GREEN}
    names = list(dict.fromkeys(curve.scene for curve in curves))
    columns = min(len(names), 3)
    rows = math.ceil(len(names) / columns)
    with look():
        figure = canvas(5.2 * columns, 4.2 * rows)
        axes = figure.subplots(rows, columns, squeeze=False)
        for name, axis in zip(names, axes.flat, strict=False):
            for curve in (curve for curve in curves if curve.scene == name):
                times = np.geomspace(0.05, TIMES[-1], 60)
                errors = [curve.error_at(float(t)) for t in times]
                axis.loglog(times, errors, color=colors[curve.renderer], label=curve.renderer)
            axis.set_title(name)
            axis.set_xlabel("time [s]")
            axis.set_ylabel("relMSE")
        for axis in axes.flat[len(names) :]:
            axis.set_visible(False)
        axes[0, 0].legend()
        figure.savefig(path)


def _tables(curves: list[Curve]) -> str:
    scenes = list(dict.fromkeys(curve.scene for curve in curves))
    renderers = list(dict.fromkeys(curve.renderer for curve in curves))
    lines = [f"Seconds to the first picture · to a relMSE of {' · '.join(map(_short, GOALS))}", ""]
    lines += [_row("scene", *renderers), _row(*["---"] * (1 + len(renderers)))]
    for scene in scenes:
        own = {curve.renderer: curve for curve in curves if curve.scene == scene}
        lines.append(_row(scene, *(_times(own[name]) if name in own else "" for name in renderers)))
    lines += ["", "relMSE ÷ that of shlight at the same time", ""]
    lines += [_row("scene", "renderer", *(f"{t:g} s" for t in TIMES)), _row(*["---"] * (2 + len(TIMES)))]
    for curve in curves:
        if curve.renderer != OURS:
            ratios = [_ratio_text(_ratio(curves, curve, t)) for t in TIMES]
            lines.append(_row(curve.scene, curve.renderer, *ratios))
    return "\n".join([*lines, "", *_bounds(curves)])


def _ratio(curves: list[Curve], curve: Curve, seconds: float) -> float:
    ours = next(own for own in curves if own.scene == curve.scene and own.renderer == OURS)
    theirs, mine = curve.error_at(seconds), ours.error_at(seconds)
    return math.inf if math.isinf(theirs) else theirs / mine


def _bounds(curves: list[Curve]) -> list[str]:
    direct = [curve for curve in curves if curve.scene in PICTURE_SCENES]
    bounced = [curve for curve in curves if curve.scene in BOUNCED_SCENES]
    lines = []
    for name, least in (("Cycles", 10.0), (DENOISED, 10.0), ("Mitsuba direct", 5.0)):
        lines += _bound(direct, name, TIMES, (1.0,), least)
    lines += [
        f"Cycles, fence: {_ratio_text(_ratio(curves, curve, 2.0))} at 2 s (bound 3)"
        for curve in direct
        if (curve.scene, curve.renderer) == ("fence", "Cycles")
    ]
    late = tuple(t for t in TIMES if t >= 1.0)
    return [*lines, *_bound(bounced, DENOISED, late, late, 2.0)]


def _bound(
    curves: list[Curve], name: str, times: tuple[float, ...], median_times: tuple[float, ...], least: float
) -> list[str]:
    """A line of the lowest ratio of a renderer at some times, and of the median at others."""
    own = [curve for curve in curves if curve.renderer == name]
    if not own:
        return []
    lowest = min(_ratio(curves, curve, t) for curve in own for t in times)
    median = statistics.median(_ratio(curves, curve, t) for curve in own for t in median_times)
    return [
        f"{name}: at least {_ratio_text(lowest)} from {times[0]:g} to {times[-1]:g} s (bound 1), "
        f"{_ratio_text(median)} in the median from {median_times[0]:g} to {median_times[-1]:g} s (bound {least:g})"
    ]


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _short(number: float) -> str:
    return f"{number:.0e}".replace("e-0", "e-")


def _times(curve: Curve) -> str:
    times = [curve.seconds_to(goal) for goal in (math.inf, *GOALS)]
    return " · ".join("–" if math.isinf(seconds) else f"{seconds:.2g}" for seconds in times)


def _ratio_text(ratio: float) -> str:
    return "no picture" if math.isinf(ratio) else f"{ratio:.2g}"
