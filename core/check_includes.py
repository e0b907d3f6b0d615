#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that the sources of core/src include only what lies in their own folder or in one before it.

A public header belongs to the folder that implements it.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

CORE = Path(__file__).resolve().parent
ORDER = [
    "base",
    "simd",
    "math",
    "regions",
    "lobes",
    "shaders",
    "tracing",
    "emitters",
    "lights",
    "environment",
    "camera",
    "surfaces",
    "lighting",
    "film",
    "queries",
]
# Public headers that no source of the same name implements.
WITHOUT_SOURCE = {"surface_point": "tracing", "render_report": "base"}


def folders() -> dict[str, str]:
    """The folder of each file, by the name under which it is included."""
    own = {str(path.relative_to(CORE / "src")): path.parent.name for path in CORE.glob("src/*/*.*")}
    by_stem = {Path(name).stem: folder for name, folder in own.items() if name.endswith(".cpp")} | WITHOUT_SOURCE
    return own | {f"shlight/{path.name}": by_stem[path.stem] for path in CORE.glob("include/shlight/*.h")}


def main() -> int:
    """Prints each include that points against the order; the exit code is 1 if there is one."""
    folder_of = folders()
    wrong = []
    for name, folder in folder_of.items():
        path = CORE / ("include" if name.startswith("shlight/") else "src") / name
        for included in re.findall(r'#include "([^"]+)"', path.read_text(encoding="utf-8")):
            if included not in folder_of:
                wrong.append(f"{name}: {included} is no file of core/src, by its folder, or of core/include")
            elif ORDER.index(folder_of[included]) > ORDER.index(folder):
                wrong.append(f"{name} ({folder}) includes {included} ({folder_of[included]})")
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
