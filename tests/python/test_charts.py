# SPDX-License-Identifier: MIT
"""The command `shlight charts`."""

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
from command_cases import names, putter

from shlight.charts import command, figures, options, style
from shlight.charts.figure import Drawn, Figure, Run, Table
from shlight.charts.page import PAGE
from shlight.progress import Progress


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


def test_a_figure_drawn_anew_leaves_no_old_file(tmp_path: Path, use: Callable[..., None]) -> None:
    use(DOTS)
    assert command.main(["--out", str(tmp_path)]) == 0
    assert command.main(["--out", str(tmp_path), "--quick"]) == 0
    assert names(tmp_path) == ["dots.csv", "dots.json", "dots_quick.png", PAGE]
    assert "dots_full" not in (tmp_path / PAGE).read_text()


def test_figures_drawn_at_different_times_share_the_page(tmp_path: Path, use: Callable[..., None]) -> None:
    second = Figure("dots2", "More dots", lambda run: Drawn("More."))
    use(DOTS, second)
    assert command.main(["dots2", "--out", str(tmp_path)]) == 0
    assert command.main(["dots", "--out", str(tmp_path)]) == 0
    page = (tmp_path / PAGE).read_text()
    assert 0 < page.index('<h2 id="dots">') < page.index('<h2 id="dots2">')


def test_an_interrupt_leaves_whole_figures_only(
    tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    use(DOTS, VAIN)
    assert command.main(["--out", str(tmp_path)]) == 130
    assert names(tmp_path) == ["dots.csv", "dots.json", "dots_full.png", PAGE]
    assert capsys.readouterr().err == ("shlight charts: interrupted; the figure that was being drawn left nothing\n")


def test_a_request_to_end_is_an_interrupt(tmp_path: Path, use: Callable[..., None]) -> None:
    def end(run: Run) -> Drawn:
        run.csv("end", ["x"], [])
        os.kill(os.getpid(), signal.SIGTERM)
        return Drawn("")

    use(Figure("end", "The end", end))
    before = signal.getsignal(signal.SIGTERM)
    assert command.main(["--out", str(tmp_path)]) == 143
    assert names(tmp_path) == []
    assert signal.getsignal(signal.SIGTERM) is before


def test_ctrl_c_while_measuring(tmp_path: Path) -> None:
    code = "import sys; from shlight.charts.command import main; sys.exit(main(sys.argv[1:]))"
    with subprocess.Popen(
        [sys.executable, "-c", code, "stability", "--out", str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "1/1 Where methods fail\n"
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert err == "shlight charts: interrupted; the figure that was being drawn left nothing\n"
    assert names(tmp_path) == []


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(["--list"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert listed == [figure.name for figure in figures.FIGURES]
    assert len(set(listed)) == len(listed)
    assert {"speed_error", "stability", "growth"} <= set(listed)


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = command.main(arguments)
    said = capsys.readouterr()
    assert said.out == ""
    return code, said.err


def test_an_unknown_figure_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    code, err = complaint(["growth", "grow"], capsys)
    assert code == 2
    known = ", ".join(figure.name for figure in figures.FIGURES)
    assert err == f"shlight charts: there is no figure 'grow'; there are: {known}\n"


def test_a_file_is_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.touch()
    code, err = complaint(["--out", str(file / "charts")], capsys)
    assert (code, err) == (2, f"shlight charts: {file} is a file; --out wants a folder\n")


def test_a_folder_that_takes_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    code, err = complaint(["--out", "/proc/charts"], capsys)
    assert code == 2
    assert err.startswith("shlight charts: cannot write to /proc/charts: ")


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    code, err = complaint([], capsys)
    assert code == 1
    assert err == "shlight charts: the Python module matplotlib is missing: pip install 'shlight[charts]'\n"


def test_nothing_needs_matplotlib_before_it_draws() -> None:
    code = "import sys; sys.modules['matplotlib'] = None; from shlight.charts.command import main; main(['--list'])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "growth" in done.stdout


def test_a_picture_must_belong_to_its_figure(tmp_path: Path) -> None:
    run = Run("dots", tmp_path, quick=True)
    for name in ("other", "dots/../other", "/dots"):
        with pytest.raises(ValueError, match=r"^name must begin with 'dots' and be no path"):
            run.csv(name, ["x"], [])
    assert names(tmp_path) == []


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    stream = Terminal()
    progress = Progress(2, stream)
    progress.begin("Dots")
    progress.step(0.5, "some dots of a long name that does not fit on the line at all")
    progress.end()
    bar, last = stream.getvalue().removeprefix("\r\033[K").split("\r\033[K")
    assert bar.startswith("[############............] ")
    assert len(bar) <= 59
    assert last.startswith("1/2 Dots: ")
    assert last.endswith(" s\n")


def test_plain_lines_elsewhere() -> None:
    stream = io.StringIO()
    progress = Progress(2, stream)
    progress.begin("Dots")
    progress.step(0.5, "some dots")
    progress.end()
    first, second = stream.getvalue().splitlines()
    assert first == "1/2 Dots"
    assert second.endswith(" s")
    assert "\r" not in stream.getvalue()


@pytest.mark.slow
def test_all_figures_quickly(tmp_path: Path) -> None:
    assert command.main(["--quick", "--out", str(tmp_path)]) == 0
    page = (tmp_path / PAGE).read_text()
    for figure in figures.FIGURES:
        assert f'<h2 id="{figure.name}">' in page
    assert all((tmp_path / name).is_file() for name in names(tmp_path) if name in page)
