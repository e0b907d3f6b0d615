# SPDX-License-Identifier: MIT
"""Equal time and equal quality: a room by harmonics and by Monte Carlo with multiple importance sampling.

Zhou & Wei 2020, Figs. 1 and 5: a matt scene at order 8 and one of rough gold at order 16.
"""

from __future__ import annotations

from typing import Any

from .figure import Drawn, Run, Table
from .picture_measure import Compared, Effort, Setting, compare, seconds_text
from .picture_panels import draw_curves, draw_strip
from .scenes import gold_room, matt_room

SETTINGS = [
    Setting("matt", "Matt paint, order 8", matt_room, 8, ((0.66, 0.84), (0.22, 0.62))),
    Setting("gold", "Rough gold (roughness 0.5), order 16", gold_room, 16, ((0.45, 0.62), (0.84, 0.66))),
]

FULL = Effort(
    240,
    150,
    half_samples=512,
    samples=(1, 4, 16, 64, 256),
    most_samples=1024,
    rays=((1, 1), (1, 4), (4, 4), (16, 4), (16, 16)),
    adaptive_rays=((2, 4), (4, 4), (8, 8)),
    rounds=3,
    seconds=1.0,
)
QUICK = Effort(
    80,
    50,
    half_samples=64,
    samples=(1, 8, 64),
    most_samples=128,
    rays=((1, 1), (4, 4), (16, 4)),
    adaptive_rays=((2, 4), (4, 4)),
    rounds=2,
    seconds=0.3,
)


def draw(run: Run) -> Drawn:
    effort = QUICK if run.quick else FULL
    done = []
    for i, setting in enumerate(SETTINGS):

        def step(share: float, text: str, i: int = i, name: str = setting.name) -> None:
            run.step((i + share) / len(SETTINGS), f"{name}: {text}")

        done.append(compare(setting, effort, run.seed, step))
    draw_strip(run, done)
    draw_curves(run, done)
    run.csv("pictures", ["scene", "way", "effort", "seconds", "rel_mse", "uncertainty"], _numbers(done))
    return Drawn(_explanation(done), [_table(done)])


def _numbers(done: list[Compared]) -> list[list[Any]]:
    rows = []
    for compared in done:
        ways = [(line.label, call) for line in compared.lines for call in line.calls]
        ways += [("equal time", compared.equal_time), ("equal quality", compared.equal_quality)]
        for label, call in ways:
            numbers = (call.seconds, call.error.value, call.error.uncertainty)
            rows.append([compared.setting.name, label, call.effort, *(f"{number:.4g}" for number in numbers)])
    return rows


def _table(done: list[Compared]) -> Table:
    rows = []
    for compared in done:
        most = compared.lines[0].calls[-1]
        for line in compared.lines[1:]:
            call = line.calls[-1]
            needed = compared.by_monte_carlo(call)
            rows.append(
                [
                    compared.setting.title,
                    f"{line.label}, {call.effort}",
                    call.time,
                    str(call.error),
                    f"{most.seconds * most.error.value / call.seconds:.1e}",
                    seconds_text(needed),
                    f"{needed / call.seconds:.1f}",
                ]
            )
    header = [
        "scene",
        "camera × shadow rays",
        "time",
        "relMSE",
        "Monte Carlo in that time",
        "to that relMSE",
        "time ratio",
    ]
    return Table("Harmonics and Monte Carlo with MIS, whose error × time is the same all along its curve", header, rows)


def _explanation(done: list[Compared]) -> str:
    parts = []
    for c in done:
        plain = c.lines[1].calls[-1]
        needed = c.seconds_for_quality / c.shown.seconds
        alone = f"a relMSE of {c.bias:.0e}" if c.bias > 0 else "no error"
        parts.append(
            f"{c.setting.title}: with adaptive camera rays {c.shown.time} give a relMSE of "
            f"{c.shown.error}; Monte Carlo with MIS has {c.equal_time.error} after the same time and takes "
            f"{needed:.1f} times as long for the same error, {c.by_monte_carlo(plain) / plain.seconds:.1f} times if "
            f"each pixel of the harmonics gets {plain.effort.removesuffix(' a pixel')}; the order alone keeps {alone}"
        )
    noise = " and ".join(f"{c.reference.noise:.1e}" for c in done)
    return (
        f"{'. '.join(parts)}. Errors are against two independent halves of a reference and so free of its own noise, "
        f"{noise}; what harmonics keep are edges and half shadows."
    )
