# SPDX-License-Identifier: MIT
"""What the tests of `shlight charts` share: a method that there is not, and figures drawn with their numbers."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

from shlight.charts import style
from shlight.charts.figure import Drawn, Run

Rows = list[dict[str, str]]


def dummy(**changes: object) -> SimpleNamespace:
    """A method for caps, of small orders, to register."""
    known = {
        "name": "dummy",
        "largest_order": 8,
        "adaptive": False,
        "random": False,
        "knows_caps": True,
        "knows_polygons": False,
    }
    return SimpleNamespace(**{**known, **changes})


def drawn(figure: str, draw: Callable[[Run], Drawn], folder: Path, numbers: str = "") -> tuple[Drawn, Rows]:
    """The figure and the rows of its CSV, or of that named `numbers`; the shares that it reports rise within 0 … 1."""
    shares: list[float] = []
    run = Run(figure, folder, quick=True, report=lambda share, _: shares.append(share))
    with style.look():
        result = draw(run)
    assert shares == sorted(shares)
    assert shares[0] >= 0
    assert shares[-1] <= 1
    with (folder / f"{numbers or figure}.csv").open(newline="") as stream:
        return result, list(csv.DictReader(stream))
