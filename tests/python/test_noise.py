# SPDX-License-Identifier: MIT
"""Noise and waves: their values beside a formulation of their own, and their means where they are far away."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from shlight import nodes
from shlight.nodes.program import ProgramBuilder

SCALES = (0.25, 0.6616, 0.982, 0.8344)


def rotated(x: Any, by: int) -> Any:
    return x << np.uint32(by) | x >> np.uint32(32 - by)


def hashed(key: list[Any]) -> Any:
    """Jenkins's lookup3 of 1 … 4 arrays of words."""
    start = np.full(key[0].shape, (0xDEADBEEF + 4 * len(key) + 13) & 0xFFFFFFFF, dtype=np.uint32)
    s = [start, start, start]
    for i, word in enumerate(key):
        if i == 3:
            for x, y, z, by in ((0, 2, 1, 4), (1, 0, 2, 6), (2, 1, 0, 8), (0, 2, 1, 16), (1, 0, 2, 19), (2, 1, 0, 4)):
                s[x] = (s[x] - s[y]) ^ rotated(s[y], by)
                s[y] = s[y] + s[z]
        s[i % 3] = s[i % 3] + word
    for x, y, by in ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24)):
        s[x] = (s[x] ^ s[y]) - rotated(s[y], by)
    return s[2]


def slopes(h: Any, x: list[Any]) -> Any:
    """Scalar products of offsets and the gradients of hashes."""

    def signed(value: Any, bit: int) -> Any:
        return np.where(h >> np.uint32(bit) & np.uint32(1), -value, value)

    if len(x) == 1:
        return signed((1.0 + h % 8) * x[0], 3)
    if len(x) == 2:
        return np.where(h % 8 < 4, signed(x[0], 0) + signed(2 * x[1], 1), signed(x[1], 0) + signed(2 * x[0], 1))
    if len(x) == 3:
        k = h % 16
        second = np.where(k < 4, x[1], np.where((k == 12) | (k == 14), x[0], x[2]))
        return signed(np.where(k < 8, x[0], x[1]), 0) + signed(second, 1)
    k = h % 32
    a, b, c = (np.where(k < end, x[i], x[i + 1]) for i, end in enumerate((24, 16, 8)))
    return signed(a, 0) + signed(b, 1) + signed(c, 2)


def plain_noise(place: Any) -> Any:
    """Noise of places (count, coordinates), in float64."""
    low = np.floor(place)
    t = place - low
    weight = t**3 * (t * (6 * t - 15) + 10)
    total = np.zeros(len(place))
    for corner in itertools.product((0, 1), repeat=place.shape[1]):
        words = [(own + up).astype(np.int64).astype(np.uint32) for own, up in zip(low.T, corner, strict=True)]
        share = np.where(corner, weight, 1 - weight).prod(axis=1)
        total += share * slopes(hashed(words), list((t - corner).T))
    return SCALES[place.shape[1] - 1] * total


def values(expressions: list[nodes.Value], place: Any, steps: Any = None) -> Any:
    """Expressions of nodes.position() at places (count, 3), whose neighbours are `steps` (2, count, 3) away."""
    builder = ProgramBuilder()
    builder.result(expressions)
    here = np.stack([place, *(place + (np.zeros((2, 1, 3)) if steps is None else steps))]).astype(np.float32)
    inputs = [((0, 0, axis), np.ascontiguousarray(here[..., axis])) for axis in range(3)]
    return builder.program().evaluate(inputs, len(place))


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_octaves(dimensions: int) -> None:
    place = np.random.default_rng(dimensions).uniform(-20, 20, (1000, 3)).astype(np.float32)
    p = nodes.position()
    found = values([*nodes.noise(p, p.x, dimensions=dimensions, scale=1.0, detail=1.25, roughness=0.7)], place)
    full = np.column_stack([place, place[:, 0]])[:, {1: [0], 2: [0, 1], 3: [0, 1, 2], 4: [0, 1, 2, 3]}[dimensions]]
    octaves = [plain_noise(full * 2.0**i) * 0.7**i for i in range(3)]
    mean = [sum(octaves[:count]) / sum(0.7**i for i in range(count)) for count in (2, 3)]
    np.testing.assert_allclose(found[0], 0.5 + 0.5 * (0.75 * mean[0] + 0.25 * mean[1]), rtol=0, atol=1e-5)
    # The colour's parts are as independent as two series of a thousand random numbers are.
    assert np.abs(np.corrcoef(found) - np.eye(3)).max() <= 0.15


def test_places_that_are_no_numbers_or_far_away() -> None:
    place = np.array([(np.nan, 1.5, np.inf), (1e30, -1e30, 3e9), (0.0, 0.0, 0.0)])
    found = values([nodes.noise(detail=15.0).x, nodes.noise(repeats=False).x, nodes.wave(distortion=1.0)], place)
    assert np.isfinite(found[:2]).all()
    assert (np.abs(found[:2]) <= 1.5).all()


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (nodes.noise, {"dimensions": 5}, "dimensions must be 1, 2, 3 or 4, got 5"),
        (nodes.noise, {"kind": "perlin"}, "kind must be one of"),
        (nodes.noise, {"detail": np.nan}, "detail must be finite, got nan"),
        (nodes.musgrave, {"dimension": "much"}, "dimension must be a number"),
        (nodes.wave, {"direction": "spherical"}, "direction must be one of 'x', 'y', 'z', 'diagonal'"),
        (nodes.wave, {"profile": "square"}, "profile must be one of"),
    ],
)
def test_what_is_refused(function: Callable[..., Any], arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        function(**arguments)
