# SPDX-License-Identifier: MIT
"""index.html: every figure that lies in a folder, explained with its numbers.

A figure leaves its part of the page beside its pictures as <name>.json, so that figures drawn at different times share
a page.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from datetime import datetime
from html import escape
from pathlib import Path
from typing import Any

import shlight

from .figure import Drawn, Figure, Run

PAGE = "index.html"

_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>shlight: charts</title>
<style>
body { font: 16px/1.5 sans-serif; color: #222; max-width: 78rem; margin: 2rem auto; padding: 0 1rem }
img { max-width: 100%; display: block }
figure { margin: 1.5rem 0 }
figcaption, .made { color: #555; font-size: 0.9rem }
p { max-width: 46rem }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.9rem }
caption { text-align: left; font-weight: bold; padding: 0.3rem 0 }
th, td { border-bottom: 1px solid #ddd; padding: 0.2rem 0.8rem; text-align: right; white-space: nowrap }
th:first-child, td:first-child { text-align: left }
.wide { overflow-x: auto }
</style>
</head>
<body>
<h1>Charts</h1>
"""


def leave_part(figure: Figure, run: Run, drawn: Drawn, seconds: float) -> str:
    """Writes the figure's part of the page to the run's folder; returns the name of its file."""
    part = {
        "title": figure.title,
        "explanation": drawn.explanation,
        "pictures": [[picture.file, picture.caption] for picture in run.pictures],
        "data": run.data,
        "tables": [[table.title, list(table.header), [list(row) for row in table.rows]] for table in drawn.tables],
        "made": _circumstances(run.quick, seconds),
    }
    file = f"{figure.name}.json"
    (run.out / file).write_text(json.dumps(part, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return file


def part_of(folder: Path, figure: Figure) -> dict[str, Any] | None:
    """The part that a figure left in a folder; None: it was never drawn there."""
    try:
        part: dict[str, Any] = json.loads((folder / f"{figure.name}.json").read_text(encoding="utf-8"))
    except (FileNotFoundError, json.JSONDecodeError):
        return None
    return part


def page(folder: Path, figures: Sequence[Figure]) -> str:
    """The page of all figures that were drawn in a folder."""
    parts = [(figure.name, part) for figure in figures if (part := part_of(folder, figure)) is not None]
    contents = "".join(f'<li><a href="#{name}">{escape(part["title"])}</a></li>\n' for name, part in parts)
    sections = "".join(_section(name, part) for name, part in parts)
    return f"{_HEAD}<ul>\n{contents}</ul>\n{sections}</body>\n</html>\n"


def _section(name: str, part: dict[str, Any]) -> str:
    pictures = "".join(
        f'<figure><a href="{file}"><img src="{file}" alt="{escape(caption or part["title"])}"></a>'
        + (f"<figcaption>{escape(caption)}</figcaption>" if caption else "")
        + "</figure>\n"
        for file, caption in part["pictures"]
    )
    data = ", ".join(f'<a href="{file}">{file}</a>' for file in part["data"])
    return (
        f'<h2 id="{name}">{escape(part["title"])}</h2>\n<p>{escape(part["explanation"])}</p>\n{pictures}'
        + "".join(_table(*table) for table in part["tables"])
        + f'<p class="made">Numbers: {data}. {escape(part["made"])}</p>\n'
    )


def _table(title: str, header: list[str], rows: list[list[str]]) -> str:
    def line(cells: list[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"

    body = "".join(line(row, "td") for row in rows)
    return f'<div class="wide"><table><caption>{escape(title)}</caption>\n{line(header, "th")}{body}</table></div>\n'


def _circumstances(quick: bool, seconds: float) -> str:
    grids = "Coarse grids (--quick). " if quick else ""
    return (
        f"{grids}Made on {datetime.now():%Y-%m-%d %H:%M} in {seconds:.0f} s with shlight {shlight.__version__} "
        f"on {_processor()} ({os.cpu_count()} cores)."
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
