# SPDX-License-Identifier: MIT
"""The commands that measure, `./dev charts` and `./dev bench`: what they print, write and refuse."""

from __future__ import annotations

import importlib.util
import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from shlight import _core
from shlight.commands import CommandError
from shlight.progress import Progress
from shlight_tools.bench import command as bench
from shlight_tools.bench.row import Bench, Row, read
from shlight_tools.bench.run import QUICK_LIGHTS, QUICK_ROUNDS, Section
from shlight_tools.bench.run import Run as BenchRun
from shlight_tools.bench.sections import SECTIONS
from shlight_tools.charts import command as charts
from shlight_tools.charts import style
from shlight_tools.charts.figure import Drawn, Figure, Run, Table
from shlight_tools.charts.figures import FIGURES
from shlight_tools.charts.page import PAGE

Use = Callable[..., Callable[[list[str]], int]]


def names(folder: Path) -> list[str]:
    """The names of a folder's files."""
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Use:
    """Puts stand-ins in place of a command's figures or sections; returns the command."""

    def put(package: str, *parts: Figure | Section) -> Callable[[list[str]], int]:
        for module in ("command", "options"):
            monkeypatch.setattr(f"shlight_tools.{package}.{module}.{PARTS[package]}", list(parts))
        return MAIN[package]

    return put


MAIN: dict[str, Callable[[list[str]], int]] = {"charts": charts.main, "bench": bench.main}
PARTS = {"charts": "FIGURES", "bench": "SECTIONS"}


def draw_dots(run: Run) -> Drawn:
    run.step(0.5, "dots")
    picture = style.canvas(2, 1)
    picture.subplots().plot([1, 2], [3, 4])
    run.save(picture, f"dots_{'quick' if run.quick else 'full'}", "two <dots>")
    run.csv("dots", ["x", "y"], [[1, 3], [2, 4]])
    return Drawn("Two dots & a line. Of 2 points.", [Table("Dots", ["x", "y"], [["1", "3"]])])


def measure_two(run: BenchRun) -> list[Row]:
    run.step(0.5, "two")
    first = Row(run.section, "first", 0.5, 0.5, 0.5, "×", bound=0.6)
    return [first, Row(run.section, "second", 7.0, 7.0, 7.0, "×")]


def in_vain(run: Run | BenchRun) -> list[Row]:
    if isinstance(run, Run):
        run.csv("vain", ["x"], [[1]])
    raise KeyboardInterrupt


def terminated(run: Run) -> Drawn:
    os.kill(os.getpid(), signal.SIGTERM)
    return in_vain(run)


DOTS, TWO = Figure("dots", "Dots", draw_dots), Section("two", "Two rows", measure_two)


def test_figures_and_their_page(tmp_path: Path, use: Use, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "new" / "folder"
    main = use("charts", DOTS, Figure("dots2", "More dots", lambda run: Drawn("More.")))
    assert main(["dots2", "--out", str(out)]) == 0
    assert main(["dots", "--out", str(out)]) == 0
    assert names(out) == ["dots.csv", "dots.json", "dots2.json", "dots_full.png", PAGE]
    assert names(tmp_path) == ["new"]
    assert (out / "dots.csv").read_text() == "x,y\n1,3\n2,4\n"
    assert (out / "dots_full.png").read_bytes().startswith(b"\x89PNG")
    page = (out / PAGE).read_text()
    for part in ("Two dots &amp; a line. Of 2 points.", 'src="dots_full.png"', "two &lt;dots&gt;", "<td>3</td>"):
        assert part in page
    assert 0 < page.index('<h2 id="dots">') < page.index('<h2 id="dots2">')
    said = capsys.readouterr().out
    assert said.splitlines().count("Dots") == 2  # as it begins, and over its table
    assert "Dots\n\n| x | y |\n| --- | --- |\n| 1 | 3 |\n" in said
    assert f"results: {out / PAGE}\n" in said
    assert main(["dots", "--quick", "--out", str(out)]) == 0
    assert names(out) == ["dots.csv", "dots.json", "dots2.json", "dots_quick.png", PAGE]  # and no dots_full.png


def test_a_bench_and_one_against_it(tmp_path: Path, use: Use, capsys: pytest.CaptureFixture[str]) -> None:
    main = use("bench", TWO)
    first, second = tmp_path / "new" / "1.json", tmp_path / "new" / "2.json"
    assert main(["--quick", "--out", str(first)]) == 0
    found = read(first)
    assert [row.name for row in found.rows] == ["first", "second"]
    assert found.settings == {"lights": QUICK_LIGHTS, "rounds": QUICK_ROUNDS}
    assert found.machine["instruction set"] == _core.kernel_target()
    said = capsys.readouterr().out
    assert said.splitlines().count("Two rows") == 2
    assert "Two rows\n\n|" in said
    assert "1 of 1 bounds are met\n" in said
    assert said.endswith(f"results: {first}\n")

    first.write_text(first.read_text().replace("7.0", "3.5"))
    assert main(["--out", str(second), "--compare", str(first)]) == 0
    assert main(["--read", str(second), "--compare", str(first)]) == 0
    assert capsys.readouterr().out.count("1 of 2 rows changed") == 2
    assert names(first.parent) == ["1.json", "2.json"]


def test_an_interrupt_leaves_what_is_whole(tmp_path: Path, use: Use, capsys: pytest.CaptureFixture[str]) -> None:
    before = signal.getsignal(signal.SIGTERM)
    for draw, code in ((in_vain, 130), (terminated, 143)):
        assert use("charts", DOTS, Figure("vain", "In vain", draw))(["--out", str(tmp_path)]) == code
        assert names(tmp_path) == ["dots.csv", "dots.json", "dots_full.png", PAGE]
    assert capsys.readouterr().err == "./dev charts: interrupted; the figure that was being drawn left nothing\n"
    assert signal.getsignal(signal.SIGTERM) is before
    out = tmp_path / "dots.csv"
    assert use("bench", TWO, Section("vain", "In vain", in_vain))(["--out", str(out)]) == 130
    assert (len(names(tmp_path)), out.read_text()) == (4, "x,y\n1,3\n2,4\n")
    assert capsys.readouterr().err == "./dev bench: interrupted; nothing was written\n"


@pytest.mark.parametrize(
    ("command", "arguments", "complaint"),
    [
        ("charts", ["growth", "grow"], f"there is no figure 'grow'; there are: {', '.join(f.name for f in FIGURES)}\n"),
        ("charts", ["--out", "/dev/null/charts"], "/dev/null is a file; --out wants a folder\n"),
        ("charts", ["--out", "/proc/charts"], "cannot write to /proc/charts: "),
        ("bench", ["bases"], "there is no section 'bases'; there are: basis, "),
        ("bench", ["--compare", "/nowhere/b.json"], "cannot read /nowhere/b.json: No such file or directory\n"),
        ("bench", ["--against", "/nowhere"], "there is no built package shlight in /nowhere\n"),
        ("bench", ["--out", "/"], "/ is a folder; --out wants a file\n"),
        ("bench", ["--out", "/dev/null/a.json"], "/dev/null is a file; --out wants a folder\n"),
    ],
)
def test_bad_requests_are_named(
    command: str, arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert MAIN[command](arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"./dev {command}: {complaint}")
    assert said.err.count("\n") == 1


@pytest.mark.parametrize(("command", "module"), [("charts", "matplotlib"), ("bench", "sphericart")])
def test_a_missing_module_is_named_and_the_list_needs_none(
    command: str, module: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert MAIN[command]([]) == 1
    expected = f"./dev {command}: the Python module {module} is missing: pip install {module}\n"
    assert capsys.readouterr().err == expected
    work = f"sys.argv[1:] = ['--list']; runpy.run_module('shlight_tools.{command}', run_name='__main__')"
    code = f"import runpy, sys; sys.modules['{module}'] = None; {work}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    parts = FIGURES if command == "charts" else SECTIONS
    assert [line.split()[0] for line in done.stdout.splitlines()] == [part.name for part in parts]


NOT_A_NUMBER = Bench({}, {}, [Row("basis", "a", 1.0, 1.0, 1.0, "×")]).to_json().replace("1.0", "NaN")


@pytest.mark.parametrize("content", ["", "[]", '{"format": 1}', NOT_A_NUMBER])
def test_what_is_no_bench_is_refused(content: str, tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text(content)
    with pytest.raises(CommandError, match=r"other\.json is not a file that \./dev bench wrote"):
        read(file)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_on_a_terminal_and_plain_lines_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    terminal, file = Terminal(), io.StringIO()
    for stream in (terminal, file):
        progress = Progress(2, stream)
        progress.begin("Dots")
        progress.step(0.5, "some dots of a long name that does not fit on the line at all")
        progress.end()
    bar, last = terminal.getvalue().removeprefix("\r\033[K").split("\r\033[K")
    assert bar.startswith("[############............] ")
    assert len(bar) <= 59
    assert last.startswith("1/2 Dots: ")
    assert file.getvalue().startswith("1/2 Dots\n    ")
    assert "\r" not in file.getvalue()
