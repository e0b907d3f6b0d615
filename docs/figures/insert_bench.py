# SPDX-License-Identifier: MIT
"""Puts the numbers of a run of `./dev bench` into README.md and docs/performance.md.

.venv/bin/python docs/figures/insert_bench.py out/bench/bench.json

What stands between <!-- bench NAME --> and <!-- end --> becomes the table of section NAME, for NAME "speed" an overview
of times against sphericart's, and for NAME "machine" where the run ran.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from shlight.bench import sections, table
from shlight.bench.row import Bench, read

ROOT = Path(__file__).resolve().parents[2]
PLACES = (ROOT / "README.md", ROOT / "docs" / "performance.md")
BLOCK = re.compile(r"(<!-- bench (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def content(bench: Bench, name: str) -> str:
    """What belongs into a block; empty where the run has nothing for it."""
    if name == "machine":
        machine, settings = bench.machine, bench.settings
        return (
            f"{machine['processor']}, {machine['cores']} cores, {machine['instruction set']}; {settings['lights']} "
            f"lights, medians of {settings['rounds']} turns; sphericart {machine['sphericart']}.\n"
        )
    if name == "speed":
        return overview(bench)
    rows = [row for row in bench.rows if row.section == name]
    return table.rows(rows) + "\n" if rows else ""


def overview(bench: Bench) -> str:
    """Ratios to sphericart's basis, and times: a line for each kind of work, a column for each order."""
    lines: dict[str, dict[str, str]] = {}
    for row in bench.rows:
        if row.unit == sections.UNIT and not row.name.endswith(", auto"):
            kind, _, order = row.name.rpartition(", ")
            time = row.detail.partition(" ÷ ")[0]
            lines.setdefault(kind, {})[order] = f"{table.number(row.value)} ({time})"
    orders = list(dict.fromkeys(order for line in lines.values() for order in line))
    cells = [[kind, *(line.get(order, "") for order in orders)] for kind, line in lines.items()]
    return table.aligned((f"time {sections.UNIT}", *orders), cells) + "\n" if cells else ""


def main() -> None:
    bench = read(Path(sys.argv[1]))
    for file in PLACES:
        text = file.read_text(encoding="utf-8")

        def filled(match: re.Match[str]) -> str:
            made = content(bench, match[2])
            return f"{match[1]}\n{made}\n{match[3]}" if made else match[0]

        file.write_text(BLOCK.sub(filled, text), encoding="utf-8")


if __name__ == "__main__":
    main()
