# SPDX-License-Identifier: MIT
"""Time against error: a point for each method and order, for each class of lights in both precisions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .figure import Drawn, Run, Table
from .fused import fused_series
from .lights import CLASSES, LightClass, Lights
from .measure import PRECISIONS, Series, all_series, batch_size, best_seconds, truth
from .style import canvas, decades

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDERS = (1, 2, 4, 8, 16, 32)
QUICK_ORDERS = (2, 8, 32)
DRAWN_FROM = 2  # order 1 is the solid angle alone
LOWEST = {"float32": 1e-9, "float64": 1e-18}  # errors below are drawn here
HIGHEST = 1e4  # errors above, and what is not finite, are drawn here with an arrow
LIBRARY = "exact"
PLACES = [(4, 3), (4, -10), (-9, 4), (-10, -10)]  # of the numbers beside the points, so that they share the room


@dataclass(frozen=True)
class Point:
    """One method at one order."""

    series: Series
    order: int
    microseconds: float
    median: float
    worst: float
    lights: int  # that the errors are of


Measured = dict[tuple[str, str], list[Point]]  # by class and precision


def draw(run: Run) -> Drawn:
    measured: Measured = {}
    orders = QUICK_ORDERS if run.quick else ORDERS
    for i, light_class in enumerate(CLASSES):
        run.step(i / len(CLASSES), f"{light_class.name}, truth")
        lights = light_class.lights(run.seed, 16 if run.quick else 200)
        true = truth(lights, orders[-1])
        for j, precision in enumerate(PRECISIONS):
            points = []
            for k, order in enumerate(orders):
                share = (i + (1 + j + k / len(orders)) / (1 + len(PRECISIONS))) / len(CLASSES)
                run.step(share, f"{light_class.name} {precision} order {order}")
                all_of = all_series(light_class.kind) + fused_series(precision)
                points += _points(run.quick, all_of, lights, true, order, precision)
            measured[light_class.name, precision] = points
    for light_class in CLASSES:
        for precision in PRECISIONS:
            _draw_picture(run, light_class, precision, measured[light_class.name, precision])
    header = ["lights", "precision", "method", "order", "microseconds", "median_error", "worst_error", "count"]
    run.csv("speed_error", header, _numbers(measured))
    return Drawn(_explanation(measured), [_ratios(measured, orders), _errors(measured, orders[-3:])])


def _points(
    quick: bool, all_of: list[Series], lights: Lights, true: NDArray[np.float64], order: int, precision: str
) -> list[Point]:
    able = [series for series in all_of if order <= series.largest_order]
    rounds, batch, least, budget = (3, 0.003, 1, 0.01) if quick else (11, 0.004, 4, 0.1)
    seconds = best_seconds(able, lights, order, precision, rounds=rounds, budget=batch, least=least)
    points = []
    for series, second in zip(able, seconds, strict=True):
        # A slow method gets only as many of the lights as it can do in time.
        count = batch_size(series, lights, order, precision, budget, len(lights))
        values = series.coefficients(lights.take(slice(0, count)), order, precision)
        errors = series.errors(values, true[:count, : order * order])
        points.append(Point(series, order, 1e6 * second, float(np.median(errors)), float(errors.max()), count))
    return points


def _numbers(measured: Measured) -> list[list[object]]:
    return [
        [*key, p.series.label, p.order, f"{p.microseconds:.4g}", f"{p.median:.3g}", f"{p.worst:.3g}", p.lights]
        for key, points in measured.items()
        for p in points
    ]


def _draw_picture(run: Run, light_class: LightClass, precision: str, points: list[Point]) -> None:
    picture = canvas(13, 6.2)
    panels = picture.subplots(1, 2, sharex=True, sharey=True)
    for panel, which in zip(panels, ("median", "worst"), strict=True):
        for i, series in enumerate(all_of_points(points)):
            own = [p for p in points if p.series == series and p.order >= DRAWN_FROM]
            errors = [getattr(p, which) for p in own]
            _draw_series(panel, series, own, errors, LOWEST[precision], PLACES[i % len(PLACES)])
        panel.set(xscale="log", yscale="log", xlabel="µs per light, one core")
        panel.set_title(f"{which} error of the lights")
    panels[0].set_xlim(decades(panels[0].get_xlim()))
    panels[0].set_ylim(decades(panels[0].get_ylim()))
    panels[0].set_ylabel("largest error of a coefficient ÷ L$_{00}$")
    picture.suptitle(f"{light_class.title}; {precision}; numbers are orders (↑: error beyond the scale)")
    picture.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    run.save(picture, f"speed_error_{light_class.name}_{precision}", f"{light_class.title}, {precision}")


def all_of_points(points: list[Point]) -> list[Series]:
    return [p.series for p in points if p.order == min(q.order for q in points)]


def _draw_series(
    panel: Axes, series: Series, points: list[Point], errors: list[float], lowest: float, place: tuple[int, int]
) -> None:
    times = [p.microseconds for p in points]
    heights = np.clip(np.nan_to_num(errors, posinf=HIGHEST), lowest, HIGHEST)
    panel.plot(times, heights, color=series.color, marker=series.marker, ls=series.dashes, label=series.label, ms=5)
    for point, height, error in zip(points, heights, errors, strict=True):
        panel.annotate(
            f"{point.order}{'' if error <= HIGHEST else ' ↑'}",
            (point.microseconds, height),
            xytext=place,
            textcoords="offset points",
            color=series.color,
            fontsize=8,
        )


def _ratios(measured: Measured, orders: Sequence[int]) -> Table:
    """Times of the library ÷ those of each other method."""
    rows = []
    for (name, precision), points in measured.items():
        library = {p.order: p.microseconds for p in points if p.series.label == LIBRARY}
        for series in all_of_points(points):
            times = {p.order: p.microseconds for p in points if p.series == series}
            if series.method != LIBRARY:
                cells = [f"{library[n] / times[n]:.2g}" if n in times else "" for n in orders]
                rows.append([name, precision, series.label, *cells])
    header = ["lights", "precision", "other method", *(f"n = {n}" for n in orders)]
    return Table("Time of `exact` ÷ time of the other method", header, rows)


def _errors(measured: Measured, shown: Sequence[int]) -> Table:
    rows = []
    for (name, precision), points in measured.items():
        for series in all_of_points(points):
            of = {p.order: p for p in points if p.series == series}
            cells = [f"{of[n].median:.1e} · {of[n].worst:.1e}" if n in of else "" for n in shown]
            rows.append([name, precision, series.label, *cells])
    header = ["lights", "precision", "method", *(f"n = {n}" for n in shown)]
    return Table("Error ÷ L_00: median · worst of the lights", header, rows)


def _explanation(measured: Measured) -> str:
    """Time and error of the library, and of the others relative to it."""
    errors: dict[str, float] = {}
    faster = cases = 0
    for (_, precision), points in measured.items():
        of_library = {p.order: p for p in points if p.series.label == LIBRARY}
        worst = max(p.worst for p in of_library.values())
        errors[precision] = max(worst, errors.get(precision, 0.0))
        others = [p for p in points if p.series.method != LIBRARY]
        cases += len(others)
        faster += sum(of_library[p.order].microseconds < p.microseconds for p in others)
    text = (
        "Each line is a method, each point on it an order: left and low is better, and methods above their precision's "
        "floor lose digits. Stars are calls that take Eq. 5 at once, with the error of Lambert's radiance. "
        f"The library's own errs by at most {errors['float32']:.0e} · L_00 in float32 and {errors['float64']:.0e} · "
        "L_00 in float64 at any order and light here"
    )
    return text + (f", and is the faster one in {faster} of {cases} comparisons with another method." if cases else ".")
