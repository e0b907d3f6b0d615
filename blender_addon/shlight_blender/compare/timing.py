# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding the number of samples that takes a given time, and timing two renderers fairly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median

# A render call: does its work and returns its wall time in seconds.
Timed = Callable[[], float]
MOST_PROBES = 4
PROBE_SHARE = 0.25  # of the target's time for the longest probe; a line through it sees as far as the target
PROBE_GROWTH = 16  # from few samples one cannot see far
WORTH_A_PROBE = 1.25  # times the samples measured before


@dataclass
class SampleTime:
    """Wall time of a render by its number of samples, as a straight line through what was measured."""

    measured: dict[int, float] = field(default_factory=dict)

    def add(self, samples: int, seconds: float) -> None:
        """Notes a measurement; of several with the same number of samples the fastest counts."""
        self.measured[samples] = min(seconds, self.measured.get(samples, seconds))

    @property
    def largest(self) -> int:
        """The largest number of samples that was measured."""
        return max(self.measured)

    @property
    def per_sample(self) -> float:
        """Seconds that one more sample takes."""
        low, high = min(self.measured), self.largest
        if high > low and self.measured[high] > self.measured[low]:
            return (self.measured[high] - self.measured[low]) / (high - low)
        return self.measured[high] / high

    @property
    def fixed(self) -> float:
        """Seconds that a render takes beside its samples."""
        return self.seconds(0)

    def seconds(self, samples: int) -> float:
        """Foretold wall time for this many samples."""
        return max(self.measured[self.largest] + (samples - self.largest) * self.per_sample, 0.0)

    def samples_in(self, seconds: float) -> float:
        """Foretold number of samples in this time, which may be less than one."""
        return self.largest + (seconds - self.measured[self.largest]) / self.per_sample

    def samples(self, seconds: float) -> int:
        """The number of samples, at least 1, whose time comes closest to this."""
        return max(1, round(self.samples_in(seconds)))


def calibrate(render: Callable[[int], float], target_seconds: float, most_samples: int) -> SampleTime:
    """Measures render(samples) -> seconds at growing numbers of samples until the target's time can be foretold."""
    time = SampleTime()
    time.add(1, render(1))
    for _ in range(MOST_PROBES):
        probe = min(time.samples(PROBE_SHARE * target_seconds), PROBE_GROWTH * time.largest, most_samples)
        if probe < WORTH_A_PROBE * time.largest:
            break
        time.add(probe, render(probe))
    return time


def rounds_for(seconds: float) -> int:
    """How often to repeat a measurement of about this length: short ones vary more and cost less."""
    if seconds < 0.5:
        return 5
    return 3 if seconds < 2.0 else 1


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
