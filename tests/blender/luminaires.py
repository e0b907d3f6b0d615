# SPDX-License-Identifier: MIT
"""Files of luminaires as IES LM-63 has them."""

from __future__ import annotations

import numpy as np

KINDS = {
    # Photometric type, vertical and horizontal angles.
    "quarter": (1, np.linspace(0.0, 90.0, 10), np.linspace(0.0, 90.0, 4)),
    "half": (1, np.array([0.0, 10.0, 22.5, 45.0, 60.0, 75.0, 90.0, 120.0, 180.0]), np.array([0.0, 30.0, 90.0, 180.0])),
    "whole": (1, np.linspace(20.0, 180.0, 9), np.linspace(0.0, 315.0, 8)),
    "round": (1, np.linspace(0.0, 80.0, 17), np.zeros(1)),
    "type_a": (3, np.linspace(-90.0, 90.0, 13), np.linspace(0.0, 90.0, 7)),
    "type_b": (2, np.linspace(0.0, 90.0, 7), np.linspace(-90.0, 90.0, 9)),
}


def luminaire(kind: str, candela: float = 200.0, *, tilted: bool = False) -> str:
    """A file whose light differs from angle to angle, and is lowest at the last vertical one."""
    number, heights, turns = KINDS[kind]
    rng = np.random.default_rng(len(kind))
    values = candela * np.linspace(1.0, 0.2, len(heights)) * rng.uniform(0.6, 1.4, (len(turns), len(heights)))
    tilt = "TILT=INCLUDE\n1\n2\n0, 90\n1 1" if tilted else "TILT=NONE"
    lists = [" ".join(f"{value:g}" for value in row) for row in (heights, turns, *values)]
    head = f"1 1000 1.5 {len(heights)} {len(turns)} {number} 2 0 0 0\n0.9 1 50"
    return "\n".join(["IESNA:LM-63-1995", tilt, head, *lists]) + "\n"
