# SPDX-License-Identifier: MIT
"""The command `shlight bench`: what it prints and writes, and what it refuses. Its sections are stand-ins."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from command_cases import names, putter

from shlight import _core
from shlight.bench import command, options, sections
from shlight.bench.row import Row, read
from shlight.bench.run import Run, Section


def measure_two(run: Run) -> list[Row]:
    run.step(0.5, "two")
    return [
        Row(run.section, "first", 0.5, 0.5, 0.5, "×", bound=0.6),
        Row(run.section, "second", 7.0, 7.0, 7.0, "×"),
    ]


def measure_in_vain(run: Run) -> list[Row]:
    raise KeyboardInterrupt


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Puts other sections in place of the real ones."""
    return putter(monkeypatch, "SECTIONS", command, options)


TWO = Section("two", "Two rows", measure_two)
VAIN = Section("vain", "In vain", measure_in_vain)


def test_a_run_prints_tables_and_leaves_a_file(
    tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    use(TWO)
    out = tmp_path / "new" / "a.json"
    assert command.main(["--quick", "--out", str(out)]) == 0
    assert names(out.parent) == ["a.json"]
    bench = read(out)
    assert [row.name for row in bench.rows] == ["first", "second"]
    assert bench.settings == {"lights": options.QUICK_LIGHTS, "rounds": options.QUICK_ROUNDS}
    assert bench.machine["instruction set"] == _core.kernel_target()
    assert bench.machine["processor"]
    said = capsys.readouterr().out
    assert "1/1 Two rows\n" in said
    assert "Two rows\n\n|" in said
    assert "1 of 1 bounds are met\n" in said
    assert said.endswith(f"results: {out}\n")


def test_against_an_earlier_run(tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]) -> None:
    use(TWO)
    first, second = tmp_path / "1.json", tmp_path / "2.json"
    assert command.main(["--out", str(first)]) == 0
    first.write_text(first.read_text().replace("7.0", "3.5"))
    assert command.main(["--out", str(second), "--compare", str(first)]) == 0
    measured = capsys.readouterr().out
    assert command.main(["--read", str(second), "--compare", str(first)]) == 0
    reread = capsys.readouterr().out
    for said in (measured, reread):
        assert f"Change against {first}\n" in said
        assert "1 of 2 rows changed" in said
    assert names(tmp_path) == ["1.json", "2.json"]


def test_an_interrupt_leaves_the_file_before(
    tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    use(TWO, VAIN)
    out = tmp_path / "a.json"
    out.write_text("before")
    assert command.main(["--out", str(out)]) == 130
    assert (names(tmp_path), out.read_text()) == (["a.json"], "before")
    assert capsys.readouterr().err == "shlight bench: interrupted; nothing was written\n"


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(["--list"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert listed == [section.name for section in sections.SECTIONS]
    assert len(set(listed)) == len(listed)
    assert set(listed) >= sections.PEERED


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["bases"], "there is no section 'bases'; there are: basis, "),
        (["--rounds=3"], "unrecognized arguments: --rounds=3"),
        (["--compare", "/nowhere/b.json"], "cannot read /nowhere/b.json: No such file or directory"),
        (["--read", "/nowhere/b.json"], "cannot read /nowhere/b.json: No such file or directory"),
        (["--out", "/"], "/ is a folder; --out wants a file"),
        (["--out", "/dev/null/a.json"], "/dev/null is a file; --out wants a folder"),
    ],
)
def test_bad_requests_are_named(arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"shlight bench: {complaint}")
    assert said.err.count("\n") == 1


def test_a_missing_peer_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert command.main(["basis"]) == 1
    expected = "shlight bench: the Python module sphericart is missing: pip install 'shlight[bench]'\n"
    assert capsys.readouterr().err == expected


def test_what_needs_no_peer_runs_without(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['sphericart'] = None\n"
        "from shlight.bench.command import main; sys.exit(main(['--list']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "growth" in done.stdout
