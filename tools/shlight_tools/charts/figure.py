# SPDX-License-Identifier: MIT
"""What a figure is, and what it is given to measure, report and write with."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


@dataclass(frozen=True)
class Table:
    """A table for the page and for the terminal. Cells are text as it shall be read."""

    title: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        lines = [self.header, ["---"] * len(self.header), *self.rows]
        return f"{self.title}\n\n" + "\n".join(f"| {' | '.join(line)} |" for line in lines)


@dataclass(frozen=True)
class Drawn:
    """What is said of a figure. Its files are those that the run wrote."""

    explanation: str  # two sentences, their numbers from this very run
    tables: Sequence[Table] = ()


@dataclass(frozen=True)
class Figure:
    """One figure of the charts, of one picture or several."""

    name: str  # on the command line; the names of its files begin with it
    title: str
    draw: Callable[[Run], Drawn]


@dataclass(frozen=True)
class Picture:
    file: str
    caption: str


class Run:
    """One drawing of one figure.

    quick: coarse grids, few lights, for some seconds in all. out: the folder to write to; save() and csv() do.
    seed: of whatever is random. step: called often, it also ends the run where that was asked for.
    """

    def __init__(
        self, name: str, out: Path, *, quick: bool, seed: int = 1, report: Callable[[float, str], None] | None = None
    ) -> None:
        self.quick = quick
        self.out = out
        self.seed = seed
        self.pictures: list[Picture] = []
        self.data: list[str] = []
        self._name = name
        self._report = report

    def step(self, share: float, text: str) -> None:
        """Tells how much of this figure is done, 0 … 1, and what comes now. Raises what ends the run, if anything."""
        if self._report is not None:
            self._report(share, text)

    def csv(self, name: str, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Writes `name`.csv."""
        file = self._file(name, ".csv")
        with (self.out / file).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(header)
            writer.writerows(rows)
        self.data.append(file)

    def save(self, canvas: Canvas, name: str, caption: str = "") -> None:
        """Writes `name`.png. caption: what this picture shows, where the figure has several."""
        file = self._file(name, ".png")
        canvas.savefig(self.out / file)
        self.pictures.append(Picture(file, caption))

    def _file(self, name: str, ending: str) -> str:
        if not name.startswith(self._name) or name != Path(name).name:
            raise ValueError(f"name must begin with {self._name!r} and be no path, got {name!r}")
        return name + ending
