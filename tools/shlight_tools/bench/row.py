# SPDX-License-Identifier: MIT
"""What was measured, one number a row, and the file that keeps it."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from shlight.commands import CommandError

from .rounds import Spread

FORMAT = 1


@dataclass(frozen=True)
class Row:
    """A number, mostly a ratio of times, with what it must hold."""

    section: str
    name: str  # the only one of its section
    value: float  # the median of the rounds
    low: float  # quartiles of the rounds; the value where there is but one
    high: float
    unit: str
    bound: float | None = None
    bound_is: Literal["most", "least"] = "most"  # also says which way is better where there is none
    detail: str = ""  # what the number is made of

    @classmethod
    def of(cls, section: str, name: str, spread: Spread, unit: str, **more: Any) -> Row:
        return cls(section, name, spread.median, spread.low, spread.high, unit, **more)

    @property
    def met(self) -> bool | None:
        """Whether the bound holds; None where there is none."""
        if self.bound is None:
            return None
        return self.value <= self.bound if self.bound_is == "most" else self.value >= self.bound


@dataclass(frozen=True)
class Bench:
    """All rows of a run, and where it ran."""

    machine: dict[str, str]
    settings: dict[str, int]  # lights and rounds
    rows: list[Row]

    def to_json(self) -> str:
        rows = [{**asdict(row), "met": row.met} for row in self.rows]
        data = {"format": FORMAT, "machine": self.machine, "settings": self.settings, "rows": rows}
        return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read(file: Path) -> Bench:
    """A file that to_json() filled. Raises CommandError where it is none."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if data["format"] != FORMAT:
            raise CommandError(f"{file} has format {data['format']}; this version reads {FORMAT}", 2)
        rows = [Row(**{key: value for key, value in row.items() if key != "met"}) for row in data["rows"]]
        if not all(math.isfinite(number) for row in rows for number in (row.value, row.low, row.high)):
            raise ValueError
        return Bench(dict(data["machine"]), dict(data["settings"]), rows)
    except (ValueError, KeyError, TypeError):
        raise CommandError(f"{file} is not a file that ./dev bench wrote", 2) from None
    except OSError as error:
        raise CommandError(f"cannot read {file}: {error.strerror}", 2) from None
