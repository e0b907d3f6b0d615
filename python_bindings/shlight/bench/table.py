# SPDX-License-Identifier: MIT
"""Rows as tables to read: Markdown with its columns aligned."""

from __future__ import annotations

from collections.abc import Sequence

from .row import Bench, Row

HEADER = ("", "value", "quartiles", "", "bound", "", "")
RELATION = {"most": "≤", "least": "≥"}
VERDICT = {True: "met", False: "NOT MET", None: ""}


def machine(bench: Bench) -> str:
    """Where the run ran, one line each."""
    width = max(map(len, bench.machine))
    lines = [f"{key + ':':{width + 1}} {value}" for key, value in bench.machine.items()]
    settings = ", ".join(f"{value} {key}" for key, value in bench.settings.items())
    return "\n".join([*lines, f"{'medians:':{width + 1}} of turns taken one after the other; {settings}"])


def section(title: str, rows: Sequence[Row]) -> str:
    """The rows of a section."""
    return f"{title}\n\n{aligned(HEADER, [_cells(row) for row in rows])}"


def _cells(row: Row) -> list[str]:
    bound = "" if row.bound is None else f"{RELATION[row.bound_is]} {row.bound:.3g}"
    quartiles = f"{number(row.low)} … {number(row.high)}" if row.low < row.high else ""
    return [row.name, number(row.value), quartiles, row.unit, bound, VERDICT[row.met], row.detail]


def number(value: float) -> str:
    """Three digits."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def aligned(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table whose columns line up in a terminal; columns that are empty throughout are left out."""
    kept = [i for i in range(len(header)) if any(row[i] for row in rows)]
    lines = [[line[i] for i in kept] for line in (header, *rows)]
    widths = [max(3, *(len(line[i]) for line in lines)) for i in range(len(kept))]
    lines.insert(1, ["-" * width for width in widths])
    return "\n".join("| " + " | ".join(f"{c:{w}}" for c, w in zip(line, widths, strict=True)) + " |" for line in lines)
