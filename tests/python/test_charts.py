# SPDX-License-Identifier: MIT
"""The command `shlight charts`: what it draws, prints, writes and refuses."""

from __future__ import annotations

import csv
import importlib.util
import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from command_cases import names, putter

from shlight.charts import (
    command,
    figures,
    growth,
    measure,
    options,
    order_error,
    pictures,
    speed_error,
    stability,
    style,
    which_method,
)
from shlight.charts.figure import Drawn, Figure, Run, Table
from shlight.charts.lights import CLASSES
from shlight.charts.page import PAGE
from shlight.progress import Progress

# --- the real figures, small --------------------------------------------------------------------------------------


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (growth, speed_error, stability):
        for name in ("all_series", "main_series"):
            if hasattr(module, name):
                monkeypatch.setattr(module, name, lambda kind: measure.all_series(kind)[:2])
    monkeypatch.setattr(growth, "SHOWN", ("sphere_whole", "sphere_clipped"))
    monkeypatch.setattr(speed_error, "CLASSES", CLASSES[1:2])
    monkeypatch.setattr(speed_error, "QUICK_ORDERS", (1, 8))
    monkeypatch.setattr(stability, "REGIONS", stability.REGIONS[:1])
    monkeypatch.setattr(stability, "KINDS", {"sphere": "spheres"})
    monkeypatch.setattr(order_error, "ROUGHNESSES", [0.3])
    monkeypatch.setattr(which_method, "VIEWS", (0.5,))
    monkeypatch.setattr(which_method, "QUICK", which_method.Grid((0.02, 1.0), (0.3, 0.9), 6))
    quick = replace(pictures.QUICK, width=24, height=15, half_samples=8, most_samples=8, rays=((1, 1),))
    monkeypatch.setattr(pictures, "QUICK", quick)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("figure", figures.FIGURES, ids=lambda figure: figure.name)
def test_a_small_drawing_of_each_figure(figure: Figure, tmp_path: Path) -> None:
    shares: list[float] = []
    run = Run(figure.name, tmp_path, quick=True, report=lambda share, _: shares.append(share))
    with style.look():
        drawn = figure.draw(run)
    assert shares == sorted(shares)
    assert 0 <= shares[0] <= shares[-1] <= 1
    assert all(table.rows for table in drawn.tables)
    assert {Path(name).suffix for name in names(tmp_path)} == {".csv", ".png"}
    for path in tmp_path.glob("*.csv"):
        with path.open(newline="") as stream:
            for row in csv.DictReader(stream):
                assert float(row.get("microseconds") or row.get("seconds") or 1) > 0
                if row.get("method", "").startswith("exact") and "worst_error" in row:
                    assert float(row["worst_error"]) <= (3e-6 if row["precision"] == "float32" else 1e-13)
                if figure.name == "which_method":
                    assert float(row["rms_error"]) <= float(row["tolerance"])


# --- the command, with stand-ins for figures ----------------------------------------------------------------------


def draw_dots(run: Run) -> Drawn:
    run.step(0.5, "dots")
    picture = style.canvas(2, 1)
    picture.subplots().plot([1, 2], [3, 4])
    run.save(picture, f"dots_{'quick' if run.quick else 'full'}", "two <dots>")
    run.csv("dots", ["x", "y"], [[1, 3], [2, 4]])
    return Drawn("Two dots & a line. Of 2 points.", [Table("Dots", ["x", "y"], [["1", "3"]])])


def draw_in_vain(run: Run) -> Drawn:
    run.csv("vain", ["x"], [[1]])
    raise KeyboardInterrupt


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Puts other figures in place of the real ones."""
    return putter(monkeypatch, "FIGURES", command, options)


DOTS = Figure("dots", "Dots", draw_dots)
VAIN = Figure("vain", "In vain", draw_in_vain)


def test_a_figure_and_its_page(tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]) -> None:
    use(DOTS)
    out = tmp_path / "new" / "folder"
    assert command.main(["--out", str(out)]) == 0
    assert names(out) == ["dots.csv", "dots.json", "dots_full.png", PAGE]
    assert names(tmp_path) == ["new"]
    assert (out / "dots.csv").read_text() == "x,y\n1,3\n2,4\n"
    assert (out / "dots_full.png").read_bytes().startswith(b"\x89PNG")
    page = (out / PAGE).read_text()
    for part in ("Two dots &amp; a line. Of 2 points.", 'src="dots_full.png"', "two &lt;dots&gt;", "<td>3</td>"):
        assert part in page
    said = capsys.readouterr().out
    assert "1/1 Dots\n" in said
    assert "Dots\n\n| x | y |\n| --- | --- |\n| 1 | 3 |\n" in said
    assert f"results: {out / PAGE}\n" in said


def test_figures_drawn_at_different_times_share_the_page(tmp_path: Path, use: Callable[..., None]) -> None:
    use(DOTS, Figure("dots2", "More dots", lambda run: Drawn("More.")))
    for arguments in (["dots2"], ["dots"], ["dots", "--quick"]):
        assert command.main([*arguments, "--out", str(tmp_path)]) == 0
    page = (tmp_path / PAGE).read_text()
    assert 0 < page.index('<h2 id="dots">') < page.index('<h2 id="dots2">')
    assert names(tmp_path) == ["dots.csv", "dots.json", "dots2.json", "dots_quick.png", PAGE]  # and no dots_full.png


def test_an_interrupt_leaves_whole_figures_only(
    tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    def end(run: Run) -> Drawn:
        run.csv("end", ["x"], [])
        os.kill(os.getpid(), signal.SIGTERM)
        return Drawn("")

    before = signal.getsignal(signal.SIGTERM)
    for last, code in ((VAIN, 130), (Figure("end", "The end", end), 143)):
        use(DOTS, last)
        assert command.main(["--out", str(tmp_path)]) == code
        assert names(tmp_path) == ["dots.csv", "dots.json", "dots_full.png", PAGE]
    assert capsys.readouterr().err == "shlight charts: interrupted; the figure that was being drawn left nothing\n"
    assert signal.getsignal(signal.SIGTERM) is before


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = command.main(arguments)
    said = capsys.readouterr()
    assert said.out == ""
    return code, said.err


def test_bad_requests_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    known = ", ".join(figure.name for figure in figures.FIGURES)
    assert complaint(["growth", "grow"], capsys) == (
        2,
        f"shlight charts: there is no figure 'grow'; there are: {known}\n",
    )
    file = tmp_path / "file"
    file.touch()
    assert complaint(["--out", str(file / "charts")], capsys) == (
        2,
        f"shlight charts: {file} is a file; --out wants a folder\n",
    )
    code, err = complaint(["--out", "/proc/charts"], capsys)
    assert code == 2
    assert err.startswith("shlight charts: cannot write to /proc/charts: ")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    missing = "shlight charts: the Python module matplotlib is missing: pip install 'shlight[charts]'\n"
    assert complaint([], capsys) == (1, missing)


def test_the_list_needs_no_matplotlib() -> None:
    code = "import sys; sys.modules['matplotlib'] = None; from shlight.charts.command import main; main(['--list'])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert [line.split()[0] for line in done.stdout.splitlines()] == [figure.name for figure in figures.FIGURES]


def test_a_picture_must_belong_to_its_figure(tmp_path: Path) -> None:
    run = Run("dots", tmp_path, quick=True)
    for name in ("other", "dots/../other", "/dots"):
        with pytest.raises(ValueError, match=r"^name must begin with 'dots' and be no path"):
            run.csv(name, ["x"], [])
    assert names(tmp_path) == []


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
