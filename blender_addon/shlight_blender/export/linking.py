# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: objects in sets, by which lights tell what they light and what blocks them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

# How many sets of each kind a shlight.Scene tells apart.
MOST_SETS = {"receiver_collection": 64, "blocker_collection": 28}


class Links(NamedTuple):
    """The sets of an object, and those that its light keeps to, as arguments of `shlight.Scene.add_mesh`."""

    light_set: int = 0
    shadow_set: int = 0
    receivers: tuple[int, ...] | None = None
    blockers: tuple[int, ...] | None = None

    def of_light(self) -> dict[str, Any]:
        """The arguments that lamps take."""
        return {"receivers": self.receivers, "blockers": self.blockers}


@dataclass(frozen=True)
class _Sets:
    """Sets of objects that the same collections of lights take in; the first has all that are named by none."""

    numbers: dict[int, int]  # of the set, by the object's address
    members: dict[int, tuple[int, ...]]  # the sets that a collection takes in, by its address

    @staticmethod
    def of(role: str, owners: list[Any]) -> _Sets:
        """The sets of a kind of collection that lights have."""
        collections = {own.as_pointer(): own for own in (getattr(light.light_linking, role) for light in owners) if own}
        named = [_named(own) for own in collections.values()]
        # Without any object that is taken in, all are but those that are left out.
        others = tuple(not any(own.values()) for own in named)
        looks: dict[Any, int] = {(others, 0): 0}
        numbers = {}
        for shown in {address for own in named for address in own} | _shining(role, owners):
            taken_in = tuple(own.get(shown, other) for own, other in zip(named, others, strict=True))
            # Rays to a mesh meet what is of its set: it has one of its own.
            look = taken_in, shown if shown in _shining(role, owners) else 0
            numbers[shown] = looks.setdefault(look, len(looks))
        members = {
            address: tuple(number for (taken_in, _), number in looks.items() if taken_in[i])
            for i, address in enumerate(collections)
        }
        return _Sets(numbers, members)

    def of_light(self, role: str, linking: Any) -> tuple[int, ...] | None:
        """The sets that a light's collection takes in; None: the light has none."""
        collection = getattr(linking, role, None)
        return None if collection is None else self.members[collection.as_pointer()]


@dataclass(frozen=True)
class Linking:
    """The links of all objects of a depsgraph; equal if they are."""

    sets: dict[str, _Sets]

    @staticmethod
    def of(depsgraph: Any) -> Linking:
        """Reads the collections of all objects that have some."""
        objects = (own.original for own in depsgraph.objects)
        owners = [own for own in objects if any(getattr(_linking(own), role, None) for role in MOST_SETS)]
        return Linking({role: _Sets.of(role, owners) for role in MOST_SETS} if owners else {})

    def links(self, shown: Any, instancer: Any) -> Links:
        """The links of an object. It is of the sets of the object that shows it, unless that is named by none."""
        if not self.sets:
            return Links()
        sets: list[int] = []
        lights: list[tuple[int, ...] | None] = []
        for role, most in MOST_SETS.items():
            numbers = self.sets[role].numbers
            owners = [own.original.as_pointer() for own in (instancer, shown) if own is not None]
            number = next((numbers[own] for own in owners if numbers.get(own)), 0)
            sets.append(number if number < most else 0)
            members = self.sets[role].of_light(role, _linking(shown.original))
            lights.append(members and tuple(own for own in members if own < most))
        return Links(sets[0], sets[1], lights[0], lights[1])

    def has_too_many_sets(self) -> bool:
        """Whether some objects are taken for others that no collection names."""
        return any(max(own.numbers.values(), default=0) >= MOST_SETS[role] for role, own in self.sets.items())


def _linking(own: Any) -> Any:
    return getattr(own, "light_linking", None)  # since Blender 4.0


def _shining(role: str, owners: list[Any]) -> set[int]:
    """The meshes whose light has blockers of its own."""
    is_shadow = role == "blocker_collection"
    return {
        own.as_pointer() for own in owners if is_shadow and own.type != "LIGHT" and own.light_linking.blocker_collection
    }


def _named(collection: Any) -> dict[int, bool]:
    """Whether the objects of a light's collection are taken in or left out, by their addresses."""
    result: dict[int, bool] = {}
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        # A collection in it says nothing of its own objects one by one. The light's own objects come last.
        result |= dict.fromkeys((own.as_pointer() for own in child.all_objects), _takes_in(link))
    for own, link in zip(collection.objects, collection.collection_objects, strict=True):
        result[own.as_pointer()] = _takes_in(link)
    return result


def _takes_in(link: Any) -> bool:
    return bool(link.light_linking.link_state == "INCLUDE")
