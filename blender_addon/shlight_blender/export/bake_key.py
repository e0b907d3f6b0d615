# SPDX-License-Identifier: GPL-3.0-or-later
"""What the picture of a baked world depends on, as a digest: worlds of the same digest are baked to the same picture.

Read are all values of the evaluated nodes, and the contents of what they use. `bake_worker` takes nothing else: the
display and view settings of the scene do not reach it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..compat import pixels_of, working_space

# Nodes whose values come from elsewhere than the node tree.
NODES_OF_ELSEWHERE = {"ATTRIBUTE", "SCRIPT"}
# Kinds of images whose contents are known by `_image`: one file, or none.
KNOWN_IMAGES = {"FILE", "GENERATED"}
# Properties common to all nodes, sockets and images that are followed. Others are about drawing and saving; the
# contents of images are read separately.
FOLLOWED = (
    (bpy.types.Node, {"name", "bl_idname", "mute", "inputs", "outputs"}),
    (bpy.types.NodeSocket, {"identifier", "bl_idname"}),
    (
        bpy.types.Image,
        {"source", "alpha_mode", "colorspace_settings", "use_half_precision"}
        | {"generated_type", "generated_width", "generated_height", "generated_color", "use_generated_float"},
    ),
)


class _UnknownError(Exception):
    """The world uses something whose contents are not followed."""


def bake_key(world: Any, scene: Any) -> bytes | None:
    """Digest of the world of nodes at the scene's frame; None if it uses something that cannot be told unchanged.

    It is of the world that was evaluated and of the user's own, which is baked and may have been edited since.
    """
    reader = _Reader()
    try:
        reader.add("width", scene.shlight.world_width)
        reader.add("space", working_space())
        reader.tree(world.node_tree)
        reader.tree(world.original.node_tree)
    except (_UnknownError, OSError, RuntimeError, UnicodeDecodeError):
        return None
    if reader.is_animated or _is_animated(world):
        reader.add("frame", (scene.frame_current, scene.frame_subframe))
    return reader.digest.digest()


def _is_animated(owner: Any) -> bool:
    data = owner.animation_data
    return data is not None and bool(data.action or len(data.drivers) or len(data.nla_tracks))


class _Reader:
    """Follows a node tree and adds all it finds to a digest."""

    def __init__(self) -> None:
        self.digest = hashlib.sha256()
        self.is_animated = False
        self._seen: dict[tuple[int, str], int] = {}

    def add(self, name: str, value: object) -> None:
        self.digest.update(f"{name}={value!r};".encode())

    def tree(self, tree: Any) -> None:
        """Nodes and links; those of groups once."""
        if self._is_seen(tree):
            return
        self.is_animated |= _is_animated(tree)
        for node in tree.nodes:
            if node.type in NODES_OF_ELSEWHERE:
                raise _UnknownError
            self._struct(node)
        for link in tree.links:
            ends = [(link.from_node.name, link.from_socket.identifier), (link.to_node.name, link.to_socket.identifier)]
            self.add("link", (*ends, link.is_muted, link.is_valid))

    def _is_seen(self, struct: Any) -> bool:
        """Adds which of the things seen it is, so that the digest has each once."""
        number = len(self._seen)
        # A struct may begin with another one, at the same address.
        first = self._seen.setdefault((struct.as_pointer(), struct.bl_rna.identifier), number)
        self.add(struct.bl_rna.identifier, first)
        return first != number

    def _struct(self, struct: Any) -> None:
        if self._is_seen(struct):
            return
        for prop in _properties(struct):
            value = getattr(struct, prop.identifier)
            if prop.type == "POINTER":
                self._pointer(prop.identifier, value)
            elif prop.type == "COLLECTION":
                self.add(prop.identifier, len(value))
                for item in value:
                    self._pointer(prop.identifier, item)
            else:
                self.add(prop.identifier, _plain(value))
                if prop.type == "STRING" and prop.subtype == "FILE_PATH" and value:
                    self.add("file", _file_state(bpy.path.abspath(value, library=struct.id_data.library)))

    def _pointer(self, name: str, value: Any) -> None:
        if value is None:
            self.add(name, None)
        elif isinstance(value, bpy.types.NodeTree):
            self.tree(value)
        elif isinstance(value, bpy.types.Image):
            self._image(value.original)
        elif isinstance(value, bpy.types.Text):
            self.add(name, value.as_string())
        elif isinstance(value, bpy.types.ID):
            raise _UnknownError
        else:
            self._struct(value)

    def _image(self, image: Any) -> None:
        if image.source not in KNOWN_IMAGES or image.use_multiview:
            raise _UnknownError
        self._struct(image)
        if image.is_dirty:
            self.add("pixels", (*image.size, image.channels, image.is_float))
            self.digest.update(pixels_of(image).tobytes())
        elif image.packed_file is not None:
            self.digest.update(image.packed_file.data)
        elif image.source == "FILE":
            self.add("file", _file_state(image.filepath_from_user()))


def _properties(struct: Any) -> Iterator[Any]:
    """The properties of a struct that may have an effect on a picture."""
    skipped = {"rna_type"}
    for kind, followed in FOLLOWED:
        if isinstance(struct, kind):
            skipped = set(kind.bl_rna.properties.keys()) - followed
    for prop in struct.bl_rna.properties:
        if prop.identifier not in skipped and not getattr(prop, "is_deprecated", False):
            yield prop


def _plain(value: Any) -> object:
    """A value of numbers, text, flags or arrays of numbers, such that its repr tells all of it."""
    if isinstance(value, str | bytes | int | float):
        return value
    if isinstance(value, set):
        return sorted(value)
    return np.array(value).tolist()


def _file_state(path: str) -> object:
    """A value that changes when a file is written; None for a missing file."""
    try:
        state = Path(path).stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return path, state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns
