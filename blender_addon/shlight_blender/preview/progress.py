# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on standard output: a bar that moves in a terminal, a line per stage elsewhere."""

from __future__ import annotations

import sys
import time
from typing import TextIO

BAR_WIDTH = 24


class Progress:
    """Shows one stage after the other; the fraction of a stage is what its expected time says."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._moving = self._stream.isatty()
        self._name = ""
        self._expected = 0.0
        self._since = 0.0

    def stage(self, name: str, expected_seconds: float = 0.0) -> None:
        """Begins a stage, which ends the one before. expected_seconds: 0 if unknown."""
        self.end()
        self._name, self._expected, self._since = name, expected_seconds, time.monotonic()
        if not self._moving:
            about = f" (about {expected_seconds:.0f} s)" if expected_seconds >= 1.0 else ""
            print(f"{name}{about}", file=self._stream, flush=True)

    def note(self, text: str) -> None:
        """Ends the stage that is shown, and says what is to be read now."""
        self.end()
        print(text, file=self._stream, flush=True)

    def tick(self) -> None:
        """Moves the bar; to be called a few times a second."""
        if not self._moving or not self._name:
            return
        elapsed = time.monotonic() - self._since
        bar = ""
        if self._expected > 0.0:
            # Never full before the stage has ended.
            full = min(int(BAR_WIDTH * elapsed / self._expected), BAR_WIDTH - 1)
            bar = f"[{'#' * full}{'.' * (BAR_WIDTH - full)}] "
        self._stream.write(f"\r\033[K{bar}{elapsed:5.1f} s  {self._name}")
        self._stream.flush()

    def end(self) -> None:
        """Ends the stage that is shown."""
        if self._moving and self._name:
            self._stream.write(f"\r\033[K{time.monotonic() - self._since:5.1f} s  {self._name}\n")
            self._stream.flush()
        self._name = ""
