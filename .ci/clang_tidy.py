#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs clang-tidy on the sources of the modules, as ./dev setup compiled them; --all: on each file, in every depth.

CLEAN holds a commit whose sources were found clean: all of them, or those that differed from the one that it held
before. Without --all, sources are read that have changed since then, themselves, in something that they include or in
how they are compiled and read: kernels for one instruction set, since for all they are the same source; the others
several at once; and without the analyzer, which takes a third of the time.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BUILD = Path("build/python")
CLEAN = Path(".ci/clang-tidy-clean")
KERNEL = "include <hwy/foreach_target.h>"
SOURCES = ("core", "python_bindings", "tools")
MOST_COMMITS = 20  # since CLEAN: by then a header that everything includes has changed, as a rule


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


def changed_sources(commit: str) -> tuple[list[str], list[str]]:
    """Kernels, and other sources."""
    commands = json.loads((BUILD / "compile_commands.json").read_text())
    changed, files = changed_since(commit), included()
    found: tuple[list[str], list[str]] = ([], [])
    for command in commands:
        name, built = command["file"], command["command"].split(" -o ")[1].split()[0]
        if "/tests/" not in name and (changed is None or files.get(built, changed) & changed):
            found[KERNEL not in Path(name).read_text()].append(name)
    print(f"{len(found[0])} kernels and {len(found[1])} of other sources changed since {commit}", flush=True)
    return found


def are_clean(sources: Iterable[str], *options: str) -> bool:
    def is_clean(source: str) -> bool:
        command = ["clang-tidy-14", "--quiet", "-p", str(BUILD), *options, source]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        # It counts on stderr what it found in system headers and does not show.
        said = [line for line in done.stderr.splitlines() if not re.search(r" warnings? generated\.$", line)]
        print(done.stdout, *said, sep="\n", end="", flush=True)
        return done.returncode == 0

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return all(list(pool.map(is_clean, sources)))


def main(everything: bool) -> bool:
    commit = CLEAN.read_text().strip() if CLEAN.exists() else "none"
    if everything:
        named = printed("git", "ls-files", "-co", "--exclude-standard", *(f"{folder}/*.cpp" for folder in SOURCES))
        clean = are_clean(named)
    else:
        kernels, others = changed_sources(commit)
        # Without the analyzer clang's own warnings are errors here, and -Wconversion is more to it than to GCC.
        checks = Path(".clang-tidy").read_text().replace("  clang-analyzer-*,\n", "")
        quick = (f"--config={checks}", "--extra-arg=-Wno-error")
        clean = are_clean(others, *quick) & are_clean(kernels, *quick, "--extra-arg=-DHWY_COMPILE_ONLY_STATIC")
    try:
        is_old = int(printed("git", "rev-list", "--count", f"{commit}..HEAD")[0]) > MOST_COMMITS
    except subprocess.CalledProcessError:
        is_old = True
    differs = subprocess.run(["git", "diff", "--quiet", "HEAD", "--", *SOURCES, ".clang-tidy"], check=False)
    if clean and (everything or is_old) and differs.returncode == 0:
        CLEAN.write_text(printed("git", "rev-parse", "HEAD")[0] + "\n")
        print(f"{CLEAN} now names this commit; commit it")
    return clean


if __name__ == "__main__":
    sys.exit(not main("--all" in sys.argv[1:]))
