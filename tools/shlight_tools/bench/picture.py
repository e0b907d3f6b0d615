# SPDX-License-Identifier: MIT
"""`./dev bench picture`: error against time of shlight and of other renderers, each beside its own converged picture.

Whole renders of small scenes on two threads, in turns; a point is the median of the rounds. shlight's pictures of
direct light are those that one render shows meanwhile; those of light that bounces have time limits, and are compared
with Cycles' converged picture. The others render anew with twice as many samples each time. Their converged pictures
are kept in the folder of the results. Scenes whose light bounces have a sheet of pictures too.
"""

from __future__ import annotations

import csv
import hashlib
import importlib.util
import math
import pickle
import statistics
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import shlight
from shlight.commands import CommandError, Parser, check_folder, run_command, work_folder
from shlight.metrics import rel_mse, rel_mse_without_noise
from shlight.progress import Progress

from .bounced_scenes import BOUNCED_SCENES
from .picture_renderers import Cycles, Image, Mitsuba, Renderer, Shlight
from .picture_scenes import PICTURE_SCENES, PictureScene
from .picture_sheet import Panel, draw, panels

TIMES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
GOALS = (1e-2, 1e-3, 1e-4)
OURS, OURS_DENOISED = "shlight", "shlight + OpenImageDenoise"
REFERENCES = "references"  # folder
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
FULL_BOUNCED = Effort(256, 1, 8.0, 120.0)
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
        steps = self.renderer == OURS and self.scene not in BOUNCED_SCENES
        return statistics.median(_error_at(points, seconds, steps=steps) for points in self.rounds)

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
    return run_command("./dev bench picture", lambda: _work(argv), when_interrupted="nothing was written")


def _work(argv: list[str]) -> None:
    parser = Parser(prog="./dev bench picture", description=__doc__)
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
    full = FULL_BOUNCED if options.bounces else FULL
    curves, sheet = _measured(names, QUICK if options.quick else full, _renderers(), options.out / REFERENCES)
    with work_folder(options.out) as folder:
        _write_csv(folder / "picture.csv", curves)
        _draw(folder / "picture.png", curves)
        if sheet:
            draw(folder / "sheet.jpg", sheet)
        options.out.mkdir(parents=True, exist_ok=True)
        written = [path.name for path in folder.iterdir() if path.is_file()]
        for name in written:
            (folder / name).replace(options.out / name)
    print(_tables(curves))
    print(f"results: {', '.join(str(options.out / name) for name in sorted(written))}")


Make = Callable[[PictureScene, int], Renderer]


def _renderers() -> list[Make]:
    """All that can be used here; a line says why another cannot."""
    made: list[Make] = [Shlight]
    if shlight.has_denoiser():
        made.append(lambda scene, size: Shlight(scene, size, denoised=True))
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


Sheet = dict[str, list[Panel]]


def _measured(names: list[str], effort: Effort, makes: list[Make], kept: Path) -> tuple[list[Curve], Sheet]:
    progress = Progress(len(names))
    curves: list[Curve] = []
    sheet: Sheet = {}
    try:
        for name in names:
            progress.begin(name)
            renderers = [make(SCENES[name](), effort.size) for make in makes]
            references = _references(name, effort, renderers, progress, kept)
            curves += _measured_scene(name, effort, renderers, references, progress)
            if name in BOUNCED_SCENES and Cycles in references:
                progress.step(0.9, "sheet")
                sheet[name] = panels(renderers, references[Cycles])
            progress.end()
    except BaseException:
        progress.interrupt()
        raise
    return curves, sheet


References = dict[type[Renderer], tuple[Image, Image]]


def _references(name: str, effort: Effort, renderers: list[Renderer], progress: Progress, kept: Path) -> References:
    """Converged pictures by kinds of renderers."""
    found: References = {}
    for renderer in reversed(renderers):
        progress.step(0.0, f"{renderer.name}: converged picture")
        if type(renderer) not in found:  # it is not denoised
            if isinstance(renderer, Shlight) and name in BOUNCED_SCENES and Cycles in found:
                found[Shlight] = found[Cycles]
            else:
                found[type(renderer)] = _halves(name, effort, renderer, kept)
    return found


def _halves(name: str, effort: Effort, renderer: Renderer, kept: Path) -> tuple[Image, Image]:
    if isinstance(renderer, Shlight):
        return renderer.halves(effort.reference_seconds)
    content = hashlib.sha256(pickle.dumps(SCENES[name]())).hexdigest()[:12]
    path = kept / f"{name}_{type(renderer).__name__}_{effort.size}_{effort.reference_seconds:g}_{content}.npy"
    if not path.exists():
        halves = renderer.halves(effort.reference_seconds)
        kept.mkdir(parents=True, exist_ok=True)
        np.save(path, np.stack(halves))
    first, second = np.load(path)
    return first, second


def _measured_scene(
    name: str, effort: Effort, renderers: list[Renderer], references: References, progress: Progress
) -> list[Curve]:
    curves = [Curve(name, renderer.name) for renderer in renderers]
    steps = len(renderers) * (1 + effort.rounds)
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
    from shlight_tools.charts.style import BLUE, GREEN, GREY, ORANGE, PINK, canvas, look

    colors = {
        OURS: BLUE,
        OURS_DENOISED: PINK,
        "Cycles": GREY,
        DENOISED: ORANGE,
        "Mitsuba direct": GREEN,
        "Mitsuba path": GREEN,
    }
    names = list(dict.fromkeys(curve.scene for curve in curves))
    columns = min(len(names), 3)
    rows = math.ceil(len(names) / columns)
    with look():
        figure = canvas(5.2 * columns, 4.2 * rows)
        axes = figure.subplots(rows, columns, squeeze=False)
        for name, axis in zip(names, axes.flat, strict=False):
            shown = []
            for curve in (curve for curve in curves if curve.scene == name):
                times = np.geomspace(0.05, TIMES[-1], 60)
                errors = [curve.error_at(float(t)) for t in times]
                axis.loglog(times, errors, color=colors[curve.renderer], label=curve.renderer)
                shown += [error for error in errors if 0 < error < math.inf]
            if shown:  # where all are alike but for rounding, matplotlib finds no range
                axis.set_ylim(min(shown) / 2, max(shown) * 2)
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


def _ratio(curves: list[Curve], curve: Curve, seconds: float, renderer: str = OURS) -> float:
    ours = next(own for own in curves if own.scene == curve.scene and own.renderer == renderer)
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
    for ours in dict.fromkeys(curve.renderer for curve in bounced if curve.renderer in (OURS, OURS_DENOISED)):
        lines += _bound(bounced, DENOISED, late, late, 2.0, ours)
    return lines


def _bound(
    curves: list[Curve],
    name: str,
    times: tuple[float, ...],
    median_times: tuple[float, ...],
    least: float,
    ours: str = OURS,
) -> list[str]:
    """A line of the lowest ratio of a renderer to ours at some times, and of the median at others."""
    own = [curve for curve in curves if curve.renderer == name]
    if not own:
        return []
    lowest = min(_ratio(curves, curve, t, ours) for curve in own for t in times)
    median = statistics.median(_ratio(curves, curve, t, ours) for curve in own for t in median_times)
    return [
        f"{name} ÷ {ours}: at least {_ratio_text(lowest)} from {times[0]:g} to {times[-1]:g} s (bound 1), "
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
