# SPDX-License-Identifier: MIT
"""Where a run runs: numbers mean nothing without it."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from pathlib import Path

import shlight
from shlight import _core


def described() -> dict[str, str]:
    """Processor, cores, the kernels' instruction set, and versions."""
    return {
        "processor": processor(),
        "cores": str(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()),
        "instruction set": _core.kernel_target(),
        "instruction sets": ", ".join(_core.kernel_targets()),
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "shlight": shlight.__version__,
        "sphericart": _version("sphericart"),
        "numpy": _version("numpy"),
    }


def processor() -> str:
    """Its name, with family and model where the name says little, as those of virtual machines do."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").split("\n\n", 1)[0].splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    known = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    if "model name" not in known:
        return platform.processor() or platform.machine()
    numbers = [f"{key} {known[of]}" for key, of in (("family", "cpu family"), ("model", "model")) if of in known]
    return f"{known['model name']} ({', '.join(numbers)})" if numbers else known["model name"]


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
