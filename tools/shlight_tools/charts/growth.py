# SPDX-License-Identifier: MIT
"""Time against order, the exponents of its growth (Zhou & Wei 2020, Fig. 6), and what the lobes' matrices amplify."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from shlight_tools.methods import lobe_condition

from .figure import Drawn, Run, Table
from .fused import fused_series, glossy_series
from .lights import CLASSES, LightClass
from .measure import PRECISIONS, Series, all_series, best_seconds, exponent
from .style import BLUE, canvas, order_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDERS = (2, 4, 6, 8, 12, 16, 24, 32, 48, 64)
QUICK_ORDERS = (2, 8, 32, 64)
BANDS = 32
LIBRARY = "exact"
SHOWN = ("sphere_whole", "sphere_clipped", "polygon_clipped")


@dataclass(frozen=True)
class Curve:
    """One method's times."""

    light_class: LightClass
    precision: str
    series: Series
    orders: Sequence[int]
    seconds: NDArray[np.float64]

    def exponent(self) -> float:
        return exponent(self.orders, list(self.seconds))


def draw(run: Run) -> Drawn:
    orders = QUICK_ORDERS if run.quick else ORDERS
    cases = [(c, precision) for c in CLASSES if c.name in SHOWN for precision in PRECISIONS]
    curves: list[Curve] = []
    for i, (light_class, precision) in enumerate(cases):
        all_of = all_series(light_class.kind) + fused_series(precision)
        if light_class.name == "sphere_clipped":
            all_of += glossy_series(light_class.kind, precision)
        lights = light_class.lights(run.seed, 64)
        times = []
        for k, order in enumerate(orders):
            run.step((i + k / len(orders)) / len(cases), f"{light_class.name} {precision} order {order}")
            rounds, budget, least = (3, 0.003, 1) if run.quick else (11, 0.005, 4)
            times.append(best_seconds(all_of, lights, order, precision, rounds=rounds, budget=budget, least=least))
        for series, seconds in zip(all_of, np.transpose(times), strict=True):
            curves.append(Curve(light_class, precision, series, orders, seconds))
    _draw_times(run, curves)
    conditions = [lobe_condition(band) for band in range(BANDS)]
    _draw_conditions(run, conditions)
    run.csv("growth", ["lights", "precision", "method", "order", "microseconds"], _numbers(curves))
    run.csv("growth_condition", ["band", "condition"], [[i, f"{c:.6g}"] for i, c in enumerate(conditions)])
    return Drawn(_explanation(curves, conditions), [_exponents(curves), _conditions(conditions)])


def _draw_times(run: Run, curves: list[Curve]) -> None:
    shown = [c for c in curves if c.precision == "float32"]
    classes = list(dict.fromkeys(c.light_class for c in shown))
    picture = canvas(13, 6.2)
    panels = picture.subplots(1, len(classes), sharey=True)
    for panel, light_class in zip(panels, classes, strict=True):
        for curve in shown:
            if curve.light_class == light_class:
                _draw_curve(panel, curve)
        panel.set_title(light_class.title.replace(", half", "\nhalf"))
        order_axis(panel, [2, 4, 8, 16, 32, 64])
        panel.set_yscale("log")
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), title="from n = 8 on")
    panels[0].set_ylabel("µs per light, one core, float32")
    run.save(picture, "growth", "Times in float32, and the exponents of their growth")


def _draw_curve(panel: Axes, curve: Curve) -> None:
    series, power = curve.series, curve.exponent()
    panel.plot(
        curve.orders,
        1e6 * curve.seconds,
        color=series.color,
        marker=series.marker,
        ls=series.dashes,
        label=f"{series.label}: n$^{{{power:.1f}}}$" if np.isfinite(power) else series.label,
    )


def _draw_conditions(run: Run, conditions: list[float]) -> None:
    picture = canvas(7, 4)
    panel = picture.subplots()
    panel.plot(range(BANDS), conditions, color=BLUE, marker="o", ms=4)
    panel.set(yscale="log", xlabel="band l", ylabel="condition number")
    panel.set_xticks([0, 5, 10, 15, 20, 25, 31])
    panel.set_title("Matrices of the 2l + 1 lobes of zonal factorization")
    run.save(picture, "growth_condition", "How much the lobes' matrices may amplify an error")


def _numbers(curves: list[Curve]) -> list[list[object]]:
    return [
        [c.light_class.name, c.precision, c.series.label, order, f"{1e6 * second:.4g}"]
        for c in curves
        for order, second in zip(c.orders, c.seconds, strict=True)
        if np.isfinite(second)
    ]


def _exponents(curves: list[Curve]) -> Table:
    rows = []
    for c in curves:
        reach = max(order for order, second in zip(c.orders, c.seconds, strict=True) if np.isfinite(second))
        times = dict(zip(c.orders, 1e6 * c.seconds, strict=True))
        cells = [f"{times[n]:.2f}" if np.isfinite(times[n]) else "" for n in (8, 32)]
        power = [f"{c.exponent():.2f}", f"8 … {reach}"] if np.isfinite(c.exponent()) else ["", ""]
        rows.append([c.light_class.name, c.precision, c.series.label, *power, *cells])
    header = ["lights", "precision", "method", "exponent", "orders", "µs at n = 8", "µs at n = 32"]
    return Table("Growth of time with the order n", header, rows)


def _conditions(conditions: list[float]) -> Table:
    bands = (1, 3, 7, 15, 23, 31)
    rows = [["condition number", *(f"{conditions[band]:.3g}" for band in bands)]]
    return Table("Matrices of the lobes of zonal factorization", ["band", *map(str, bands)], rows)


def _explanation(curves: list[Curve], conditions: list[float]) -> str:
    library, others = (
        [power for c in curves if (c.series.method == LIBRARY) == own and np.isfinite(power := c.exponent())]
        for own in (True, False)
    )
    compared = f", the others' as n^{min(others):.1f} … n^{max(others):.1f}" if others else ""
    return (
        "Time for the coefficients of one light on one core over the order n, with the exponent of its growth from "
        "n = 8 on, and the condition numbers that zonal factorization pays for its lobes. "
        "Stars are calls that take Eq. 5 at once, shade_spheres and shade_polygons. "
        f"The library's own time grows as n^{min(library):.1f} … n^{max(library):.1f}{compared}; the lobes' matrix of "
        f"band 15 has the condition number {conditions[15]:.2g}."
    )
