#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that the lines "code:" of this folder name files that exist, and what stands in them."""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
wrong = []
for page in ROOT.glob("docs/*.md"):
    for line in re.findall("^code: .*", page.read_text(encoding="utf-8"), re.MULTILINE):
        for part in line.removeprefix("code: ").split("; "):
            name, *things = re.findall("`([^`]+)`", part)
            file = next((f for f in (ROOT / "core" / "src" / name, ROOT / name) if f.is_file()), None)
            text = file.read_text(encoding="utf-8") if file else ""
            missing = [thing for thing in things if not re.search(rf"\b{thing}\b", text)]
            wrong += [f"{page.name}: {name} has no {thing}, or is not there" for thing in missing]
print(*wrong, sep="\n", end="\n" if wrong else "")
sys.exit(1 if wrong else 0)
