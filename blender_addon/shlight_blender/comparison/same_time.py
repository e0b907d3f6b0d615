# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of shlight, and one of Cycles in the same time.

Messages, beside those of every worker:
    {"kind": "stage", "name": ..., "expected_seconds": ...}
    {"kind": "shlight", "seconds": ...}: shlight.exr is there
"""

from __future__ import annotations

from typing import Any

from .. import record
from .scene import SceneError
from .timing import SampleTime, alternate, calibrate, middle, rounds_for
from .worker import Options, Worker

SEED_SAME_TIME = 0  # a random seed that no half of the reference has


class SameTimeWorker(Worker[Options]):
    """A worker that renders both."""

    def _figures_of_shlight(self) -> dict[str, Any]:
        """shlight's picture, and what it reports of it."""
        self._stage("shlight")
        seconds, warm_up_seconds = self._shlight()
        if record.last.dark:
            raise SceneError(record.last.dark)
        self._send(kind="shlight", seconds=seconds)
        made, statistics = record.last, record.last.statistics
        return {
            "settings": made.settings,
            "unsupported": made.messages,
            "warm_up_seconds": warm_up_seconds,
            "times": [seconds],
            "export_seconds": made.export_seconds,
            "build_seconds": statistics.build_seconds,
            "render_seconds": statistics.render_seconds,
            "stage_seconds": statistics.stage_seconds,
            "order_shares": {str(order): share for order, share in statistics.order_shares.items()},
            "cubature_share": statistics.cubature_share,
            "mirror_share": statistics.mirror_share,
            "over_tolerance": statistics.over_tolerance,
            "hits": statistics.hits,
            "shadow_rays": statistics.shadow_rays,
            "operations": made.operations,
            "texture_bytes": made.texture_bytes,
        }

    def _same_time(self, figures: dict[str, Any]) -> SampleTime:
        """Cycles at the samples that take shlight's time; what takes little time is repeated in turns."""
        ours = figures["shlight"]["times"]
        target = ours[0]
        self._stage("Cycles, finding the samples for the same time", target / 2)
        time_of = calibrate(self._render_same_time, target, self._options.samples)
        samples = min(time_of.samples(target), self._options.samples)
        rounds = rounds_for(target)
        again = f", and in turns with shlight {rounds - 1} times more" if rounds > 1 else ""
        self._stage(f"Cycles, same time: {samples} samples{again}", (2 * rounds - 1) * target)
        theirs = [self._render_same_time(samples)]
        self._save("cycles_same_time.exr")
        more = alternate(self._render_shlight, lambda: self._render_same_time(samples), rounds - 1)
        ours += more[0]
        theirs += more[1]
        time_of.add(samples, middle(theirs))
        figures["shlight"]["seconds"] = middle(ours)
        figures["cycles_same_time"] = {"samples": samples, "seconds": middle(theirs), "times": theirs}
        return time_of

    def _render_same_time(self, samples: int) -> float:
        return self._render_cycles(samples, SEED_SAME_TIME, denoise=self._options.denoise)
