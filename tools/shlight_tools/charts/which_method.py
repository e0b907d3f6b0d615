# SPDX-License-Identifier: MIT
"""Which method where: the cheapest way to shade a glossy surface by a sphere light within a tolerance.

A cell is a half angle σ of the light, a roughness and a view. A way meets a tolerance there if its error, the root mean
square over the cell's lights, is within that part of the brightest of them: what relMSE makes of a picture that is
exposed for what it shows. Errors ÷ albedo would let every way pass that drops a small light altogether, and errors ÷
each light's own value would ask of all for the last digits of light that the lobe hardly reflects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

import shlight
from shlight._arrays import Floats
from shlight_tools import methods

from .figure import Drawn, Run, Table
from .lobe_lights import Clock, LobeLights, Timed, about_lobe
from .style import AMBER, BLUE, BROWN, DARK, GREEN, HIDDEN, OLIVE, ORANGE, PINK, SKY, VIOLET, canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

VIEWS = (1.0, 0.5, 0.15)
TOLERANCES = (1e-2, 1e-3, 1e-4)
TRUTH, TRUTH_TOLERANCE = "quadrature", 1e-10  # ÷ albedo, of which small lights reflect 1e-5
TIMED_ROUGHNESS = 0.5


@dataclass(frozen=True, eq=False)
class Family:
    """A way to shade, in several sizes."""

    name: str
    label: str
    method: str
    color: str
    ink: str  # of text on that colour
    option: str = ""  # the one that sizes are values of
    sizes: Sequence[float] = ()
    fixed: dict[str, Any] = field(default_factory=dict)


ORDERS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
SAMPLES = tuple(4**k for k in range(2, 8))
POINTS = (4, 7, 24, 48, 96, 192, 384, 768)
ERRORS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)

KNOWN = [
    Family("point", "one point", "cubature", AMBER, "black", "samples", (1,)),
    Family("plain", "harmonics of order n", "plain_harmonics", ORANGE, "white", "order", ORDERS),
    Family("warped", "warped harmonics of order n", "warped_harmonics", BLUE, "white", "order", ORDERS),
    Family("cubature", "cubature of k points", "cubature", GREEN, "white", "samples", POINTS),
    Family("outline", "outline", "outline", PINK, "black", "tolerance", ERRORS),
    Family(
        "monte_carlo", "Monte Carlo, k samples", "monte_carlo", DARK, "white", "samples", SAMPLES, {"sampling": "mis"}
    ),
]
FURTHER = (SKY, VIOLET, BROWN, OLIVE)


def families() -> list[Family]:
    """A family for each registered shading method; the options of unknown ones follow from their description."""
    registered = methods.shading_methods()
    found = [family for family in KNOWN if family.method in registered]
    unknown = [m for m in registered.values() if m.name != TRUTH and m.name not in {f.method for f in KNOWN}]
    for i, method in enumerate(unknown):
        option, sizes = (
            ("order", ORDERS)
            if method.harmonic
            else ("samples", SAMPLES)
            if method.sampled
            else ("tolerance", ERRORS)
            if method.adaptive
            else ("", (1.0,))
        )
        found.append(Family(method.name, method.name, method.name, FURTHER[i % len(FURTHER)], "black", option, sizes))
    return found


@dataclass(frozen=True)
class Way:
    family: Family
    size: float

    def options(self, scale: float) -> dict[str, Any]:
        """scale: what a tolerance is a part of."""
        option = self.family.option
        value = self.size * scale if option == "tolerance" else int(self.size)
        return {option: value, **self.family.fixed} if option else {}

    def text(self) -> str:
        return f"{self.size:.0f}" if self.family.option in ("order", "samples") and self.size > 1 else ""


@dataclass(frozen=True)
class Choice:
    """The cheapest way in a cell for one tolerance. way: None if no way meets it."""

    way: Way | None
    microseconds: float
    rms: float
    worst: float
    own_microseconds: float  # the library's choice of its own
    own_rms: float


@dataclass(frozen=True)
class Cell:
    cos_o: float
    roughness: float
    half_angle: float
    choices: tuple[Choice, ...]  # for each tolerance


@dataclass(frozen=True)
class Grid:
    half_angles: Sequence[float]
    roughnesses: Sequence[float]
    lights: int  # of a cell


FULL = Grid(tuple(np.geomspace(0.01, 1.4, 14)), tuple(np.linspace(0.05, 1, 11)), 24)
QUICK = Grid(tuple(np.geomspace(0.01, 1.4, 5)), tuple(np.linspace(0.1, 1, 4)), 12)


def draw(run: Run) -> Drawn:
    grid = QUICK if run.quick else FULL
    cells = measure(run, grid)
    for kind, title in (("method", "The cheapest way that meets the tolerance"), ("time", "Its time")):
        picture = canvas(14.5, 13.2)
        _draw_maps(picture, kind, cells, grid)
        run.save(picture, f"which_method_{kind}", title)
    run.csv("which_method", *_numbers(cells))
    return Drawn(_explanation(cells), [_shares(cells)])


def measure(run: Run, grid: Grid) -> list[Cell]:
    """Every cell. Roughness is the outer loop: fits are made once for each."""
    clock = Clock(rounds=2 if run.quick else 6)
    known = families()
    costs = {}
    places = [(cos_o, half_angle) for cos_o in VIEWS for half_angle in grid.half_angles]
    for i, place in enumerate(places):
        run.step(0.2 * i / len(places), f"times, cosθ_o = {place[0]:g}")
        costs[place] = _costs(clock, known, *place, run.seed, grid.lights)
    for cos_o in VIEWS:
        row = smoothed([costs[cos_o, half_angle] for half_angle in grid.half_angles])
        costs.update(zip([(cos_o, half_angle) for half_angle in grid.half_angles], row, strict=True))
    cells = []
    grid_points = [(roughness, *place) for roughness in grid.roughnesses for place in places]
    for i, (roughness, cos_o, half_angle) in enumerate(grid_points):
        run.step(0.2 + 0.8 * i / len(grid_points), f"roughness {roughness:.2f}, cosθ_o = {cos_o:g}")
        at = _Place(cos_o, roughness, _lights(run.seed, roughness, cos_o, half_angle, grid.lights))
        choices = at.cheapest(costs[cos_o, half_angle], clock)
        cells.append(Cell(cos_o, roughness, half_angle, tuple(choices)))
    return cells


def smoothed(costs: Sequence[dict[Way, float]]) -> list[dict[Way, float]]:
    """The median of three neighbours, which do nearly the same work: where two ways cost nearly the same, a disturbed
    measurement must not choose."""
    found = []
    for i, here in enumerate(costs):
        first = max(min(i - 1, len(costs) - 3), 0)
        found.append({way: float(np.median([near[way] for near in costs[first : first + 3]])) for way in here})
    return found


def _lights(seed: int, roughness: float, cos_o: float, half_angle: float, count: int) -> LobeLights:
    """The same random numbers for every cell, so that neighbours differ by what differs."""
    return about_lobe(np.random.default_rng(seed), roughness**2, cos_o, np.full(count, half_angle))


def _costs(
    clock: Clock, known: list[Family], cos_o: float, half_angle: float, seed: int, count: int
) -> dict[Way, float]:
    """Microseconds per light of all ways that do the same work whatever the roughness."""
    lights = _lights(seed, TIMED_ROUGHNESS, cos_o, half_angle, count)
    bsdf = shlight.Bsdf.ggx(TIMED_ROUGHNESS, 1.0)
    ways = [Way(family, size) for family in known if family.option != "tolerance" for size in family.sizes]
    calls = [Timed(way.family.method, way.options(1)) for way in ways]
    return dict(zip(ways, clock.microseconds(lights, bsdf, calls), strict=True))


@dataclass
class _Place:
    """A cell while it is measured."""

    cos_o: float
    roughness: float
    lights: LobeLights

    def __post_init__(self) -> None:
        self.tolerant = [family for family in families() if family.option == "tolerance"]
        self.bsdf = shlight.Bsdf.ggx(self.roughness, 1.0)
        self.truth = self.lights.shade(self.bsdf, TRUTH, tolerance=TRUTH_TOLERANCE, threads=0)
        self.brightest = float(self.truth.max())
        # A sphere in contact above is the whole sky.
        sky = LobeLights(self.cos_o, np.array([[0.0, 0.0, 1.0]]), np.array([1.0]))
        self.albedo = float(sky.shade(self.bsdf, "auto", tolerance=1e-4)[0])

    def errors(self, shaded: Floats) -> tuple[float, float]:
        """Root mean square and worst, ÷ the brightest light."""
        difference = np.abs(shaded - self.truth) / self.brightest
        return float(np.sqrt(np.mean(difference**2))), float(difference.max())

    def cheapest(self, costs: dict[Way, float], clock: Clock) -> list[Choice]:
        """For each tolerance."""
        costs = dict(costs)
        adaptive = [Way(family, size) for family in self.tolerant for size in family.sizes]
        own = [Timed("auto", {"tolerance": tolerance * self.brightest / self.albedo}) for tolerance in TOLERANCES]
        calls = [Timed(way.family.method, way.options(self.brightest)) for way in adaptive] + own
        times = clock.microseconds(self.lights, self.bsdf, calls)
        costs.update(zip(adaptive, times, strict=False))
        found: dict[float, tuple[Way, float, float]] = {}
        for way in sorted(costs, key=lambda way: costs[way]):
            if len(found) == len(TOLERANCES):
                break
            rms, worst = self.errors(self.lights.shade(self.bsdf, way.family.method, **way.options(self.brightest)))
            for tolerance in TOLERANCES:
                if rms <= tolerance:
                    found.setdefault(tolerance, (way, rms, worst))
        choices = []
        for tolerance, call, own_time in zip(TOLERANCES, own, times[len(adaptive) :], strict=True):
            own_rms = self.errors(self.lights.shade(self.bsdf, call.method, **call.options))[0]
            if tolerance in found:
                way, rms, worst = found[tolerance]
                choices.append(Choice(way, costs[way], rms, worst, own_time, own_rms))
            else:
                choices.append(Choice(None, np.nan, np.nan, np.nan, own_time, own_rms))
        return choices


def _draw_maps(picture: Any, kind: str, cells: list[Cell], grid: Grid) -> None:
    from matplotlib.colors import LogNorm

    panels = picture.subplots(len(TOLERANCES), len(VIEWS), sharex=True, sharey=True)
    times = [choice.microseconds for cell in cells for choice in cell.choices if choice.way is not None]
    least, most = min(times), max(times)
    norm = LogNorm(least, most)
    for panel, (t, cos_o) in zip(panels.ravel(), np.ndindex(len(TOLERANCES), len(VIEWS)), strict=True):
        shown = {(cell.roughness, cell.half_angle): cell.choices[t] for cell in cells if cell.cos_o == VIEWS[cos_o]}
        choices = [[shown[roughness, half_angle] for half_angle in grid.half_angles] for roughness in grid.roughnesses]
        if kind == "method":
            _draw_families(panel, choices)
        else:
            _draw_times(panel, choices, norm)
        panel.set_title(f"error ≤ {TOLERANCES[t]:g}, seen at cosθ_o = {VIEWS[cos_o]:g}")
        _axes(panel, grid, bottom=t == len(TOLERANCES) - 1, left=cos_o == 0)
    if kind == "method":
        picture.legend(handles=_legend(cells), loc="outside lower center", ncols=4)
    else:
        from matplotlib.cm import ScalarMappable

        bar = picture.colorbar(
            ScalarMappable(norm, "cividis"), ax=panels, location="bottom", aspect=60, shrink=0.6, pad=0.01
        )
        ticks = [m * 10.0**e for e in range(-2, 4) for m in (1, 2, 5) if least <= m * 10.0**e <= most]
        bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        bar.minorticks_off()
        bar.set_label("µs per light, one core")


def _draw_families(panel: Axes, grid: list[list[Choice]]) -> None:
    from matplotlib.colors import to_rgb

    colors = [[to_rgb(HIDDEN if choice.way is None else choice.way.family.color) for choice in row] for row in grid]
    panel.imshow(colors, origin="lower", aspect="auto", interpolation="nearest")
    panel.set_xticks(np.arange(len(grid[0]) - 1) + 0.5, minor=True)
    panel.set_yticks(np.arange(len(grid) - 1) + 0.5, minor=True)
    for y, row in enumerate(grid):
        for x, choice in enumerate(row):
            if choice.way is not None:
                panel.text(x, y, choice.way.text(), color=choice.way.family.ink, ha="center", va="center", fontsize=9)


def _draw_times(panel: Axes, grid: list[list[Choice]], norm: Any) -> None:
    times = np.array([[choice.microseconds for choice in row] for row in grid])
    panel.set_facecolor(HIDDEN)
    panel.imshow(times, origin="lower", aspect="auto", interpolation="nearest", norm=norm, cmap="cividis")
    for (y, x), value in np.ndenumerate(times):
        if np.isfinite(value):
            ink = "white" if norm(value) < 0.5 else "black"
            panel.text(x, y, _digits(value), color=ink, ha="center", va="center", fontsize=8)


def _digits(microseconds: float) -> str:
    return f"{microseconds:.2g}" if microseconds < 10 else f"{microseconds:.0f}"


def _axes(panel: Axes, grid: Grid, *, bottom: bool, left: bool) -> None:
    panel.grid(False)
    panel.grid(which="minor", color="white", linewidth=0.8)
    panel.set_axisbelow(False)
    panel.tick_params(which="minor", length=0)
    every = 1 if len(grid.half_angles) < 8 else 2
    panel.set_xticks(range(0, len(grid.half_angles), every), [f"{value:.2g}" for value in grid.half_angles[::every]])
    panel.set_yticks(range(0, len(grid.roughnesses), every), [f"{value:.2g}" for value in grid.roughnesses[::every]])
    if bottom:
        panel.set_xlabel("half angle σ of the light [rad]")
    if left:
        panel.set_ylabel("roughness")


def _legend(cells: list[Cell]) -> list[Any]:
    from matplotlib.patches import Patch

    taken = {choice.way and choice.way.family.name for cell in cells for choice in cell.choices}
    handles = [
        Patch(color=family.color, label=family.label + ("" if family.name in taken else " (nowhere)"))
        for family in families()
    ]
    return handles + ([Patch(color=HIDDEN, label="none of these")] if None in taken else [])


def _numbers(cells: list[Cell]) -> tuple[list[str], list[list[Any]]]:
    header = ["cos_theta_o", "roughness", "half_angle", "tolerance", "method", "size", "microseconds", "rms_error"]
    header += ["worst_error", "auto_microseconds", "auto_rms_error"]
    rows = []
    for cell in cells:
        for tolerance, choice in zip(TOLERANCES, cell.choices, strict=True):
            name, size = ("none", "") if choice.way is None else (choice.way.family.name, choice.way.size)
            numbers = [choice.microseconds, choice.rms, choice.worst, choice.own_microseconds, choice.own_rms]
            place = [cell.cos_o, f"{cell.roughness:.4g}", f"{cell.half_angle:.4g}", tolerance]
            rows.append([*place, name, size, *(f"{number:.3g}" for number in numbers)])
    return header, rows


def _shares(cells: list[Cell]) -> Table:
    """What is cheapest how often, and what the library's own choice costs beside it."""
    rows = []
    for t, tolerance in enumerate(TOLERANCES):
        choices = [cell.choices[t] for cell in cells]
        shares = [
            np.mean([c.way is not None and c.way.family.name == family.name for c in choices]) for family in families()
        ]
        met = [c for c in choices if c.way is not None]
        rows.append([
            f"{tolerance:g}",
            *(f"{share:.0%}" for share in shares),
            f"{np.median([c.microseconds for c in met]):.2g}",
            f"{np.median([c.own_microseconds / c.microseconds for c in met]):.2f}",
            f"{np.mean([c.own_rms <= tolerance for c in choices]):.1%}",
        ])  # fmt: skip
    header = ["tolerance", *(family.label for family in families()), "median µs", "auto ÷ cheapest", "auto meets it"]
    return Table(
        "Share of cells in which each way is the cheapest, and the library's own choice beside it", header, rows
    )


def _explanation(cells: list[Cell]) -> str:
    def share(name: str, tolerance: float) -> float:
        t = TOLERANCES.index(tolerance)
        return float(np.mean([(way := c.choices[t].way) is not None and way.family.name == name for c in cells]))

    middle = [cell.choices[TOLERANCES.index(1e-3)] for cell in cells]
    met = [choice for choice in middle if choice.way is not None]
    worst = np.median([choice.worst / choice.rms for choice in met if choice.rms > 0])
    own = np.median([choice.own_microseconds / choice.microseconds for choice in met])
    times = [choice.microseconds for choice in met]
    meets = np.mean([choice.own_rms <= 1e-3 for choice in middle])
    return (
        "The cheapest way to shade a GGX surface by a sphere light, over the light's half angle and the roughness, for "
        "three views and three tolerances of the root mean square error ÷ the brightest of each cell's lights (the "
        f"worst light errs by {worst:.1f} times as much in the median). At 1e-3 one point is cheapest in "
        f"{share('point', 1e-3):.0%} of the cells, warped harmonics in {share('warped', 1e-3):.0%}, plain ones in "
        f"{share('plain', 1e-3):.0%}, cubature in {share('cubature', 1e-3):.0%}, the outline in "
        f"{share('outline', 1e-3):.0%} and Monte Carlo in {share('monte_carlo', 1e-3):.0%}, at {min(times):.1f} … "
        f"{max(times):.1f} µs a light; the library's own choice, which has to bound the error of every light without "
        f"knowing it, meets that tolerance in {meets:.0%} of them and takes {own:.1f} times the cheapest's time in the "
        "median."
    )
