#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints what the compiler was given to make the modules, each name followed by a zero byte.

Only what has changed since a commit: a source, something that it includes, or how sources are compiled and read.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

BUILD = Path("build/python")
KERNEL = "include <hwy/foreach_target.h>"


def printed(*command: str) -> list[str]:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def changed_since(commit: str) -> set[Path] | None:
    """The files that differ from the commit; None if it is unknown, or if a file that concerns all sources differs."""
    try:
        names = printed("git", "diff", "--name-only", commit, "--")
    except subprocess.CalledProcessError:
        return None
    changed = {Path(name).resolve() for name in names + printed("git", "ls-files", "--others", "--exclude-standard")}
    tests = Path("tests").resolve()
    concerns_all = (
        (path.name in (".clang-tidy", "CMakeLists.txt") or path.suffix == ".cmake") and tests not in path.parents
        for path in changed
    )
    return None if any(concerns_all) else changed


def included() -> dict[str, set[Path]]:
    """The files from which each object was compiled, according to Ninja."""
    files: dict[str, set[Path]] = {}
    current: set[Path] = set()
    for line in printed("ninja", "-C", str(BUILD), "-t", "deps"):
        if line.startswith(" "):
            current.add((BUILD / line.strip()).resolve())
        elif ": #deps" in line:
            files[line.split(": #deps")[0]] = current = set()
    return files


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kernels", action="store_true", help="those compiled once per instruction set, or the others")
    parser.add_argument("commit", help="an unknown one: all sources")
    arguments = parser.parse_args()
    commands = json.loads((BUILD / "compile_commands.json").read_text())
    sources = {
        command["file"]: command["command"].split(" -o ")[1].split()[0]
        for command in commands
        if "/tests/" not in command["file"] and (KERNEL in Path(command["file"]).read_text()) == arguments.kernels
    }
    changed, files = changed_since(arguments.commit), included()
    selected = [name for name, built in sources.items() if changed is None or files.get(built, changed) & changed]
    kind = "kernels" if arguments.kernels else "other sources"
    print(f"{len(selected)} of {len(sources)} {kind} changed since {arguments.commit}", file=sys.stderr)
    print(*selected, sep="\0", end="\0" if selected else "")


if __name__ == "__main__":
    main()
