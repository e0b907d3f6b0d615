# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers of whole numbers, as Cycles makes them: Bob Jenkins' lookup3 hash."""

from __future__ import annotations

ALL_BITS = 0xFFFFFFFF
START = 0xDEADBEEF + 13
STEPS = (14, 11, 25, 16, 4, 14, 24)


def hashed(*keys: int) -> int:
    """A number of 32 bits for one or two others."""
    start = (START + 4 * len(keys)) & ALL_BITS
    a, b, c = (start + (keys[0] & ALL_BITS)) & ALL_BITS, start, start
    if len(keys) > 1:
        b = (b + (keys[1] & ALL_BITS)) & ALL_BITS
    state = [a, b, c]
    for i, step in enumerate(STEPS):
        mixed, by = (2 + i) % 3, (1 + i) % 3
        turned = ((state[by] << step) | (state[by] >> (32 - step))) & ALL_BITS
        state[mixed] = ((state[mixed] ^ state[by]) - turned) & ALL_BITS
    return state[2]


def hashed_text(text: bytes) -> int:
    """A number of 32 bits for a name; bytes from 128 on count as negative ones."""
    found = 0
    for byte in text:
        found = (found * 37 + (byte if byte < 128 else byte - 256)) & ALL_BITS
    return found


def share(bits: int) -> float:
    """32 bits as a number in 0 … 1."""
    return bits / ALL_BITS
