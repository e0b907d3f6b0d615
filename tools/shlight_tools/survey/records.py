# SPDX-License-Identifier: MIT
"""The record of each file: as a line of the terminal, in survey.json, and summed up."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

# What is known of one file: "file", "problem" ("" if it was measured), and the figures that its worker sent.
Record = dict[str, Any]
Message = dict[str, Any]  # of the report: "text" and "places"

WITHIN = 1e-3  # relMSE
FIRST_LINES, LINE_LENGTH = 3, 80  # of the report
HEADING = "relMSE     mean/ref.  shlight    Cycles  report  uses  file"


# Figures of a worker, and what a record calls them.
OF_SHLIGHT = {
    "unsupported": "report",
    "seconds": "shlight_seconds",
    "warm_up_seconds": "warm_up_seconds",
    **{name: name for name in ("rel_mse", "rel_mse_standard_error", "rel_mse_measured", "mean_ratio")},
    "largest_difference": "largest_difference",
}
OF_REFERENCE = {
    "noise_rel_mse": "noise_rel_mse",
    "seconds": "cycles_seconds",
    "samples": "cycles_samples",
    "stopped_by": "stopped_by",
}


def flat(figures: dict[str, Any]) -> Record:
    """A record of a worker's figures."""
    found: Record = {name: figures[name] for name in ("versions", "added", "features") if name in figures}
    for part, names in (("shlight", OF_SHLIGHT), ("reference", OF_REFERENCE)):
        known = figures.get(part, {})
        found |= {name: known[figure] for figure, name in names.items() if figure in known}
    if "shlight" in figures:
        found["max_bounces"] = figures["shlight"]["settings"]["max_bounces"]
    return found


def is_measured(record: Record) -> bool:
    return "rel_mse" in record


def is_counted(record: Record) -> bool:
    """True unless light goes through things, which is beyond the share that is to be within WITHIN."""
    return not record.get("features")


def badness(record: Record) -> float:
    """The higher, the further up on the contact sheet."""
    value = record.get("rel_mse", float("inf"))
    return float(value) if value == value else float("inf")


def line(record: Record) -> str:
    """One line: figures, the number of report lines, T, V and S for transmission, volume and subsurface, the name."""
    report = record.get("report")
    count = "-" if report is None else str(len(report))
    uses = "".join(feature[0].upper() for feature in record.get("features", []))
    if is_measured(record):
        figures = f"{record['rel_mse']:<9.1e}  {record['mean_ratio']:<9.4f}  {record['shlight_seconds']:5.2f} s"
        figures += f"  {record['cycles_seconds']:6.2f} s"
    else:
        figures = f"{'failed':40}"
    notes = [record["problem"]] if record["problem"] else []
    if record.get("added"):
        notes.append(f"added: {', '.join(record['added'])}")
    notes += [_shortened(message) for message in (report or [])[:FIRST_LINES]]
    return f"{figures}  {count:>6}  {uses:4}  {record['file']}" + (f": {'; '.join(notes)}" if notes else "")


def _shortened(message: Message) -> str:
    """The message about the first thing that it holds for, without the name of the material or object that has that."""
    text = f"{message['places'][0].split(', ')[-1]}: {message['text']}"
    return text if len(text) <= LINE_LENGTH else f"{text[: LINE_LENGTH - 1]}…"


def summary(records: list[Record]) -> str:
    """How many files are within WITHIN, how many are not, how many failed; those that light goes through apart."""
    counted = [record for record in records if is_counted(record)]
    lines = [f"{len(records)} files: {_counts(records)}"]
    if len(counted) < len(records):
        others = [record for record in records if not is_counted(record)]
        lines.append(f"{len(counted)} without transmission, volume and subsurface: {_counts(counted)}")
        lines.append(f"{len(others)} with one of these: {_counts(others)}")
    return "\n".join(lines)


def _counts(records: list[Record]) -> str:
    measured = [record for record in records if is_measured(record)]
    within = sum(record["rel_mse"] <= WITHIN for record in measured)
    share = f" ({within / len(records):.1%})" if records else ""
    return f"{within} within {WITHIN:g}{share}, {len(measured) - within} not, {len(records) - len(measured)} failed"


def write(path: Path, records: list[Record], circumstances: dict[str, Any]) -> None:
    """Replaces the file at once, so that it is whole at any time."""
    data = circumstances | {"files": sorted(records, key=lambda record: record["file"])}
    beside = path.with_name(f".{path.name}")
    beside.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    beside.replace(path)
