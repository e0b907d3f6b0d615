# SPDX-License-Identifier: MIT
"""Order against error for each material: what every order costs, and what it buys."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import shlight
from shlight._arrays import Floats

from .figure import Drawn, Run, Table
from .lobe_lights import Clock, Timed, about_lobe
from .lobes import Residuals, ggx, lambert, oren_nayar, residuals
from .style import BLUE, DARK, GREY, ORANGE, canvas, order_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDERS = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64]
VIEWS = [0.7, 0.2]
DASHES = ["-", ":"]
ROUGHNESSES = [1.0, 0.7, 0.5, 0.3, 0.1]
TIMED_ROUGHNESS = 0.5
WANTED = 1e-2
FLOOR = 1e-6  # below it float32 coefficients tell nothing
# Name, what it is, and the shading method that goes with it.
FITS = [
    ("projection", "projected over the sphere", "plain_harmonics"),
    ("hemisphere", "fitted over the hemisphere", "plain_harmonics"),
    ("warped", "fitted in the lobe's warp", "warped_harmonics"),
]
LOOKS = {"projection": (GREY, "x"), "hemisphere": (ORANGE, "s"), "warped": (BLUE, "o")}
Found = dict[tuple[str, float], Residuals]


def draw(run: Run) -> Drawn:
    lobes = [lambert(), oren_nayar(0.5), *(ggx(roughness) for roughness in ROUGHNESSES)]
    orders = [n for n in ORDERS if not run.quick or n not in (3, 6, 12, 24, 48)]
    found: Found = {}
    cases = [(lobe, cos_o) for lobe in lobes for cos_o in (VIEWS[:1] if run.quick else VIEWS)]
    for i, (lobe, cos_o) in enumerate(cases):
        run.step(0.7 * i / len(cases), lobe.name)
        found[lobe.name, cos_o] = residuals(lobe, cos_o, orders, points=72 if run.quick else 96)
    costs = {}
    for k, method in enumerate(("plain_harmonics", "warped_harmonics")):
        run.step(0.7 + 0.15 * k, f"times of {method}")
        costs[method] = microseconds(method, orders, run.seed, rounds=5 if run.quick else 15)
    _picture(run, orders, found, costs)
    rows = [
        [lobe, cos_o, fit, order, f"{error:.3e}", f"{cost:.3f}"]
        for (lobe, cos_o), found_here in found.items()
        for fit, _, method in FITS
        if (errors := getattr(found_here, fit)) is not None
        for order, error, cost in zip(orders, errors, costs[method], strict=True)
    ]
    run.csv("order_error", ["material", "cos_theta_o", "fit", "order", "relative_l2_error", "microseconds"], rows)
    return Drawn(_explanation(orders, found, costs), [_table(orders, found, costs)])


def microseconds(method: str, orders: Sequence[int], seed: int, rounds: int) -> Floats:
    """Per light on one core, of sphere lights of all sizes about a lobe."""
    rng = np.random.default_rng(seed)
    lights = about_lobe(rng, TIMED_ROUGHNESS**2, VIEWS[0], 0.01 * 140 ** rng.random(96))
    bsdf = shlight.Bsdf.ggx(TIMED_ROUGHNESS, 1.0)
    calls = [Timed(method, {"order": order}) for order in orders]
    return np.array(Clock(rounds).microseconds(lights, bsdf, calls))


def _picture(run: Run, orders: list[int], found: Found, costs: dict[str, Floats]) -> None:
    picture = canvas(14, 7)
    panels = picture.subplots(2, 4).ravel()
    names = list(dict.fromkeys(name for name, _ in found))
    for panel, name in zip(panels, names, strict=False):
        for cos_o, dashes in zip(VIEWS, DASHES, strict=True):
            if (name, cos_o) in found:
                _draw_errors(panel, orders, found[name, cos_o], dashes)
        panel.set_title(name)
        panel.set_ylim(FLOOR / 2, 2)
        panel.axhline(WANTED, color=DARK, lw=0.7)
    for panel in (panels[0], panels[4]):
        panel.set_ylabel("error of f·cos, relative L2")
    last = panels[-1]
    for method, label, fit in (
        ("plain_harmonics", "without a warp", "hemisphere"),
        ("warped_harmonics", "in the warp", "warped"),
    ):
        color, marker = LOOKS[fit]
        last.plot(orders, costs[method], color=color, marker=marker, ms=4, label=label)
    last.set_title("what a light costs")
    last.set_ylabel("µs per light, one core")
    most = max(cost.max() for cost in costs.values())
    last.legend(loc="upper left")
    for panel in panels:
        panel.set_yscale("log")
    ticks = ("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10", "20")
    last.set_yticks([float(tick) for tick in ticks], ticks)
    last.set_ylim(0.02, 1.3 * most)
    last.minorticks_off()
    for panel in panels:
        order_axis(panel, [1, 2, 4, 8, 16, 32, 64])
        panel.set_xlabel("order n" if panel in panels[4:] else "")
    picture.legend(handles=_legend(len({cos_o for _, cos_o in found})), loc="outside lower center", ncols=5)
    run.save(picture, "order_error")


def _draw_errors(panel: Axes, orders: list[int], found: Residuals, dashes: str) -> None:
    for fit, _, _ in FITS:
        errors = getattr(found, fit)
        if errors is None:
            continue
        color, marker = LOOKS[fit]
        panel.plot(orders, np.maximum(errors, FLOOR), color=color, marker=marker, ms=4, ls=dashes)
        if errors[-1] == 0:
            exact = orders[int(np.argmin(errors))]
            panel.text(exact, 1.5 * FLOOR, f"0 from order {exact} on", color=color, va="bottom", fontsize=10)


def _legend(views: int) -> list[Any]:
    from matplotlib.lines import Line2D

    handles = []
    for fit, label, _ in FITS:
        color, marker = LOOKS[fit]
        handles.append(Line2D([], [], color=color, marker=marker, ms=4, label=label))
    for cos_o, dashes in list(zip(VIEWS, DASHES, strict=True))[:views]:
        handles.append(Line2D([], [], color=DARK, ls=dashes, label=f"seen at cosθ_o = {cos_o:g}"))
    return handles


def order_for(orders: Sequence[int], errors: Floats, tolerance: float) -> int | None:
    """The first order from which on the error stays within the tolerance."""
    missed = np.flatnonzero(errors > tolerance)
    first = missed[-1] + 1 if len(missed) else 0
    return orders[first] if first < len(orders) else None


def _priced(orders: Sequence[int], errors: Floats | None, cost: Floats) -> str:
    if errors is None:
        return "–"
    order = order_for(orders, errors, WANTED)
    return f"> {orders[-1]}" if order is None else f"{order} ({cost[list(orders).index(order)]:.2g} µs)"


def _table(orders: list[int], found: Found, costs: dict[str, Floats]) -> Table:
    rows = [
        [name, f"{cos_o:g}", *(_priced(orders, getattr(here, fit), costs[method]) for fit, _, method in FITS)]
        for (name, cos_o), here in found.items()
    ]
    title = f"Order that brings the error of f·cos to {WANTED:g}, and what a light of it costs"
    return Table(title, ["material", "cosθ_o", *(label for _, label, _ in FITS)], rows)


def _explanation(orders: list[int], found: Found, costs: dict[str, Floats]) -> str:
    name = ggx(0.3).name
    here = found[name, VIEWS[0]]
    prices = {fit: _priced(orders, getattr(here, fit), costs[method]) for fit, _, method in FITS}
    exact = order_for(orders, found["Lambert", VIEWS[0]].hemisphere, 0.0)
    at = orders.index(8)
    return (
        f"How well harmonics of order n describe f·cos above the horizon, and what a light of that order costs: {name} "
        f"seen at cosθ_o = {VIEWS[0]:g} is within {WANTED:g} at order {prices['projection']} projected, "
        f"{prices['hemisphere']} fitted over the hemisphere and {prices['warped']} fitted in its warp. "
        f"Lambert is exact from order {exact} on, while its projection still errs by "
        f"{found['Lambert', VIEWS[0]].projection[at]:.0e} at order 8, and an order that a lobe does not need is paid "
        f"for all the same: {costs['warped_harmonics'][at]:.2f} µs at order 8, "
        f"{costs['warped_harmonics'][-1]:.2f} µs at order 64."
    )
