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
            files = [f for f in (ROOT / "core" / "src" / name, ROOT / name) if f.is_file()]
            text = files[0].read_text(encoding="utf-8") if files else ""
            wrong += [] if files else [f"{page.name}: {name} is no file"]
            wrong += [f"{page.name}: {t} is not in {name}" for t in things if files and not re.search(rf"\b{t}\b", text)]
print(*wrong, sep="\n", end="\n" if wrong else "")
sys.exit(1 if wrong else 0)
