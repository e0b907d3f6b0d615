# SPDX-License-Identifier: MIT
"""What the user sees of frames that are rendered: a bar on a terminal, else a line for each."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from datetime import timedelta
from typing import TextIO

from shlight.progress import Progress


class FarmProgress:
    """Counts frames, and guesses when the last will be there."""

    def __init__(self, frames: int, kept: int, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._moving = self._stream.isatty()
        self._bar = Progress(1, self._stream)
        self._frames, self._kept = frames, kept
        self._done = 0
        self._tiles = 0.0  # shares of frames that are not complete
        self._since = time.monotonic()
        self._said: set[str] = set()
        if kept:
            self.say(f"{kept} whole already; --force renders them too")
        if frames:
            self._bar.begin("frames" if self._moving else f"rendering {frames} {'frame' if frames == 1 else 'frames'}")

    def say(self, text: str) -> None:
        """A line of its own."""
        self._bar.interrupt()
        print(text, file=self._stream, flush=True)

    def say_once(self, text: str) -> None:
        """Calls `say` unless the same text was said before."""
        if text not in self._said:
            self._said.add(text)
            self.say(f"shlight: {text}")

    def count_tile(self, share: float) -> None:
        """So much of a frame is there."""
        self._tiles += share
        self.tick()

    def count(self, text: str) -> None:
        """One frame more is there, or has failed; text: of it."""
        self._done += 1
        self._tiles = self._tiles % 1.0 if self._tiles >= 1.0 else 0.0
        if self._moving:
            self.tick()
        else:
            self.say(f"{text}  ({self._state()})")

    def tick(self) -> None:
        """Moves the bar; to be called a few times a second."""
        self._bar.step((self._done + min(self._tiles, 1.0)) / self._frames, self._state())

    def end(self, failed: Mapping[str, str]) -> None:
        """Says how it went."""
        if self._frames:
            self._bar.interrupt()
            self._bar.end()
        print(f"{self._done - len(failed)} rendered, {self._kept} kept, {len(failed)} failed", file=self._stream)
        for name, reason in failed.items():
            print(f"  {name}: {reason}", file=self._stream)
        self._stream.flush()

    def _state(self) -> str:
        """Frames done, their rate, and the time left."""
        elapsed = time.monotonic() - self._since
        done = self._done + min(self._tiles, 1.0)
        text = f"{self._done}/{self._frames}"
        if done == 0 or elapsed <= 0:
            return text
        left = timedelta(seconds=round(elapsed * (self._frames - done) / done))
        return f"{text}, {60 * done / elapsed:.3g} frames/min, {left} left"
