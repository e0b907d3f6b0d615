# SPDX-License-Identifier: MIT
"""Progress on standard output: a bar that moves in a terminal, a line where a part begins and ends elsewhere."""

from __future__ import annotations

import sys
import time
from typing import TextIO

BAR_WIDTH = 24


class Progress:
    """Shows one part of a command's work after the other."""

    def __init__(self, parts: int, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._moving = self._stream.isatty()
        self._parts = parts
        self._begun = 0
        self._title = ""
        self._since = 0.0

    def begin(self, title: str) -> None:
        self._begun += 1
        self._title = f"{self._begun}/{self._parts} {title}" if self._parts > 1 else title
        self._since = time.monotonic()
        if not self._moving:
            print(self._title, file=self._stream, flush=True)

    def step(self, share: float, text: str = "") -> None:
        """Moves the bar of the part: share 0 … 1; text: of what is being done."""
        if not self._moving:
            return
        full = min(max(int(BAR_WIDTH * share), 0), BAR_WIDTH)
        bar = "#" * full + "." * (BAR_WIDTH - full)
        elapsed = time.monotonic() - self._since
        self._stream.write(f"\r\033[K[{bar}] {elapsed:5.1f} s  {self._title}{text and ': '}{text}"[: 4 + self._width()])
        self._stream.flush()

    def end(self) -> None:
        """Ends the part that is shown."""
        elapsed = f"{time.monotonic() - self._since:.1f} s"
        if self._moving:
            self._stream.write(f"\r\033[K{self._title}: {elapsed}\n")
        else:
            self._stream.write(f"    {elapsed}\n")
        self._stream.flush()

    def interrupt(self) -> None:
        """Leaves the line of the bar, so that what is said next stands alone."""
        if self._moving:
            self._stream.write("\r\033[K")
            self._stream.flush()

    def _width(self) -> int:
        """Characters that fit on a line: a longer one would not be overwritten."""
        import shutil

        return shutil.get_terminal_size().columns - 1
