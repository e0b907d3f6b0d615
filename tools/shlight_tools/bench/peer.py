# SPDX-License-Identifier: MIT
"""sphericart, the fastest library for the basis: https://github.com/lab-cosmo/sphericart."""

from __future__ import annotations

import importlib.util
import os

import numpy as np

from shlight._arrays import Floats
from shlight.commands import CommandError

from .rounds import Work


def check_installed() -> None:
    """Raises CommandError where sphericart is missing."""
    if importlib.util.find_spec("sphericart") is None:
        raise CommandError("the Python module sphericart is missing: pip install sphericart", 1)


def basis(directions: Floats, order: int) -> Work:
    """Its basis of an order in unit directions, float32, on one thread."""
    os.environ["OMP_NUM_THREADS"] = "1"  # its OpenMP reads this when it is loaded
    import sphericart

    harmonics = sphericart.SphericalHarmonics(order - 1)
    if directions.dtype != np.float32:
        raise ValueError("directions must be float32")
    return Work(lambda: harmonics.compute(directions), len(directions))
