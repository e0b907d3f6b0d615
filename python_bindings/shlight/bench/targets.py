# SPDX-License-Identifier: MIT
"""The same kernels on every instruction set that the machine has: the time of each ÷ that of the best."""

from __future__ import annotations

from shlight import _core

from . import against_peer, inputs, kinds, peer
from .against_peer import AVX2, LANES
from .rounds import Work
from .row import Row
from .run import Run

ORDER = 16
BOUNDS = {
    "basis": against_peer.BASIS,
    "clipped sphere": against_peer.CLIPPED,
    "clipped sphere, fused": against_peer.FUSED,
    "whole sphere": against_peer.WHOLE,
    "warped lobe": against_peer.WARPED,
    "quad, fused": against_peer.QUADS,
}


def measure(run: Run) -> list[Row]:
    targets, usual = _core.kernel_targets(), _core.kernel_target()
    calls = kinds.works(run.lights, ORDER)
    works = {f"{name}, {target}": _on(target, work) for name, work in calls.items() for target in targets}
    # Of fewer directions, whose basis fits into what its allocator keeps: beside so many large results fresh memory
    # would be most of its time.
    works[against_peer.PEER] = peer.basis(inputs.directions(max(1, run.lights // 10)), ORDER)
    try:
        seconds = run.alternate(works)
    finally:
        _core.force_kernel_target(usual)
    best, *others = targets
    rows = []
    for name in calls:
        for target in others:
            row = f"{name}, n = {ORDER}, {target}"
            rows.append(run.ratio(seconds, f"{name}, {target}", f"{name}, {best}", unit=f"× {best}", row=row))
    if AVX2 in targets:
        for name, bounds in BOUNDS.items():
            row, bound = f"{name}, n = {ORDER}, {AVX2} ÷ {against_peer.PEER}", LANES * bounds[ORDER]
            own = f"{name}, {AVX2}"
            rows.append(run.ratio(seconds, own, against_peer.PEER, unit=against_peer.UNIT, bound=bound, row=row))
    return rows


def _on(target: str, work: Work) -> Work:
    def call() -> None:
        _core.force_kernel_target(target)
        work.call()

    return Work(call, work.count)
