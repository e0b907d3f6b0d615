# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding the number of samples that takes a given time, and timing two renderers fairly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median

# A render call: does its work and returns its wall time in seconds.
Timed = Callable[[], float]
MOST_PROBES = 5
CLOSE_ENOUGH = 0.1


@dataclass
class SampleTime:
    """Wall time of a render by its number of samples, as a straight line through what was measured."""

    measured: dict[int, float] = field(default_factory=dict)

    def add(self, samples: int, seconds: float) -> None:
        """Notes a measurement; of several with the same number of samples the fastest counts."""
        self.measured[samples] = min(seconds, self.measured.get(samples, seconds))

    @property
    def per_sample(self) -> float:
        """Seconds that one more sample takes."""
        low, high = min(self.measured), max(self.measured)
        if high > low and self.measured[high] > self.measured[low]:
            return (self.measured[high] - self.measured[low]) / (high - low)
        return self.measured[high] / high

    def seconds(self, samples: int) -> float:
        """Foretold wall time for this many samples."""
        high = max(self.measured)
        return max(self.measured[high] + (samples - high) * self.per_sample, 0.0)

    def samples(self, seconds: float) -> int:
        """The number of samples, at least 1, whose time comes closest to this."""
        high = max(self.measured)
        return max(1, round(high + (seconds - self.measured[high]) / self.per_sample))


def calibrate(render: Callable[[int], float], target_seconds: float, most_samples: int) -> SampleTime:
    """Measures render(samples) -> seconds at growing numbers of samples until the target's time is known."""
    time = SampleTime()
    time.add(1, render(1))
    for _ in range(MOST_PROBES):
        largest = max(time.measured)
        wanted = min(time.samples(target_seconds), most_samples)
        # From few samples one cannot see far; the line is followed in steps of at most 16.
        probe = min(wanted, 16 * largest)
        if probe in time.measured:
            break
        time.add(probe, render(probe))
        if abs(time.measured[probe] - target_seconds) <= CLOSE_ENOUGH * target_seconds:
            break
    return time


def rounds_for(seconds: float) -> int:
    """How often to repeat a measurement of about this length: short ones vary more and cost less."""
    if seconds < 2.0:
        return 5
    return 3 if seconds < 20.0 else 1


def alternate(first: Timed, second: Timed, rounds: int) -> tuple[list[float], list[float]]:
    """Times of both, run in turns, so that what else the machine does falls on both."""
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        times[0].append(first())
        times[1].append(second())
    return times


def middle(times: list[float]) -> float:
    """The median, which one disturbed run does not move."""
    return float(median(times))
