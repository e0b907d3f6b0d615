# SPDX-License-Identifier: MIT
"""Progress of a worker on standard output: a bar that moves in a terminal, lines for each stage elsewhere."""

from __future__ import annotations

from typing import TextIO

from shlight import progress
from shlight_blender.worker_process import Stage


class Progress:
    """Shows one stage after the other; the share of a stage is what its expected time says."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream
        self._bar = progress.Progress(1, stream)
        self._stage: Stage | None = None
        self._is_shown = False

    def show(self, stage: Stage) -> None:
        """Moves the bar; to be called a few times a second."""
        if stage is not self._stage:
            self.end()
            self._stage, self._is_shown = stage, True
            about = f" (about {stage.expected:.0f} s)" if stage.expected >= 1.0 else ""
            self._bar.begin(f"{stage.name}{about}")
        if self._is_shown:
            self._bar.step(stage.share)

    def note(self, text: str) -> None:
        """Ends the stage that is shown, and says what is to be read now."""
        self.end()
        print(text, file=self._stream, flush=True)

    def end(self) -> None:
        """Ends the stage that is shown."""
        if self._is_shown:
            self._bar.end()
        self._is_shown = False
