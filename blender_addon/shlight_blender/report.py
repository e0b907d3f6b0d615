# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a Blender scene shlight renders otherwise than Cycles would, collected while the scene is exported."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum

from .names import printable


class ExportError(ValueError):
    """The scene cannot be rendered at all (no camera, a camera type without a picture plane)."""


class ExportCancelled(Exception):  # noqa: N818
    """The user stopped the export; nothing is wrong."""


class Effect(IntEnum):
    """How much of the picture a finding changes, the most first."""

    DARK = 0  # nothing gives light
    LIGHT = 1  # light is missing or goes elsewhere, which shows on everything
    THING = 2  # something is missing, black, or seen where it should not be
    LOOK = 3  # something looks otherwise
    SLIGHT = 4  # hardly seen, or not in the picture at all


@dataclass
class Message:
    """One finding: what is the case and what is done instead (`text`), and everything it holds for (`places`)."""

    text: str
    effect: Effect
    places: list[str] = field(default_factory=list)

    def line(self, most: int = 4) -> str:
        """The message on one line; of many places only the first `most` are named."""
        shown = ", ".join(self.places[:most])
        if len(self.places) > most:
            shown += f" and {len(self.places) - most} more"
        return f"{shown}: {self.text}"


def thing(place: str) -> str:
    """The owner of a place: "Material 'Wood'" for "Material 'Wood', node 'Noise Texture'"."""
    name, part, _ = place.partition("', ")
    return f"{name}'" if part else place


class ExportReport:
    """Messages by their effect, then by how much of the picture that changes, then as they first occurred.

    The same text about several things is one message.
    """

    def __init__(self) -> None:
        self._messages: dict[str, Message] = {}
        self._known: set[tuple[str, str]] = set()  # places and texts: a scene may have thousands of places
        self._shares: dict[str, float] = {}

    def add(self, place: str, text: str, effect: Effect = Effect.LOOK) -> None:
        """Notes `text` about `place`, for instance "Material 'Wood', node 'Noise Texture'"."""
        place, text = printable(place), printable(text)
        message = self._messages.setdefault(text, Message(text, effect))
        message.effect = min(message.effect, effect)
        if (place, text) not in self._known:
            self._known.add((place, text))
            message.places.append(place)

    def extend(self, other: ExportReport) -> None:
        """Notes all that `other` has."""
        for message in other:
            for place in message.places:
                self.add(place, message.text, message.effect)
        self.weigh(other._shares)

    def things(self) -> set[str]:
        """The owners of all places."""
        return {thing(place) for message in self._messages.values() for place in message.places}

    def weigh(self, shares: Mapping[str, float]) -> None:
        """Says how much of the picture things can change; those that nothing is said of can change all."""
        self._shares |= {name: max(share, self._shares.get(name, 0.0)) for name, share in shares.items()}

    def _rank(self, message: Message) -> tuple[Effect, float]:
        share = sum(self._shares.get(name, 1.0) for name in {thing(place) for place in message.places})
        return message.effect, -min(share, 1.0)

    def __iter__(self) -> Iterator[Message]:
        return iter(sorted(self._messages.values(), key=self._rank))

    def __len__(self) -> int:
        return len(self._messages)

    def lines(self, most: int = 4) -> list[str]:
        """One line per message, as shown to the user."""
        return [message.line(most) for message in self]

    def to_data(self) -> list[dict[str, object]]:
        """The messages as plain data: a list of {"text": str, "places": [str, ...]}."""
        return [{"text": message.text, "places": list(message.places)} for message in self]
