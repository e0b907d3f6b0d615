# SPDX-License-Identifier: MIT
"""What is rendered: pictures, their tiles, and the source that they come from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from shlight.farm.frames import PNG

Box = tuple[int, int, int, int]  # left, top, right, bottom in pixels, row 0 on top

# A picture of more pixels is rendered in tiles of this side, which takes a process some 170 MB beside the scene.
MOST_PIXELS = 1 << 24
TILE_SIDE = 1024


@dataclass(frozen=True)
class Rendered:
    """A picture or a tile of one. pixels: (height, width, channels) float32, row 0 on top."""

    channels: tuple[str, ...]  # their names in the file
    pixels: NDArray[np.float32]
    attributes: dict[str, str] = field(default_factory=dict)  # of the file
    messages: tuple[str, ...] = ()  # for the user


class Source(Protocol):
    """A renderer of pictures, which is pickled for workers and keeps opened files in their process."""

    @property
    def key(self) -> str:
        """A hash of everything that decides about pixels, but frame, view and tiles."""

    @property
    def frame(self) -> int:
        """The frame at which the scene's file was saved."""

    @property
    def views(self) -> Sequence[tuple[str, str]]:
        """Names of the views, and what each adds to the names of its files."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of every picture."""

    def render(self, frame: int, view: str, box: Box | None, threads: int) -> Rendered:
        """A part of a picture, or all of it; raises an exception whose text says why that cannot be.

        threads: 0: all cores.
        """


@dataclass(frozen=True)
class Picture:
    """One file."""

    frame: int
    view: str
    path: Path
    size: tuple[int, int]
    key: str  # of everything that decides about its pixels
    boxes: tuple[Box | None, ...]  # its tiles; one None: it is rendered as a whole

    @property
    def name(self) -> str:
        """How the user is told of it."""
        return f"frame {self.frame}" + (f", view {self.view}" if self.view else "")

    @property
    def is_whole(self) -> bool:
        """Whether it has no tiles."""
        return self.boxes == (None,)


def boxes_of(size: tuple[int, int], tile: int | None) -> tuple[Box | None, ...]:
    """Tiles of a picture, by its size and the tiles' side alone; None: tiles where the picture is large."""
    width, height = size
    if tile is None:
        tile = TILE_SIDE if width * height > MOST_PIXELS else 0
    if tile == 0 or (width <= tile and height <= tile):
        return (None,)
    return tuple(
        (left, top, min(left + tile, width), min(top + tile, height))
        for top in range(0, height, tile)
        for left in range(0, width, tile)
    )


def picture_of(source: Source, frame: int, view: str, path: Path, tile: int | None) -> Picture:
    """The picture of a frame, with the hash that its file bears. Those for display have no tiles."""
    boxes = boxes_of(source.size, 0 if path.suffix == PNG else tile)
    text = json.dumps([source.key, frame, view, source.size, boxes])
    return Picture(frame, view, path, source.size, hashlib.sha256(text.encode()).hexdigest(), boxes)
