# SPDX-License-Identifier: MIT
"""Time against order, and the exponents of its growth (Zhou & Wei 2020, Fig. 6)."""

from __future__ import annotations

import numpy as np

from .figure import Drawn, Run, Table
from .lights import CLASSES
from .measure import PRECISIONS, all_series, best_seconds, exponent
from .style import canvas, order_axis

ORDERS = (2, 4, 6, 8, 12, 16, 24, 32, 48, 64)
LIBRARY = "exact"
SHOWN = ("sphere_whole", "sphere_clipped", "polygon_clipped")


def draw(run: Run) -> Drawn:
    orders = [n for n in ORDERS if not run.quick or n in (2, 8, 16, 32, 64)]
    classes = [c for c in CLASSES if c.name in SHOWN]
    shape = (3 if run.quick else 10, 0.003 if run.quick else 0.006)
    picture = canvas(13, 5.6)
    panels = picture.subplots(1, len(classes), sharey=True)
    rows, table = [], []
    exponents = {}
    for i, (panel, light_class) in enumerate(zip(panels, classes, strict=True)):
        lights = light_class.lights(run.seed, 64)
        all_of = all_series(light_class.kind)
        for j, precision in enumerate(PRECISIONS):
            times = []
            for k, order in enumerate(orders):
                share = (i + (j + k / len(orders)) / len(PRECISIONS)) / len(classes)
                run.step(share, f"{light_class.name} {precision} order {order}")
                times.append(best_seconds(all_of, lights, order, precision, rounds=shape[0], budget=shape[1]))
            for series, seconds in zip(all_of, np.transpose(times), strict=True):
                power = exponent(orders, list(seconds))
                exponents[light_class.name, precision, series.label] = power
                reach = max(n for n, t in zip(orders, seconds, strict=True) if np.isfinite(t))
                cells = [f"{1e6 * seconds[orders.index(n)]:.2f}" for n in (8, 32)]
                table.append([light_class.name, precision, series.label, f"{power:.2f}", f"8 … {reach}", *cells])
                for order, second in zip(orders, seconds, strict=True):
                    if np.isfinite(second):
                        rows.append([light_class.name, precision, series.label, order, f"{1e6 * second:.4g}"])
                if precision == "float32":
                    panel.plot(
                        orders,
                        1e6 * seconds,
                        color=series.color,
                        marker=series.marker,
                        ls=series.dashes,
                        label=f"{series.label}: n^{power:.1f}",
                    )
        panel.set_title(light_class.title.replace(", half", "\nhalf"))
        order_axis(panel, [2, 4, 8, 16, 32, 64])
        panel.set_yscale("log")
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14))
    panels[0].set_ylabel("µs per light, one core, float32")
    run.save(picture, "growth")
    run.csv("growth", ["lights", "precision", "method", "order", "microseconds"], rows)
    library, others = (
        [power for (_, _, label), power in exponents.items() if (label == LIBRARY) == own and np.isfinite(power)]
        for own in (True, False)
    )
    text = (
        "Time for the coefficients of one light on one core, with the exponent of its growth from order 8 on. "
        f"The library's own grows as n^{min(library):.1f} … n^{max(library):.1f}"
    )
    text += f", the others as n^{min(others):.1f} … n^{max(others):.1f}." if others else "."
    header = ["lights", "precision", "method", "exponent", "orders", "µs at n = 8", "µs at n = 32"]
    return Drawn(text, [Table("Growth of time with the order n, fitted from n = 8 on", header, table)])
