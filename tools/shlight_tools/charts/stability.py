# SPDX-License-Identifier: MIT
"""Where each method fails: maps of the error over the light's elevation and its half angle.

The error is the largest of a coefficient, ÷ the L_00 of what the horizon keeps, or ÷ a thousandth of the whole light's
if that is more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .figure import Drawn, Run, Table
from .lights import Array, Kind, Lights, spheres, squares
from .measure import PRECISIONS, Series, batch_size, main_series, relative_errors, truth
from .style import HIDDEN, NOT_FINITE, WORSE, canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDERS = (8, 16)
LEAST_SHARE = 1e-3  # of the whole light's L_00
LIMIT = 1e-3
AZIMUTH = 0.6  # no axis of the frame, where errors might cancel
SMALLEST, LARGEST, LARGEST_ZOOMED = 1e-4, 1.5, 1.4
EXPONENTS = {"float32": range(-8, 1), "float64": range(-16, 1, 2)}  # of the colours
NEAREST, FARTHEST = 1e-7, 1e-1  # of a zoomed axis, both ways from 0
SIZES = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)  # of the table by half angle
UNKNOWN, COVERED = np.nan, -1.0  # in maps: not measured; hidden below the horizon


@dataclass(frozen=True)
class Region:
    """Some lights over two axes."""

    name: str
    title: str
    x_label: str
    elevation: Callable[[Array, Array], Array]  # from x and the half angle
    zoomed: bool  # x runs from NEAREST to FARTHEST, both ways and over 0, in logarithmic steps; else over all degrees
    orders_drawn: Sequence[int]

    def xs(self, quick: bool) -> Array:
        if not self.zoomed:
            return np.linspace(-90, 90, 13 if quick else 61)
        one_way = np.geomspace(NEAREST, FARTHEST, 7 if quick else 25)
        return np.concatenate([-one_way[::-1], [0.0], one_way])

    def half_angles(self, quick: bool) -> Array:
        return np.geomspace(SMALLEST, LARGEST_ZOOMED if self.zoomed else LARGEST, 9 if quick else 37)


REGIONS = [
    Region("map", "all lights", "elevation [°]", lambda x, half: np.radians(x), False, ORDERS),
    Region("horizon", "centre at the horizon", "elevation [rad]", lambda x, half: x, True, ORDERS[-1:]),
    Region("sets", "lower edge at the horizon", "edge's elevation [rad]", lambda x, half: x + half, True, ORDERS[-1:]),
    Region("rises", "upper edge at the horizon", "edge's elevation [rad]", lambda x, half: x - half, True, ORDERS[-1:]),
]
KINDS: dict[Kind, str] = {"sphere": "spheres", "polygon": "facing squares"}


@dataclass(frozen=True)
class Map:
    """One method over a region."""

    kind: Kind
    region: Region
    order: int
    precision: str
    series: Series
    errors: NDArray[np.float64]  # (half angles, xs); infinite: not finite

    def measured(self) -> NDArray[np.float64]:
        """The errors of all lights that are not hidden, and whatever is not finite."""
        known: NDArray[np.float64] = self.errors[~np.isnan(self.errors) & (self.errors != COVERED)]
        return known

    def worst(self) -> float:
        """The largest error among those that are finite."""
        finite = self.measured()
        return float(np.max(finite, initial=0.0, where=np.isfinite(finite)))

    def share_over_limit(self) -> float:
        return float(np.mean(self.measured() > LIMIT))

    def share_not_finite(self) -> float:
        return float(np.mean(np.isinf(self.measured())))


def draw(run: Run) -> Drawn:
    maps: list[Map] = []
    places = [(kind, region) for kind in KINDS for region in REGIONS]
    for i, (kind, region) in enumerate(places):
        maps += _measure(run, kind, region, lambda share, text, i=i: run.step((i + share) / len(places), text))  # type: ignore[misc]
        for order in ORDERS:
            together = [m for m in maps if (m.kind, m.region, m.order) == (kind, region, order)]
            if order in region.orders_drawn:
                _draw_picture(run, together)
            _write_numbers(run, together)
    return Drawn(_explanation(maps), [_table(maps), _table_by_size(maps, run.quick)])


def _measure(run: Run, kind: Kind, region: Region, step: Callable[[float, str], None]) -> list[Map]:
    xs, half_angles = region.xs(run.quick), region.half_angles(run.quick)
    x, half = (grid.ravel() for grid in np.meshgrid(xs, half_angles))
    make = spheres if kind == "sphere" else squares
    lights = make(region.elevation(x, half), half, AZIMUTH)
    place = f"{KINDS[kind]}, {region.title}"
    true = truth(lights, max(ORDERS), lambda share: step(0.5 * share, f"{place}: truth"))
    whole = (2 * np.pi * 2 * np.sin(half / 2) ** 2 if kind == "sphere" else 4 * np.arcsin(np.sin(half) ** 2)) / np.sqrt(
        4 * np.pi
    )
    wanted = [(order, precision, s) for order in ORDERS for precision in PRECISIONS for s in main_series(kind)]
    maps = []
    for i, (order, precision, series) in enumerate(wanted):
        step(0.5 + 0.5 * i / len(wanted), f"{place}: {series.label}")
        if order <= series.largest_order:
            errors = _errors(series, lights, order, precision, true, LEAST_SHARE * whole, xs.size, run.quick)
            maps.append(Map(kind, region, order, precision, series, errors))
    return maps


def _errors(
    series: Series,
    lights: Lights,
    order: int,
    precision: str,
    true: NDArray[np.float64],
    least: NDArray[np.float64],
    columns: int,
    quick: bool,
) -> NDArray[np.float64]:
    """The map of a method; of a slow one only every so many-th row and column."""
    affordable = batch_size(series, lights, order, precision, 0.01 if quick else 0.4, len(lights))
    stride = int(np.ceil(np.sqrt(len(lights) / affordable)))
    wanted = np.zeros((len(lights) // columns, columns), dtype=bool)
    wanted[::stride, ::stride] = True
    which = np.flatnonzero(wanted)
    errors = relative_errors(series.coefficients(lights.take(which), order, precision), true[which], least[which])
    errors[(true[which, 0] == 0) & np.isfinite(errors)] = COVERED
    result = np.full(wanted.shape, UNKNOWN)
    result.ravel()[which] = errors
    return result


def _draw_picture(run: Run, maps: list[Map]) -> None:
    first = maps[0]
    all_of = list(dict.fromkeys(m.series.label for m in maps))
    picture = canvas(1.8 + 2.3 * len(all_of), 6.6)
    panels = picture.subplots(len(PRECISIONS), len(all_of), sharex=True, sharey=True, squeeze=False)
    for row, precision in zip(panels, PRECISIONS, strict=True):
        image: Any = None
        for panel, label in zip(row, all_of, strict=True):
            of = next(m for m in maps if (m.precision, m.series.label) == (precision, label))
            image = _draw_map(panel, of, run.quick)
            if precision == PRECISIONS[0]:
                panel.set_title(label.replace(", ", "\n"))
        row[0].set_ylabel(f"{precision}\nhalf angle σ [rad]")
        bar = picture.colorbar(image, ax=list(row), label="error ÷ L$_{00}$", aspect=16)
        bar.set_ticks([10.0**e for e in EXPONENTS[precision]], labels=[_power(10.0**e) for e in EXPONENTS[precision]])
    for panel in panels[-1]:
        scale = "\nlogarithmic from ±10$^{-7}$" if first.region.zoomed else ""
        panel.set_xlabel(first.region.x_label + scale)
    title = f"{KINDS[first.kind]}, {first.region.title}, order {first.order}"
    title = title[0].upper() + title[1:]
    picture.suptitle(title)
    picture.legend(handles=_legend(), loc="outside lower center", ncols=3)
    run.save(picture, _name(first), f"{title}; slow methods on coarser grids")


def _legend() -> list[Any]:
    from matplotlib.patches import Patch

    texts = {HIDDEN: "wholly below the horizon", WORSE: "error above L$_{00}$", NOT_FINITE: "not finite"}
    return [Patch(facecolor=color, label=text) for color, text in texts.items()]


def _draw_map(panel: Axes, of: Map, quick: bool) -> Any:
    import matplotlib as mpl
    from matplotlib.colors import BoundaryNorm

    bounds = [10.0**exponent for exponent in EXPONENTS[of.precision]]
    colors = mpl.colormaps["viridis"].resampled(len(bounds)).with_extremes(over=WORSE)
    known = _filled(of.errors)
    finite = np.isfinite(known) & (known != COVERED)
    panel.set_facecolor(HIDDEN)
    image = panel.imshow(
        np.ma.masked_where(~finite, np.maximum(known, bounds[0])),
        cmap=colors,
        norm=BoundaryNorm(bounds, len(bounds), extend="max"),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
    )
    broken = np.zeros((*known.shape, 4))
    broken[np.isinf(known)] = mpl.colors.to_rgba(NOT_FINITE)
    panel.imshow(broken, origin="lower", aspect="auto", interpolation="nearest")
    panel.grid(visible=False)
    xs, half_angles = of.region.xs(quick), of.region.half_angles(quick)
    if not of.region.zoomed:
        panel.set_xticks(np.interp([-90, -45, 0, 45, 90], xs, np.arange(xs.size)), ["−90", "−45", "0", "45", "90"])
    else:
        shown = np.array([-1e-2, 0.0, 1e-2])
        panel.set_xticks(
            np.interp(_log_both_ways(shown), _log_both_ways(xs), np.arange(xs.size)), [_power(x) for x in shown]
        )
    decades = np.array([1e-4, 1e-3, 1e-2, 1e-1, 1.0])
    at = np.interp(np.log(decades), np.log(half_angles), np.arange(half_angles.size))
    panel.set_yticks(at, [_power(x) for x in decades])
    return image


def _power(x: float) -> str:
    if x in (0.0, 1.0):
        return f"{x:g}"
    return f"{'−' if x < 0 else ''}$10^{{{round(np.log10(abs(x)))}}}$"


def _log_both_ways(x: Array) -> Array:
    """Even steps for numbers that grow from NEAREST both ways."""
    return np.sign(x) * np.log(np.maximum(np.abs(x) / NEAREST, 1.0) * np.e)


def _filled(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """The map with each measured cell spread over those after it that were left out."""
    rows, columns = (np.flatnonzero(~np.isnan(errors).all(axis=axis)) for axis in (1, 0))
    row_of = rows[np.searchsorted(rows, np.arange(errors.shape[0]), side="right") - 1]
    column_of = columns[np.searchsorted(columns, np.arange(errors.shape[1]), side="right") - 1]
    filled: NDArray[np.float64] = errors[np.ix_(row_of, column_of)]
    return filled


def _write_numbers(run: Run, maps: list[Map]) -> None:
    """A row for each light, a column for each method and precision."""
    first = maps[0]
    xs, half_angles = first.region.xs(run.quick), first.region.half_angles(run.quick)
    header = [first.region.x_label, "half angle [rad]", *(f"{m.series.label}, {m.precision}" for m in maps)]
    rows = (
        [f"{x:.4g}", f"{half:.4g}", *(_text(m.errors[i, j]) for m in maps)]
        for i, half in enumerate(half_angles)
        for j, x in enumerate(xs)
    )
    run.csv(_name(first), header, rows)


def _text(error: float) -> str:
    if np.isnan(error):
        return ""
    return "hidden" if error == COVERED else f"{error:.2e}"


def _name(of: Map) -> str:
    return f"stability_{of.kind}_{of.region.name}_{of.order}"


def _table(maps: list[Map]) -> Table:
    columns = [(precision, order) for precision in PRECISIONS for order in ORDERS]
    cells: dict[tuple[str, str, str], dict[tuple[str, int], str]] = {}
    for m in maps:
        text = f"{m.worst():.0e} · {100 * m.share_over_limit():.1f} % · {100 * m.share_not_finite():.1f} %"
        cells.setdefault((KINDS[m.kind], m.region.title, m.series.label), {})[m.precision, m.order] = text
    header = ["lights", "region", "method", *(f"{precision}, n = {order}" for precision, order in columns)]
    rows = [[*key, *(of.get(column, "") for column in columns)] for key, of in cells.items()]
    title = (
        f"Worst finite error ÷ L_00 · share of visible lights above {LIMIT:g} · share not finite "
        f"(L_00 of what the horizon keeps, or {LEAST_SHARE:g} of the whole light's if that is more)"
    )
    return Table(title, header, rows)


def _table_by_size(maps: list[Map], quick: bool) -> Table:
    rows = []
    for m in maps:
        if (m.region.name, m.order) == ("map", max(ORDERS)):
            half_angles = m.region.half_angles(quick)
            cells = [_median_near(m, half_angles, size) for size in SIZES]
            rows.append([KINDS[m.kind], m.precision, m.series.label, *cells])
    header = ["lights", "precision", "method", *(f"σ = {size:g}" for size in SIZES)]
    return Table(f"Median error ÷ L_00 by half angle, all elevations, n = {max(ORDERS)}", header, rows)


def _median_near(of: Map, half_angles: Array, size: float) -> str:
    """Over the lights within a quarter of a decade."""
    errors = of.errors[np.abs(np.log10(half_angles / size)) <= 0.26]
    known = errors[~np.isnan(errors) & (errors != COVERED)]
    return f"{np.median(known):.0e}" if known.size else ""


def _explanation(maps: list[Map]) -> str:
    worst = {p: max(m.worst() for m in maps if m.series.label == "exact" and m.precision == p) for p in PRECISIONS}
    text = (
        "Errors over elevation and half angle of the light, and closer about the three places where methods lose "
        f"digits: the library's own errs nowhere by more than {worst['float32']:.0e} · L_00 in float32 and "
        f"{worst['float64']:.0e} · L_00 in float64. "
    )
    shares = [
        f"{m.series.label} {100 * m.share_over_limit():.0f} %"
        for m in maps
        if (m.region.name, m.kind, m.order, m.precision) == ("map", "sphere", max(ORDERS), "float32")
    ]
    return (
        text
        + f"Of the map of spheres in float32 at order {max(ORDERS)}, this share is worse than {LIMIT:g}: "
        + (f"{', '.join(shares)}.")
    )
