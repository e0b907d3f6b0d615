# SPDX-License-Identifier: MIT
"""The `shlight` command: finds its commands in the entry point group "shlight.commands" and runs one.

A command is a function (argv: list[str]) -> int, its exit code. A package on top of this one adds commands without
this one knowing it; the first line of a module's docstring explains its command in the list of them.
"""

from __future__ import annotations

import ast
import importlib.util
import sys
from collections.abc import Callable, Sequence
from importlib import metadata
from pathlib import Path

from shlight.commands import run_to_exit

GROUP = "shlight.commands"


def main(argv: Sequence[str] | None = None) -> int:
    """Runs `shlight argv...` and returns its exit code; 2 for a command line that is not understood."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    return run_to_exit("shlight", lambda: _run(arguments))


def _run(arguments: list[str]) -> int:
    commands = metadata.entry_points(group=GROUP)
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print("usage: shlight <command> [arguments]\n       shlight --version\n\ncommands:")
        width = max(map(len, commands.names), default=0)
        for name in sorted(commands.names):
            print(f"  {name:{width}}  {_explanation(commands[name].module)}".rstrip())
        print("\n`shlight <command> --help` explains a command.")
        return 0
    name = arguments[0]
    if name == "--version":
        print(f"shlight {metadata.version('shlight')}")
        return 0
    if name not in commands.names:
        _complain(f"unknown command '{name}'; `shlight --help` lists the commands")
        return 2
    try:
        command: Callable[[list[str]], int] = commands[name].load()
    except ModuleNotFoundError as error:
        _complain(f"{name} needs the Python module {error.name}: pip install 'shlight[blender]'")
        return 1
    return command(arguments[1:])


def _explanation(module: str) -> str:
    """The first line of a docstring; the module is not imported, since what it needs may be missing."""
    package, *names = module.split(".")
    spec = importlib.util.find_spec(package)
    folder = Path(spec.origin or "").parent if spec else Path()
    for path in (folder.joinpath(*names, "__init__.py"), folder.joinpath(*names).with_suffix(".py")):
        if path.is_file():
            text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
            return text.partition("\n")[0]
    return ""


def _complain(message: str) -> None:
    print(f"shlight: {message}", file=sys.stderr)
