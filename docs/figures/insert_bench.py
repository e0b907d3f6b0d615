# SPDX-License-Identifier: MIT
"""Puts the numbers of a run of `./dev bench` into docs/performance.md.

.venv/bin/python docs/figures/insert_bench.py out/bench/bench.json

What stands between <!-- bench NAME --> and <!-- end --> becomes the table of section NAME, or for NAME "machine" where
the run ran.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from shlight_tools.bench import table
from shlight_tools.bench.row import Bench, read

PAGE = Path(__file__).resolve().parents[1] / "performance.md"
BLOCK = re.compile(r"(<!-- bench (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def content(bench: Bench, name: str) -> str:
    """The text of a block; empty if the run has nothing for it."""
    if name == "machine":
        machine, settings = bench.machine, bench.settings
        return (
            f"{machine['processor']}, {machine['cores']} cores, {machine['instruction set']}; {settings['lights']} "
            f"lights, medians of {settings['rounds']} turns; sphericart {machine['sphericart']}.\n"
        )
    rows = [row for row in bench.rows if row.section == name]
    return table.rows(rows) + "\n" if rows else ""


def main() -> None:
    bench = read(Path(sys.argv[1]))
    text = PAGE.read_text(encoding="utf-8")

    def filled(match: re.Match[str]) -> str:
        made = content(bench, match[2])
        return f"{match[1]}\n{made}\n{match[3]}" if made else match[0]

    PAGE.write_text(BLOCK.sub(filled, text), encoding="utf-8")


if __name__ == "__main__":
    main()
