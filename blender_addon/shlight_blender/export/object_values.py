# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of instances that materials read: custom properties, properties of objects, and what Object Info says.

Random numbers are those that Cycles makes of whole numbers: Bob Jenkins' lookup3 hash.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..names import name_bytes

ALL_BITS = 0xFFFFFFFF
START = 0xDEADBEEF + 13
STEPS = (14, 11, 25, 16, 4, 14, 24)


def hashed(*keys: Any) -> Any:
    """A number of 32 bits for one or two others, which may be arrays of 64 bits."""
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


def share(bits: Any) -> Any:
    """32 bits as a number in 0 … 1."""
    return bits / ALL_BITS


RANDOM = "random"
FROM_INSTANCER = "from instancer"  # the place on what instances it: "Generated" or "UV"
COUNT = 4  # numbers of a property: RGBA


class ObjectValues:
    """The properties that the materials of an export ask for; each is `COUNT` values of `nodes.object_value`."""

    def __init__(self) -> None:
        self._asked: list[tuple[str, str]] = []

    def first(self, kind: str, name: str) -> int:
        """The number of the first value of a property; kind: as an Attribute node's, RANDOM or FROM_INSTANCER."""
        key = (kind, name)
        if key not in self._asked:
            self._asked.append(key)
        return COUNT * self._asked.index(key)

    def of(self, instance: Any) -> list[float]:
        """All values of an instance of the depsgraph."""
        return [value for kind, name in self._asked for value in _values(instance, kind, name)]


def _values(instance: Any, kind: str, name: str) -> tuple[float, ...]:
    if kind == RANDOM:
        own = hashed(hashed_text(name_bytes(instance.object)), 0)
        return (share(instance.random_id & ALL_BITS if instance.is_instance else own), 0.0, 0.0, 0.0)
    if kind == FROM_INSTANCER:
        return _on_instancer(instance, name)
    owners = [instance.object, instance.object.data]
    if kind == "INSTANCER" and instance.is_instance:
        owners.insert(0, instance.parent)
    return property_color(owners, name)


def _on_instancer(instance: Any, name: str) -> tuple[float, ...]:
    """The coordinates of an instance on the surface of its instancer, as Cycles has them; 0 without an instancer."""
    if not instance.is_instance:
        return (0.0, 0.0, 0.0, 0.0)
    if name == "UV":
        return (*instance.uv, 0.0, 0.0)
    return (*(0.5 * own - 0.5 for own in instance.orco), 0.0)


def property_color(owners: list[Any], name: str) -> tuple[float, float, float, float]:
    """A property of the first owner that has it, as RGBA: a custom property or a path; 0 if there is none."""
    for owner in owners:
        found = _as_color(_property(owner, name))
        if found is not None:
            return found
    return (0.0, 0.0, 0.0, 0.0)


def _property(owner: Any, name: str) -> Any:
    if owner is None:
        return None
    try:
        return owner[name]
    except (KeyError, TypeError):
        pass
    try:
        return owner.path_resolve(name)
    except (ValueError, AttributeError):
        return None


def _as_color(value: Any) -> tuple[float, float, float, float] | None:
    if value is None or isinstance(value, str):
        return None
    try:
        numbers = np.nan_to_num(np.asarray(value, dtype=np.float64)).ravel()
    except (TypeError, ValueError):
        return None
    if len(numbers) == 0:
        return None
    if len(numbers) == 1:
        return (float(numbers[0]),) * 3 + (1.0,)
    padded = [*(float(n) for n in numbers[:4]), 0.0][: max(len(numbers), 3)]
    return (padded[0], padded[1], padded[2], padded[3] if len(numbers) > 3 else 1.0)
