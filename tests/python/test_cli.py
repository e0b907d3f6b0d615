# SPDX-License-Identifier: MIT
from __future__ import annotations

import subprocess
import sys
from importlib import metadata

import pytest

from shlight import cli


class Commands(dict):
    """Stands for what importlib.metadata finds: names to objects with load()."""

    @property
    def names(self) -> set[str]:
        return set(self)


class Command:
    module = "no_such_package.command"

    def __init__(self, run: object) -> None:
        self.run = run

    def load(self) -> object:
        if isinstance(self.run, Exception):
            raise self.run
        return self.run


@pytest.fixture
def commands(monkeypatch: pytest.MonkeyPatch) -> Commands:
    found = Commands()
    monkeypatch.setattr(metadata, "entry_points", lambda group: found if group == cli.GROUP else Commands())
    return found


def test_lists_commands(commands: Commands, capsys: pytest.CaptureFixture[str]) -> None:
    commands["paint"] = Command(None)
    assert cli.main([]) == 0
    assert "  paint\n" in capsys.readouterr().out
    assert cli.main(["--help"]) == 0


def test_every_command_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"]) == 0
    listed = capsys.readouterr().out.split("commands:\n")[1].split("\n\n")[0].splitlines()
    explained = dict(line.strip().partition("  ")[::2] for line in listed)
    assert explained.keys() == metadata.entry_points(group=cli.GROUP).names
    assert all(text.strip().endswith(".") for text in explained.values()), explained


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"shlight {metadata.version('shlight')}\n"


def test_runs_the_command_with_its_arguments(commands: Commands) -> None:
    seen = []
    commands["paint"] = Command(lambda argv: seen.append(argv) or 7)
    assert cli.main(["paint", "--blue", "x"]) == 7
    assert seen == [["--blue", "x"]]


def test_unknown_command(commands: Commands, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["pant"]) == 2
    assert capsys.readouterr().err == "shlight: unknown command 'pant'; `shlight --help` lists the commands\n"


def test_missing_module_is_one_line(commands: Commands, capsys: pytest.CaptureFixture[str]) -> None:
    commands["paint"] = Command(ModuleNotFoundError("No module named 'bpy'", name="bpy"))
    assert cli.main(["paint"]) == 1
    assert capsys.readouterr().err == "shlight: paint needs the Python module bpy: pip install 'shlight[blender]'\n"


def test_interrupt(commands: Commands, capsys: pytest.CaptureFixture[str]) -> None:
    def run(_: list[str]) -> int:
        raise KeyboardInterrupt

    commands["paint"] = Command(run)
    assert cli.main(["paint"]) == 130
    assert capsys.readouterr().err == "shlight: interrupted\n"


def test_closed_pipe_is_one_line() -> None:
    code = "import sys; from shlight.cli import main; sys.exit(main(['--version']))"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read().decode() == "shlight: standard output was closed before all was written\n"
        assert process.wait() == 141
