# SPDX-License-Identifier: MIT
"""The change of each row against an earlier run."""

from __future__ import annotations

from dataclasses import dataclass

from .row import Bench, Row
from .table import aligned, number

SAME_TO_COMPARE = ("processor", "instruction set", "cores")
TRIFLE = 0.02


@dataclass(frozen=True)
class Change:
    """One row, now and before."""

    new: Row
    old: Row

    @property
    def ratio(self) -> float:
        """New value ÷ old value; the values are mostly ratios themselves."""
        return self.new.value / self.old.value if self.old.value else float("nan")

    @property
    def beyond_spread(self) -> bool:
        """Whether the quartiles of the two runs leave a gap between them, and the change is no trifle."""
        apart = self.new.low > self.old.high or self.new.high < self.old.low
        return apart and not abs(self.ratio - 1) <= TRIFLE


def changes(new: Bench, old: Bench) -> list[Change]:
    """The changes of all rows that both runs have."""
    before = {(row.section, row.name): row for row in old.rows}
    return [Change(row, before[row.section, row.name]) for row in new.rows if (row.section, row.name) in before]


def differences(new: Bench, old: Bench) -> list[str]:
    """Settings and machines that differ between the runs, a line each."""
    pairs = [(key, new.machine.get(key, "?"), old.machine.get(key, "?")) for key in SAME_TO_COMPARE]
    pairs += [(key, str(new.settings.get(key, "?")), str(old.settings.get(key, "?"))) for key in new.settings]
    return [f"not the same {key}: {now} now, {then} before" for key, now, then in pairs if now != then]


def comparison(new: Bench, old: Bench) -> str:
    """The comparison as text: differing settings, and a table of all common rows."""
    found = changes(new, old)
    lines = [f"{line}\n" for line in differences(new, old)]
    if not found:
        return "".join([*lines, "the two runs have no row in common"])
    header = ("", "", "before", "now", "now ÷ before", "")
    cells = [
        [c.new.section, c.new.name, number(c.old.value), number(c.new.value), f"{c.ratio:.3f}", _flag(c)] for c in found
    ]
    beyond = sum(change.beyond_spread for change in found)
    summary = f"{beyond} of {len(found)} rows changed by more than the spread of the runs (quartiles apart)"
    return "".join([*lines, aligned(header, cells), "\n\n", summary])


def _flag(change: Change) -> str:
    if not change.beyond_spread:
        return ""
    better = (change.new.value < change.old.value) == (change.new.bound_is == "most")
    return "better" if better else "WORSE"
