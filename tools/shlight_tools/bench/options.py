# SPDX-License-Identifier: MIT
"""The command line of `./dev bench`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from shlight.commands import Parser

from .run import LIGHTS, QUICK_LIGHTS, QUICK_ROUNDS, ROUNDS, Section
from .sections import SECTIONS

DEFAULT_OUT = str(Path("out") / "bench" / "bench.json")


@dataclass(frozen=True)
class Options:
    sections: list[Section]  # what to measure, in the order of the report
    quick: bool
    out: Path
    compare: Path | None
    against: Path | None
    read: Path | None
    list: bool

    @property
    def lights(self) -> int:
        return QUICK_LIGHTS if self.quick else LIGHTS

    @property
    def rounds(self) -> int:
        return QUICK_ROUNDS if self.quick else ROUNDS


def parse(argv: list[str]) -> Options:
    """The options of a command line; prints the reason and raises SystemExit(2) where it is not understood."""
    parser = _parser()
    given = parser.parse_args(argv)
    known = {section.name: section for section in SECTIONS}
    unknown = [name for name in given.names if name not in known]
    if unknown:
        parser.error(f"there is no section '{unknown[0]}'; there are: {', '.join(known)}")
    sections = [section for section in SECTIONS if not given.names or section.name in given.names]
    compare, against, read = (
        None if file is None else Path(file) for file in (given.compare, given.against, given.read)
    )
    return Options(sections, given.quick, Path(given.out), compare, against, read, given.list)


def _parser() -> Parser:
    parser = Parser(
        prog="./dev bench",
        description="Measures how long the package's calls take, as ratios of times that alternate in one run; prints "
        "tables and writes a JSON file.",
    )
    add = parser.add_argument
    add("names", nargs="*", metavar="NAME", help="sections to measure (default: all)")
    add(
        "--quick",
        action="store_true",
        help=f"{QUICK_LIGHTS} lights rather than {LIGHTS}, small pictures: half a minute",
    )
    add("--out", metavar="FILE", default=DEFAULT_OUT, help="JSON file of the results (default: %(default)s)")
    add("--compare", metavar="FILE", help="show the change against this JSON file of an earlier run")
    add("--against", metavar="FOLDER", help="time another build's package in this folder in turns with this build's")
    add("--read", metavar="FILE", help="take the results from this JSON file instead of measuring")
    add("--list", action="store_true", help="list the sections and do nothing else")
    return parser
