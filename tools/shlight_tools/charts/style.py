# SPDX-License-Identifier: MIT
"""How charts look: one colour and marker for each method, readable at 1:1, told apart by everyone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

# Okabe & Ito's colours, and a few that stay apart from them in lightness.
BLUE, ORANGE, GREEN, SKY, PINK, AMBER = "#0072B2", "#D55E00", "#009E73", "#56B4E9", "#CC79A7", "#E69F00"
DARK, GREY, VIOLET, BROWN, OLIVE = "#333333", "#888888", "#5B3A8E", "#7F4F24", "#808000"

# Colours and markers of methods with known names, for coefficients and for shading.
_KNOWN = {
    "exact": (BLUE, "o"),
    "auto": (BLUE, "o"),
    "zhou_wei": (ORANGE, "s"),
    "snyder": (PINK, "D"),
    "wang_ramamoorthi": (ORANGE, "D"),
    "quadrature": (GREEN, "^"),
    "cubature": (GREEN, "v"),
    "monte_carlo": (GREY, "x"),
    "plain_harmonics": (ORANGE, "s"),
    "warped_harmonics": (SKY, "D"),
    "outline": (VIOLET, "P"),
    "point": (DARK, "*"),
}
# Colours and markers of other methods, in the order of their appearance.
_FURTHER = [(BROWN, "h"), (OLIVE, "p"), (DARK, "*"), ("#A6761D", "X"), ("#1B6E5A", "d"), ("#B0003A", "H")]

# Colours of a map's cells without a number, and of numbers beyond its scale.
HIDDEN, NOT_FINITE, WORSE = "#DDDDDD", "#E5007D", "#FF8C1A"

_LOOK: dict[Any, Any] = {
    "figure.dpi": 110,
    "savefig.dpi": 110,
    "savefig.facecolor": "white",
    "figure.constrained_layout.use": True,
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.labelsize": 11,
    "legend.fontsize": 10,
    "legend.frameon": False,
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
    "axes.grid": True,
    "grid.color": "#E2E2E2",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.6,
    "lines.markersize": 6,
}


def styles(methods: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each method, by name."""
    unknown = [name for name in methods if name not in _KNOWN]
    return _KNOWN | {name: _FURTHER[i % len(_FURTHER)] for i, name in enumerate(unknown)}


@contextmanager
def look() -> Iterator[None]:
    """Figures made inside look alike."""
    import matplotlib as mpl

    with mpl.rc_context(_LOOK):
        yield


def canvas(width: float, height: float) -> Canvas:
    """An empty picture of this size in inches, drawn without any display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    made = Canvas(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(made)
    return made


def decades(limits: tuple[float, float]) -> tuple[float, float]:
    """The limits of a logarithmic axis, widened to powers of ten."""
    low, high = limits
    return 10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))


def order_axis(axes: Axes, orders: Sequence[int]) -> None:
    """A logarithmic horizontal axis of orders, with their numbers on it."""
    axes.set_xscale("log", base=2)
    axes.set_xticks(list(orders), [str(order) for order in orders])
    axes.minorticks_off()
    axes.set_xlabel("order n")
