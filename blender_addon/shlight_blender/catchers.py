# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers: pictures of parts of a scene, and what they make together.

Of a catcher nothing is seen but the share of its light that other objects leave it: a picture of the catchers among the
others is divided by one of the catchers alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .passes import SHADOW_CATCHER, Arrays, pass_arguments, stores_shadows

Pixels = NDArray[np.float32]

# A shadow is a small difference of light, in which noise counts for more.
NOISE_OF_SHADOWS = 0.25
# Beginnings of the names of passes of light, of which catchers have none.
LIGHT = ("combined", "emission", "environment")


class Part(Enum):
    """The camera sees a part of a scene."""

    WHOLE = auto()  # everything, catchers as any other object
    CATCHERS = auto()  # catchers; the others are held out
    BARE = auto()  # the same, lit as if there were no others
    WORLD = auto()  # what is behind all objects
    OBJECTS = auto()  # all but catchers, which are held out

    @property
    def shows_world(self) -> bool:
        """Whether the world is seen if the film is opaque."""
        return self not in {Part.CATCHERS, Part.BARE}

    @property
    def shows_lamps(self) -> bool:
        """Whether lamps are seen that are to be."""
        return self in {Part.WHOLE, Part.OBJECTS}

    def holds_out(self, catches: bool) -> bool:
        """Whether there is a hole in the place of an object."""
        return catches if self is Part.OBJECTS else self in {Part.CATCHERS, Part.BARE} and not catches

    def hidden_from(self, catches: bool) -> set[str]:
        """The kinds of rays that do not meet an object."""
        if self is Part.WORLD:
            return {"camera"}
        return {"diffuse", "glossy", "transmission", "shadow"} if self is Part.BARE and not catches else set()


# The first has the passes of surfaces, the other has those of light.
PARTS_WITH_PASSES = {Part.WHOLE, Part.OBJECTS}


def is_catcher(instance: Any) -> bool:
    """Whether an instance of the depsgraph, or what shows it, is a shadow catcher; lamps have the flag too."""
    shown_by = (instance.object, instance.parent if instance.is_instance else None)
    return any(own is not None and own.type != "LIGHT" and own.is_shadow_catcher for own in shown_by)


def parts_of(depsgraph: Any) -> list[Part]:
    """The parts of a scene of which pictures are to be made, in this order."""
    scene, view_layer = depsgraph.scene, depsgraph.view_layer
    if not any(is_catcher(instance) for instance in depsgraph.object_instances):
        return [Part.WHOLE]
    passes = [Part.WHOLE] if pass_arguments(scene, view_layer) else []
    world = [] if scene.render.film_transparent or stores_shadows(view_layer) else [Part.WORLD]
    return [*passes, Part.CATCHERS, Part.BARE, *world, Part.OBJECTS]


@dataclass
class Pictures:
    """The pictures of parts of a scene, as far as they are made; the last one's is what the others are put into."""

    parts: list[Part]
    apart: bool  # shadows are a pass alone, and not in the picture
    made: dict[Part, Arrays] = field(default_factory=dict)

    def is_last(self, part: Part) -> bool:
        """Whether the picture of this part ends the render."""
        return part is self.parts[-1]

    def progress(self, tell: Callable[[float], bool]) -> Callable[[float], bool]:
        """`tell` of the share of all pictures, for the next one's progress."""
        return lambda share: tell((len(self.made) + share) / len(self.parts))

    def shared(self, settings: Mapping[str, Any], part: Part) -> dict[str, Any]:
        """Arguments of `shlight.render` for one of them, by those for all."""
        limit, noise = settings["time_limit"], settings["noise_threshold"]
        noise *= NOISE_OF_SHADOWS if part in {Part.CATCHERS, Part.BARE} else 1.0
        return {**settings, "time_limit": limit and limit / len(self.parts), "noise_threshold": noise}

    def whole(self, last: Arrays) -> Arrays:
        """The picture of all parts and its passes, by those of the last one."""
        image = last["combined"]
        if len(self.parts) == 1:
            return {**last, SHADOW_CATCHER: np.ones_like(image[..., :3])} if self.apart else last
        left = self._light_left(image)
        surfaces = self.made.get(Part.WHOLE, {})
        light = {name: pixels for name, pixels in last.items() if name.startswith(LIGHT) or name.endswith("direct")}
        combined = image if self.apart else image + (1.0 - image[..., 3:]) * self._behind(left)
        return {**surfaces, **light, "combined": combined, SHADOW_CATCHER: left}

    def _behind(self, left: Pixels) -> Pixels:
        """What is seen where catchers are: the world in shadow, or black that dims whatever is put behind it."""
        mean = left.mean(axis=-1, keepdims=True)
        if Part.WORLD not in self.parts:
            return np.concatenate([np.zeros_like(left), np.maximum(1.0 - mean, 0.0)], axis=-1)
        world = self.made[Part.WORLD]["combined"]
        return np.concatenate([world[..., :3] * mean, world[..., 3:]], axis=-1)

    def _light_left(self, image: Pixels) -> Pixels:
        """The share of light that other objects leave catchers; 1 where there are none."""
        caught, bare = (self.made[part]["combined"] for part in (Part.CATCHERS, Part.BARE))
        # Pictures may have found different shares of a pixel to be covered.
        above, below = caught[..., :3] * bare[..., 3:], bare[..., :3] * caught[..., 3:]
        left = np.divide(above, below, where=below > 0.0, out=np.ones_like(above))
        cover = image[..., 3:] + caught[..., 3:]
        return np.asarray(1.0 + cover * (left - 1.0), dtype=np.float32)
