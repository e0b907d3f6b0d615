# SPDX-License-Identifier: MIT
"""Small mutations of sources, at places that are drawn: signs, comparisons, axes, indices, constants, truth values."""

from __future__ import annotations

import io
import random
import re
import subprocess
import tokenize
from collections.abc import Iterator
from pathlib import Path

SOURCES = (
    "core/src",
    "core/include",
    "python_bindings",
    "blender_addon/shlight_blender",
)
BOTH = [
    (r" \+ ", " - "),
    (r" - ", " + "),
    (r" \+= ", " -= "),
    (r" \* ", " / "),
    (r" < ", " >= "),
    (r" > ", " <= "),
    (r" <= ", " > "),
    (r" >= ", " < "),
    (r" == ", " != "),
    (r"\bmin\(", "max("),
    (r"\bmax\(", "min("),
    (r"\bsin\(", "cos("),
    (r"\bcos\(", "sin("),
    (r"\.x\b", ".y"),
    (r"\.y\b", ".z"),
    (r"\.z\b", ".x"),
    (r"\[0\]", "[1]"),
    (r"\[1\]", "[0]"),
    (r"\b0\.5\b", "0.25"),
    (r"\b2(?:\.0)? \* ", "3 * "),
]
COMPILED = [
    *BOTH,
    (r" && ", " || "),
    (r" \|\| ", " && "),
    (r"\btrue\b", "false"),
    (r"\bfalse\b", "true"),
    (r"!(?=\w)", ""),
]
PYTHON = [
    *BOTH,
    (r" and ", " or "),
    (r" or ", " and "),
    (r"\bTrue\b", "False"),
    (r"\bFalse\b", "True"),
    (r"\bnot ", ""),
]
MUTATIONS = {".cpp": COMPILED, ".h": COMPILED, ".py": PYTHON}
# Lines whose mutation is a matter of types, of messages or of what a loop visits, which hangs or crashes at once.
SKIPPED = re.compile(
    r"^\s*(//|/?\*|#|namespace|using|template|static_assert|throw|raise|for \(|import |from |def |class )"
)


def draw(root: Path, count: int, seed: int) -> Iterator[tuple[str, str, str, str]]:
    """About, file, find and put of as many mutations; files are as probable as they have lines."""
    listed = subprocess.check_output(["git", "ls-files", "-z", *SOURCES], cwd=root, text=True).rstrip("\0").split("\0")
    texts = {name: (root / name).read_text() for name in listed if Path(name).suffix in MUTATIONS}
    lines = [(name, number) for name, text in texts.items() for number in range(text.count("\n"))]
    chance = random.Random(seed)
    seen: set[tuple[str, int]] = set()
    while count > 0:
        name, number = chance.choice(lines)
        if (name, number) in seen:
            continue
        seen.add((name, number))
        text = texts[name]
        before = text.splitlines()[number]
        if found := mutated(Path(name).suffix, code_of(Path(name).suffix, text, number), before, chance):
            yield f"line {number + 1}: {before.strip()} -> {found.strip()}", name, *unique(text, number, found)
            count -= 1


def code_of(suffix: str, text: str, number: int) -> str:
    """A line with blanks for what is no code: strings and comments."""
    line = text.splitlines()[number]
    if SKIPPED.match(line):
        return ""
    if suffix != ".py":
        return re.sub(r'"(?:[^"\\]|\\.)*"|//.*', lambda found: " " * len(found[0]), line)
    code = [" "] * len(line)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.start[0] == number + 1 == token.end[0] and token.type not in (tokenize.STRING, tokenize.COMMENT):
            code[token.start[1] : token.end[1]] = token.string
    return "".join(code)


def mutated(suffix: str, code: str, line: str, chance: random.Random) -> str | None:
    """The line with one mutation; None if there is no place for any."""
    places = [(found.start(), found.end(), put) for each, put in MUTATIONS[suffix] for found in re.finditer(each, code)]
    if not places:
        return None
    start, end, put = chance.choice(places)
    return line[:start] + put + line[end:]


def unique(text: str, number: int, put: str) -> tuple[str, str]:
    """The line, after as many of those before it as make it stand once, and the same with what is put there."""
    lines = text.splitlines(keepends=True)
    for first in range(number, -1, -1):
        find = "".join(lines[first : number + 1])
        if text.count(find) == 1:
            return find, "".join(lines[first:number]) + put + "\n"
    raise AssertionError("the whole file stands once in itself")
