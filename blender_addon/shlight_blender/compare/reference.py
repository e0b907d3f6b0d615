# SPDX-License-Identifier: GPL-3.0-or-later
"""How many samples Cycles gets: as many as take a given time, and for a reference on and on until the time is over.

The reference has two independent halves. Their average is the reference, their difference tells its noise. A render
that is stopped does not tell how many samples it had, so the halves grow by pairs of renders, chunks, whose time is
foretold from those before. A half's chunks follow each other in one sequence of samples: its error falls faster than
that of as many independent samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from shlight import metrics

Image = npt.NDArray[np.float32]
MOST_PROBES = 4
PROBE_SHARE = 0.25  # of the target's time for the longest probe; a line through it sees as far as the target
PROBE_GROWTH = 16  # from few samples one cannot see far
WORTH_A_PROBE = 1.25  # times the samples measured before
# render(half, first, samples): samples of half 0 or 1 from number `first` on; the wall time it took, and its picture.
Render = Callable[[int, int, int], tuple[float, Image]]
LARGEST_SHARE = 1 / 4  # of the budget for one chunk: what a render that takes twice the foretold time overshoots
SMALLEST_SHARE = 1 / 16  # of the budget: less is not worth another chunk
FIXED_SHARE = 1 / 8  # of a chunk for what a render takes without samples, as far as the budget allows
LEAST_FOR_NOISE = 16  # samples of a half from which its noise is judged
MARGIN = 1.1  # times the samples that are foretold for a noise
GROWTH = 4  # times the samples measured before: further the time cannot be foretold


@dataclass(frozen=True, kw_only=True)
class Request:
    """A scene, and the effort of its reference."""

    scene: str  # a file
    samples: int  # of the reference, at most
    reference_seconds: float  # for the reference; 0: as long as the samples take, in the panel none
    noise: float = 0.0  # relMSE of the reference's own noise at which it ends
    denoise: bool = False  # Cycles' picture of shlight's time


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
    def _slope(self) -> float:
        low, high = min(self.measured), self.largest
        return (self.measured[high] - self.measured[low]) / max(high - low, 1)

    @property
    def per_sample(self) -> float:
        """Seconds that one more sample takes, at most, until more samples are seen to take longer."""
        return self._slope if self._slope > 0 else self.measured[self.largest] / self.largest

    @property
    def fixed(self) -> float:
        """Seconds that a render takes without samples, at most, until more samples are seen to take longer."""
        return self.seconds(0 if self._slope > 0 else self.largest)

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


def render_halves(
    render: Render, time: SampleTime, most_samples: int, budget: float, noise: float = 0.0
) -> tuple[list[Image], dict[str, Any]]:
    """Both halves, and how they came about; at most `most_samples` in all, in about `budget` seconds (0: no limit).

    noise: what `metrics.reference_rel_mse` of the halves need not fall below; 0: it is not looked at.
    Each half gets a sample at least. The times of the renders are added to `time`.
    """
    most = (most_samples + 1) // 2
    chunks: list[int] = []
    sums: list[Any] = [0.0, 0.0]
    done, spent, wanted = 0, 0.0, min(LEAST_FOR_NOISE, most) if noise > 0 else most
    while samples := _next_chunk(time, wanted - done, spent, budget):
        for half in range(2):
            seconds, image = render(half, done, samples)
            sums[half] = sums[half] + samples * image.astype(np.float64)
            time.add(samples, seconds)
            spent += seconds
        done += samples
        chunks.append(samples)
        if noise > 0 and done == wanted:
            wanted = min(max(wanted, _samples_for(noise, sums, done)), most)
    return [(total / done).astype(np.float32) for total in sums], {
        "samples": 2 * done,
        "seconds": spent,
        "chunks": chunks,  # samples of each half
        "stopped_by": "samples" if done == most else "noise" if done == wanted else "seconds",
    }


def _samples_for(noise: float, sums: list[Any], done: int) -> int:
    """Samples of each half after which the noise will be this low, if it falls as that of independent samples."""
    if not sum(total[..., :3].sum() for total in sums) > 0:
        return done  # black
    ratio = metrics.reference_rel_mse(sums[0] / done, sums[1] / done) / noise
    return done if ratio <= 1 else math.ceil(MARGIN * ratio * done)


def _next_chunk(time: SampleTime, left: int, spent: float, budget: float) -> int:
    """Samples of the next two renders, 0 for none."""
    rest = budget - spent
    if budget == 0:
        return left
    if spent > 0 and rest < SMALLEST_SHARE * budget:
        return 0
    seconds = min(max(LARGEST_SHARE * budget, 2 * time.fixed / FIXED_SHARE), rest)
    fitting = min(int(time.samples_in(seconds / 2)), GROWTH * time.largest)
    return min(max(fitting, 0 if spent > 0 else 1), left)
