# SPDX-License-Identifier: MIT
"""Rows as tables to read: Markdown with its columns aligned."""

from __future__ import annotations

from collections.abc import Sequence

from .row import Bench, Row

HEADER = ("", "value", "quartiles", "", "bound", "", "")
RELATION = {"most": "≤", "least": "≥"}
VERDICT = {True: "met", False: "NOT MET", None: ""}


def machine(bench: Bench) -> str:
    """The machine and settings of the run, one line each."""
    width = max(map(len, bench.machine))
    lines = [f"{key + ':':{width + 1}} {value}" for key, value in bench.machine.items()]
    settings = ", ".join(f"{value} {key}" for key, value in bench.settings.items())
    return "\n".join([*lines, f"{'medians:':{width + 1}} of turns taken one after the other; {settings}"])


def section(title: str, of_section: Sequence[Row]) -> str:
    """The rows of a section under its title."""
    return f"{title}\n\n{rows(of_section)}"


def rows(shown: Sequence[Row]) -> str:
    """Rows as a table."""
    return aligned(HEADER, [_cells(row) for row in shown])


def bound(row: Row) -> tuple[str, str]:
    """What is asked for, and whether it holds."""
    return "" if row.bound is None else f"{RELATION[row.bound_is]} {row.bound:.3g}", VERDICT[row.met]


def _cells(row: Row) -> list[str]:
    quartiles = f"{number(row.low)} … {number(row.high)}" if row.low < row.high else ""
    return [row.name, number(row.value), quartiles, row.unit, *bound(row), row.detail]


def number(value: float) -> str:
    """Three digits."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def aligned(header: Sequence[str], cells: Sequence[Sequence[str]]) -> str:
    """A Markdown table whose columns line up in a terminal; columns that are empty throughout are left out."""
    kept = [i for i in range(len(header)) if any(row[i] for row in cells)]
    lines = [[line[i] for i in kept] for line in (header, *cells)]
    widths = [max(3, *(len(line[i]) for line in lines)) for i in range(len(kept))]
    lines.insert(1, ["-" * width for width in widths])
    return "\n".join("| " + " | ".join(f"{c:{w}}" for c, w in zip(line, widths, strict=True)) + " |" for line in lines)
