# SPDX-License-Identifier: MIT
"""Puts the numbers of runs of `./dev bench` and `./dev charts` into docs/performance.md and docs/stability.md.

.venv/bin/python docs/figures/insert.py out/bench/bench.json out/charts/stability.json ...

What stands between <!-- bench NAME --> and <!-- end --> becomes the table of section NAME, or for NAME "machine" where
the run ran; <!-- charts NAME --> becomes what that figure says, and its tables.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

from shlight_tools.bench import table
from shlight_tools.bench.row import Bench, read
from shlight_tools.charts.figure import Table

PAGES = [Path(__file__).resolve().parents[1] / name for name in ("performance.md", "stability.md")]
BLOCK = re.compile(r"(<!-- (\w+ \w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def of_bench(bench: Bench) -> dict[str, str]:
    """The texts of blocks by what begins them."""
    machine, settings = bench.machine, bench.settings
    texts = {
        f"bench {name}": table.rows([row for row in bench.rows if row.section == name])
        for name in {row.section for row in bench.rows}
    }
    return texts | {
        "bench machine": f"{machine['processor']}, {machine['cores']} cores, {machine['instruction set']}; "
        f"{settings['lights']} lights, medians of {settings['rounds']} turns; sphericart {machine['sphericart']}."
    }


def of_chart(file: Path) -> dict[str, str]:
    """The text of a figure's block."""
    part = json.loads(file.read_text(encoding="utf-8"))
    tables = [Table(*own).markdown() for own in part["tables"]]
    return {f"charts {file.stem}": "\n\n".join([part["explanation"], *tables, part["made"]])}


def main() -> None:
    """Fills the blocks that the files on the command line have something for."""
    texts: dict[str, str] = {}
    for file in map(Path, sys.argv[1:]):
        texts |= of_bench(read(file)) if file.stem == "bench" else of_chart(file)
    for page in PAGES:
        made = BLOCK.sub(
            lambda own: f"{own[1]}\n{texts[own[2]]}\n\n{own[3]}" if own[2] in texts else own[0], page.read_text("utf-8")
        )
        page.write_text(made, encoding="utf-8")


if __name__ == "__main__":
    main()
