# SPDX-License-Identifier: MIT
"""Frames per hour of many machines, by simulation, for docs/farm.md.

usage: python docs/figures/simulate_farm.py SCENE A-B [SCALE]

Renders these frames of the scene in one process, and records how long each took and how long its file takes to be
written. Assumes: a machine takes the next frame as soon as it is free, and a time drawn from those recorded; each
starts after START seconds; the command writes one file after the other; machines are alike, none fails, and the
network is no limit.
"""

from __future__ import annotations

import heapq
import itertools
import random
import sys
import tempfile
import time
from pathlib import Path

from shlight.farm import files, parse_frames, render_frames

START = 5.0
FRAMES = 1000


def recorded(scene: str, frames: list[int], scale: float) -> tuple[list[float], float]:
    """Seconds of each frame but the first, which opens the scene; and of writing a file."""
    with tempfile.TemporaryDirectory() as folder:
        written = render_frames(scene, frames, f"{folder}/####.exr", scale=scale, workers=0).written
        ends = [path.stat().st_mtime for path in written]
        data = [path.read_bytes() for path in written]
        begin = time.perf_counter()
        for content in data:
            files.write(Path(folder) / "again.exr", content)
        writing = (time.perf_counter() - begin) / len(data)
    return [after - before for before, after in itertools.pairwise(ends)], writing


def seconds_of(machines: int, times: list[float], writing: float) -> float:
    """The time from the start of the command to the last file."""
    chance = random.Random(1)
    free = [START] * machines
    ended = []
    for _ in range(FRAMES):
        end = heapq.heappop(free) + chance.choice(times)
        heapq.heappush(free, end)
        ended.append(end)
    done = 0.0
    for end in sorted(ended):
        done = max(done, end) + writing
    return done


if __name__ == "__main__":
    own, write = recorded(sys.argv[1], parse_frames(sys.argv[2]), float(sys.argv[3]) if len(sys.argv) > 3 else 1.0)
    print(f"{len(own)} frames of {min(own):.2f} to {max(own):.2f} s, {1000 * write:.0f} ms to write a file")
    for count in (1, 2, 3, 10, 100):
        print(f"{count:4d} machines: {3600 * FRAMES / seconds_of(count, own, write):8.0f} frames per hour")
