# SPDX-License-Identifier: MIT
"""What the site's pages of the API need beside docstrings as they are written for `help`."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any

import griffe

import shlight

ARGUMENTS = re.compile(r"(\w+(?:, \w+)*): (.*)")


def markdown(text: str) -> str:
    """A docstring whose lines "name: what it is" are a list, and whose examples are blocks of code."""
    lines: list[str] = []
    state = ""
    for line in text.splitlines():
        arguments = ARGUMENTS.fullmatch(line)
        if line.startswith(">>> "):
            lines += ["", "```pycon", line] if state != "code" else [line]
            state = "code"
        elif state == "code" and line:
            lines += [line]
        elif arguments:
            lines += [""] * (state != "list") + [f"- `{arguments[1]}`: {arguments[2]}"]
            state = "list"
        else:
            ends = state == "code" or (state == "list" and line[:1].strip()) or re.match("Returns|Raises", line)
            lines += ["```"] * (state == "code") + [""] * bool(ends) + [line]
            state = "" if ends else state
    return "\n".join(lines + ["```"] * (state == "code"))


def function(name: str, own: Callable[..., Any]) -> griffe.Function:
    """A function as it is known once it is imported, with names, kinds and defaults of its parameters."""
    parameters = [
        griffe.Parameter(
            each.name,
            kind=griffe.ParameterKind(each.kind.description),
            default=None if each.default is each.empty else repr(each.default),
        )
        for each in inspect.signature(own).parameters.values()
    ]
    return griffe.Function(
        name, parameters=griffe.Parameters(*parameters), docstring=griffe.Docstring(inspect.getdoc(own) or "")
    )


class Docstrings(griffe.Extension):
    """Adds functions that are made when the package is imported, and writes docstrings as Markdown."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Called once all modules are there."""
        pkg["rendering"].set_member("render", function("render", shlight.render))
        for name in ("principled", "from_function", "from_table", "read"):
            pkg["_core.Bsdf"].set_member(name, function(name, getattr(shlight.Bsdf, name)))
        self._walk(pkg)

    def _walk(self, parent: griffe.Object) -> None:
        for member in parent.members.values():
            if not member.is_alias:
                if member.docstring:
                    member.docstring.value = markdown(member.docstring.value)
                self._walk(member)
