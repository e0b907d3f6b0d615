# SPDX-License-Identifier: MIT
"""All sections, in the order of the report."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import calls, peer, pictures
from .inputs import directions
from .rounds import WALL, Spread, Work
from .row import Row
from .run import Run, Section, duration

PEER, UNIT = "sphericart", "× sphericart's basis"
PEER_BOUNDS = {  # of kinds of calls at any order, on machines with AVX2 or better
    "basis": 0.8,
    "clipped sphere": 1.0,
    "clipped sphere, Lambert": 0.6,
    "whole sphere": 0.9,
    "warped lobe": 1.8,
    "quad, Lambert": 4.4,
}
AUTO_PEER_ORDER = 8

GROWING, SPANS = "clipped sphere", ((16, 64), (8, 64))
GROWTH_BOUNDS = {(16, 64): 2.05}
THREADED_ORDERS, THREADS_BOUND = (8, 16), 1.5  # a virtual machine may be given two threads of one core
PICTURED = {"many": pictures.many, "emitter": pictures.emitters}
PICTURED_BOUNDS = {"many": 20.0, "emitter": 3.0}


def works(run: Run) -> dict[str, Work]:
    """The calls of a section whose time two builds can be compared by."""
    if run.section in PICTURED:
        return {name: work for group in PICTURED[run.section](run) for name, work in group.items()}
    if run.section == "render":
        return pictures.rooms(run)
    if run.section == "growth":
        return _growing(run)
    kinds = calls.KINDS.get(run.section, {})
    return {calls.label(k, n): calls.work(k, run.lights, n) for k in kinds for n in _orders(k)}


def _orders(kind: str) -> list[calls.Order]:
    return [*calls.ORDERS, "auto"] if kind in calls.AUTO else [*calls.ORDERS]


def measure_kinds(run: Run) -> list[Row]:
    """The calls of a section, each order and the library's own choice in turns with sphericart's basis."""
    kinds = list(calls.KINDS[run.section])
    orders = list(dict.fromkeys(order for kind in kinds for order in _orders(kind)))
    rows = []
    for i, order in enumerate(orders):
        known = [kind for kind in kinds if order in _orders(kind)]
        works = {kind: calls.work(kind, run.lights, order) for kind in known}
        works[PEER] = peer.basis(directions(run.lights), AUTO_PEER_ORDER if order == "auto" else order)
        seconds = run.alternate(works, (i, len(orders)))
        for kind in known:
            bound = None if order == "auto" else PEER_BOUNDS.get(kind)
            row = calls.label(kind, order)
            rows.append(run.ratio(seconds, kind, PEER, unit=UNIT, bound=bound, row=row))
    return sorted(rows, key=lambda row: kinds.index(row.name.rpartition(", ")[0]))


def measure_growth(run: Run) -> list[Row]:
    """p of time ∝ nᵖ between two orders."""
    seconds = run.alternate(_growing(run))
    rows = []
    for low, high in SPANS:
        at_low, at_high = (seconds[calls.label(GROWING, n)] for n in (low, high))
        exponent = Spread.of(np.log(at_high / at_low) / np.log(high / low))
        detail, bound = f"{duration(at_low)} … {duration(at_high)}", GROWTH_BOUNDS.get((low, high))
        name = f"{GROWING}, n = {low} … {high}"
        rows.append(Row.of(run.section, name, exponent, "exponent", bound=bound, detail=detail))
    return rows


def _growing(run: Run) -> dict[str, Work]:
    orders = sorted({order for span in SPANS for order in span})
    return {calls.label(GROWING, n): calls.work(GROWING, run.count(n), n) for n in orders}


def measure_threads(run: Run) -> list[Row]:
    """Time on the wall of one thread ÷ that of two."""
    rows = []
    for i, order in enumerate(THREADED_ORDERS):
        works: dict[str, Work] = {}
        for kind in calls.ALL:
            works |= {f"{kind}, {threads}": calls.work(kind, run.lights, order, threads) for threads in (1, 2)}
        seconds = run.alternate(works, (i, len(THREADED_ORDERS)), WALL)
        for kind in calls.ALL:
            gain = run.ratio(seconds, f"{kind}, 1", f"{kind}, 2", unit="× as fast", row=calls.label(kind, order))
            rows.append(replace(gain, bound=THREADS_BOUND, bound_is="least"))
    return rows


def measure_pictures(run: Run) -> list[Row]:
    """In each group ratios to the first; the bound is that of the last."""
    run = run.shorter()
    made, bound = PICTURED[run.section](run), PICTURED_BOUNDS[run.section]
    rows = []
    for i, works in enumerate(made):
        seconds = run.alternate(works, (i, len(made)))
        least, *others = works
        for name in others:
            rows.append(run.ratio(seconds, name, least, unit="×", bound=bound if name == others[-1] else None))
    return rows


SECTIONS = [
    Section("basis", "Basis ÷ sphericart's", measure_kinds),
    Section("spheres", "Sphere lights ÷ sphericart's basis", measure_kinds),
    Section("warped", "Sphere lights under a glossy lobe ÷ sphericart's basis", measure_kinds),
    Section("quads", "Quads, half of them clipped ÷ sphericart's basis", measure_kinds),
    Section("disks", "Ellipses, half of them clipped ÷ sphericart's basis", measure_kinds),
    Section("growth", "Growth with the order", measure_growth),
    Section("threads", "Two threads", measure_threads),
    Section("render", "Stages of a render", pictures.measure_stages),
    Section("many", "Many lights ÷ ten", measure_pictures),
    Section("emitter", "A shining mesh ÷ one of 80 faces", measure_pictures),
]

PEERED = set(calls.KINDS)  # need sphericart
