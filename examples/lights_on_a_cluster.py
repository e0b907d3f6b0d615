# SPDX-License-Identifier: MIT
"""Spherical-harmonic coefficients of many sphere lights, on all cores or on a cluster, as Dask arrays.

usage: python examples/lights_on_a_cluster.py [lights] [scheduler address]      (pip install 'shlight[farm]')

Lights stay where they are made: a block of them becomes coefficients, and these a sum, on the same worker.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import dask.array as da
import numpy as np
from distributed import Client

import shlight

ORDER = 4
LIGHTS_PER_BLOCK = 1_000_000


def lights(count: int, seed: int = 1) -> Any:
    """Centres and radii of lights around the shading point, (count, 4)."""
    random = da.random.default_rng(seed)
    centers = random.uniform(-10.0, 10.0, (count, 3), chunks=(LIGHTS_PER_BLOCK, 3)) + np.array([0.0, 0.0, 15.0])
    radii = random.uniform(0.01, 0.5, (count, 1), chunks=(LIGHTS_PER_BLOCK, 1))
    return da.concatenate([centers, radii], axis=1).rechunk((LIGHTS_PER_BLOCK, 4))


def coefficients(spheres: Any, order: int = ORDER) -> Any:
    """Coefficients of each light, (count, order²), not computed yet."""

    def of_block(block: Any) -> Any:
        return shlight.sphere_coefficients(block[:, :3], block[:, 3], order, dtype=np.float32, threads=1)

    return spheres.map_blocks(of_block, chunks=(spheres.chunks[0], (order**2,)), dtype=np.float32)


def main() -> None:
    """Adds up the coefficients of all lights and prints them."""
    count = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000
    with Client(*sys.argv[2:3]) as client:
        start = time.perf_counter()
        total = coefficients(lights(count)).sum(axis=0, dtype=np.float64).compute()
        seconds = time.perf_counter() - start
        print(f"{count:.3g} lights in {seconds:.1f} s on {len(client.scheduler_info(-1)['workers'])} workers")
        print(np.array2string(total / count, precision=6))


if __name__ == "__main__":
    main()
