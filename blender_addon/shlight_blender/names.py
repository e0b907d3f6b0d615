# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of Blender's data, which in files of old versions need not be UTF-8."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def name_bytes(owner: Any, attribute: str = "name") -> bytes:
    """A name as the file has it. Blender gives one that is not UTF-8 to no script, but Python's error has it."""
    try:
        return str(getattr(owner, attribute)).encode()
    except UnicodeDecodeError as error:
        return error.object


def name_of(owner: Any, attribute: str = "name") -> str:
    """A name; one that is not UTF-8 is read as Latin-1."""
    name = name_bytes(owner, attribute)
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode("latin-1")


def with_name(owners: Iterable[Any], name: str) -> Any:
    """The one with this name, as `name_of` has it; None without one."""
    return next((each for each in owners if name_of(each) == name), None)


def is_utf8(owner: Any) -> bool:
    """Whether Blender's functions take the owner's name."""
    return name_of(owner).encode() == name_bytes(owner)


def printable(text: str) -> str:
    """The text with a question mark for each byte of a path that is not UTF-8."""
    return text.encode("utf-8", "replace").decode("utf-8")


def one_line(error: Exception) -> str:
    """The text of an error without line breaks, and without what Blender puts before it."""
    return " ".join(str(error).removeprefix("Error: ").split())
