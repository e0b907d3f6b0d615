# SPDX-License-Identifier: MIT
"""Frames per hour of many machines, by simulation, for docs/farm.md.

usage: python docs/figures/simulate_farm.py seconds…      recorded times of frames on one machine

Assumes: a machine takes the next frame as soon as it is free, and a time drawn from those recorded; each starts after
START seconds; the command receives and writes one file after the other, WRITE seconds each; machines are alike, none
fails, and the network is no limit.
"""

from __future__ import annotations

import heapq
import random
import sys

START, WRITE = 5.0, 0.05
FRAMES = 1000


def seconds_of(machines: int, times: list[float], seed: int = 1) -> float:
    """From the start of the command to the last file."""
    chance = random.Random(seed)
    free = [START] * machines
    ended = []
    for _ in range(FRAMES):
        end = heapq.heappop(free) + chance.choice(times)
        heapq.heappush(free, end)
        ended.append(end)
    written = 0.0
    for end in sorted(ended):
        written = max(written, end) + WRITE
    return written


if __name__ == "__main__":
    recorded = [float(text) for text in sys.argv[1:]]
    for count in (1, 2, 3, 10, 100):
        print(f"{count:4d} machines: {3600 * FRAMES / seconds_of(count, recorded):8.0f} frames per hour")
