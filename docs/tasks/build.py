# SPDX-License-Identifier: MIT
"""Runs the Python code of the pages in this folder, and writes below each block of code what it prints.

usage: python docs/tasks/build.py [page.md ...]

The blocks of a page share their variables. The working directory is this folder, where code saves pictures to images/.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent
CODE = re.compile(r"```python\n(?P<code>.*?)```\n(?:\n```text\n.*?```\n)?", re.DOTALL)


def built(page: Path) -> str:
    """The text of a page with the output of its code, which runs in the working directory."""
    variables: dict[str, Any] = {"__name__": page.stem}

    def run(block: re.Match[str]) -> str:
        code = block["code"]
        line = page.read_text().count("\n", 0, block.start())
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * (line + 1) + code, page, "exec"), variables)
        output = f"\n```text\n{printed.getvalue()}```\n" if printed.getvalue() else ""
        return f"```python\n{code}```\n{output}"

    return CODE.sub(run, page.read_text())


def main() -> None:
    """Builds the pages that the command line names, or all."""
    sys.path.insert(0, str(FOLDER))
    os.chdir(FOLDER)
    for page in [FOLDER / name for name in sys.argv[1:]] or sorted(FOLDER.glob("*.md")):
        print(page.name, flush=True)
        page.write_text(built(page))


if __name__ == "__main__":
    main()
