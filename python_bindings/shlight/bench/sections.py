# SPDX-License-Identifier: MIT
"""All sections, in the order of the report."""

from __future__ import annotations

from . import against_methods, against_peer, growth, limits, many_lights, memory, mesh_emitter, render, targets, threads
from .run import Section

SECTIONS = [
    Section("basis", "Basis ÷ sphericart's", against_peer.measure_basis),
    Section("spheres", "Sphere lights ÷ sphericart's basis", against_peer.measure_spheres),
    Section("warped", "Sphere lights under a glossy lobe ÷ sphericart's basis", against_peer.measure_warped),
    Section("quads", "Quads, half of them clipped ÷ sphericart's basis", against_peer.measure_quads),
    Section("methods", "The papers' methods", against_methods.measure),
    Section("growth", "Growth with the order", growth.measure),
    Section("threads", "Two threads", threads.measure),
    Section("targets", "Instruction sets", targets.measure),
    Section("memory", "Memory", memory.measure),
    Section("limits", "Limits of the machine", limits.measure),
    Section("render", "Stages of a render", render.measure),
    Section("many", "Many lights ÷ ten", many_lights.measure),
    Section("emitter", "A shining mesh of many faces ÷ one of 80", mesh_emitter.measure),
]

PEERED = {"basis", "spheres", "warped", "quads", "targets"}  # need sphericart
