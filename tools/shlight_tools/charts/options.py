# SPDX-License-Identifier: MIT
"""The command line of `./dev charts`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from shlight.commands import Parser

from .figure import Figure
from .figures import FIGURES

DEFAULT_OUT = str(Path("out") / "charts")


@dataclass(frozen=True)
class Options:
    figures: list[Figure]  # what to draw, in the order of the page
    quick: bool
    out: Path
    list: bool


def parse(argv: list[str]) -> Options:
    """The options of a command line; prints the reason and raises SystemExit(2) where it is not understood."""
    parser = _parser()
    given = parser.parse_args(argv)
    known = {figure.name: figure for figure in FIGURES}
    unknown = [name for name in given.names if name not in known]
    if unknown:
        parser.error(f"there is no figure '{unknown[0]}'; there are: {', '.join(known)}")
    figures = [figure for figure in FIGURES if not given.names or figure.name in given.names]
    return Options(figures, given.quick, Path(given.out), given.list)


def _parser() -> Parser:
    parser = Parser(
        prog="./dev charts",
        description="Measures the library beside the methods that it is compared with, and draws the figures: PNG and "
        "CSV files and a page, index.html, that explains them.",
    )
    add = parser.add_argument
    add("names", nargs="*", metavar="NAME", help="figures to draw (default: all)")
    add("--quick", action="store_true", help="coarser grids and fewer lights: all within a minute")
    add("--out", metavar="DIR", default=DEFAULT_OUT, help="folder of the results (default: %(default)s)")
    add("--list", action="store_true", help="list the figures and do nothing else")
    return parser
