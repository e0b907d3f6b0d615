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
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "shlight": shlight.__version__,
        "sphericart": _version("sphericart"),
        "numpy": _version("numpy"),
    }


def processor() -> str:
    """Its name, with family and model, as names of virtual machines say little."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").split("\n\n", 1)[0].splitlines() if info.is_file() else []
    known = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    if "cpu family" not in known or "model name" not in known:
        return known.get("model name") or platform.processor() or platform.machine()
    return f"{known['model name']} (family {known['cpu family']}, model {known['model']})"


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
