# SPDX-License-Identifier: MIT
"""Puts the numbers of a run of `./dev bench` into README.md and docs/performance.md.

.venv/bin/python docs/figures/insert_bench.py out/bench/bench.json

What stands between <!-- bench NAME --> and <!-- end --> becomes the table of section NAME, without quartiles and
details for NAME "speed", which takes all rows with a bound, and the machine for NAME "machine".
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from shlight.bench import table
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
        rows = [row for row in bench.rows if row.bound is not None and row.section not in ("targets", "threads")]
        cells = [[r.name, f"{table.number(r.value)} {r.unit}", *table.bound(r), r.detail] for r in rows]
        return table.aligned(("", "measured", "asked for", "", "times"), cells) + "\n" if cells else ""
    rows = [row for row in bench.rows if row.section == name]
    return table.rows(rows) + "\n" if rows else ""


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
