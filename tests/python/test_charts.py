# SPDX-License-Identifier: MIT
"""The command `shlight charts` and what its figures measure with."""

from __future__ import annotations

import csv
import importlib.util
import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from shlight import methods
from shlight.charts import command, figures, fused, growth, measure, options, speed_error, stability, style
from shlight.charts.figure import Drawn, Figure, Run, Table
from shlight.charts.lights import CLASSES, LightClass, Lights, spheres, squares
from shlight.charts.page import PAGE
from shlight.progress import Progress

# --- the command -------------------------------------------------------------------------------------------------


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

    def put(*others: Figure) -> None:
        for module in (command, options):
            monkeypatch.setattr(module, "FIGURES", list(others))

    return put


DOTS = Figure("dots", "Dots", draw_dots)
VAIN = Figure("vain", "In vain", draw_in_vain)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


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


# --- lights ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("light_class", CLASSES, ids=lambda c: c.name)
def test_lights_of_a_class(light_class: LightClass) -> None:
    lights = light_class.lights(3, 40)
    assert len(lights) == 40
    for array, again in zip(lights.arrays, light_class.lights(3, 40).arrays, strict=True):
        np.testing.assert_array_equal(array, again)
        np.testing.assert_array_equal(array, array.astype(np.float32))  # both precisions hold them
    kept = lights.coefficients("exact", 1, np.float64)[:, 0]
    whole = lights.coefficients("exact", 1, np.float64, clip=False)[:, 0]
    assert (kept > 0).all()
    cut = kept < whole * (1 - 1e-9)
    assert cut.mean() >= 0.6 if "clipped" in light_class.name else not cut.any()
    assert (whole.max() < 0.01) == ("small" in light_class.name)
    measure.truth(lights.take(slice(0, 4)), 2)  # takes only what is planar
    if light_class.kind == "polygon":
        np.testing.assert_array_equal(*in_one_plane(lights, (0, 1, 3, 2)))


def in_one_plane(lights: Lights, order: tuple[int, int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Two sides that are equal if the corners lie exactly in one plane."""
    first, second, third, fourth = (lights.arrays[0][:, i] for i in order)
    return second - first, fourth - third


def test_elevation_and_half_angle_of_a_sphere() -> None:
    lights = spheres(np.array([0.3, -1.0]), np.array([0.2, 1e-4]), 0.6)
    centers, radii = lights.arrays
    np.testing.assert_allclose(np.arcsin(centers[:, 2]), [0.3, -1.0], atol=1e-6)
    np.testing.assert_allclose(np.arctan2(centers[:, 1], centers[:, 0]), 0.6, atol=1e-6)
    np.testing.assert_allclose(np.arcsin(radii), [0.2, 1e-4], rtol=1e-6)


@pytest.mark.parametrize("half", [1e-4, 0.1, 1.4])
@pytest.mark.parametrize("beyond", [-1e-7, 1e-7, 0.1])
def test_edges_of_a_square_near_the_horizon(half: float, beyond: float) -> None:
    upper, lower = squares(np.array([beyond - half, beyond + half]), half, 0.6).arrays[0]
    for corners, near in ((upper, slice(2, 4)), (lower, slice(0, 2))):
        np.testing.assert_allclose(corners[near, 2], np.sin(beyond) / np.cos(half), rtol=1e-6)
    for corners in (upper, lower):
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=-1)
        np.testing.assert_allclose(sides, 2 * np.tan(half), rtol=0.01)


def test_squares_are_plane() -> None:
    rng = np.random.default_rng(4)
    half = 1e-4 * 1.4e4 ** rng.random(300)
    lights = squares(rng.uniform(-1.5, 1.5, 300), half, rng.uniform(0, 6, 300))
    np.testing.assert_array_equal(*in_one_plane(lights, (0, 1, 3, 2)))


# --- measurements ------------------------------------------------------------------------------------------------


def dummy(**changes: object) -> SimpleNamespace:
    known = {
        "name": "dummy",
        "largest_order": 8,
        "adaptive": False,
        "random": False,
        "knows_caps": True,
        "knows_polygons": False,
    }
    return SimpleNamespace(**{**known, **changes})


@pytest.fixture
def register(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Registers further methods; all of them give 1.001 times what "exact" gives."""
    real_methods, real = methods.coefficient_methods(), Lights.coefficients

    def coefficients(self: Lights, method: str, *arguments: object, **named: object) -> object:
        if method in real_methods:
            return real(self, method, *arguments, **named)
        known = {key: value for key, value in named.items() if key not in ("samples", "tolerance")}
        return real(self, "exact", *arguments, **known) * 1.001

    def add(*others: SimpleNamespace) -> None:
        all_methods = real_methods | {other.name: other for other in others}
        monkeypatch.setattr(methods, "coefficient_methods", lambda: all_methods)
        monkeypatch.setattr(Lights, "coefficients", coefficients)

    return add


def test_a_new_method_appears_by_itself(register: Callable[..., None]) -> None:
    register(dummy(), dummy(name="other", random=True), dummy(name="third", adaptive=True))
    found = {series.label: series for series in measure.all_series("sphere")}
    assert next(iter(found)) == "exact"
    assert "reference" not in found
    new = [label for label, series in found.items() if series.method in ("dummy", "other", "third")]
    assert new == ["dummy", "other, 64 samples", "other, 1024 samples", "third", "third to 0.001"]
    looks = {(series.color, series.marker) for series in found.values()}
    assert len(looks) == len({series.method for series in found.values()})
    assert [s.label for s in measure.main_series("sphere") if s.label in new] == [
        "dummy",
        "other, 1024 samples",
        "third",
    ]
    assert "dummy" not in {series.label for series in measure.all_series("polygon")}


def test_errors_by_hand() -> None:
    true = np.array([[2.0, 0.0, 1.0, 0.0, 9.0], [1e-3, 0.0, 0.0, 0.0, 9.0], [1.0, 0.0, 0.0, 0.0, 9.0]])
    values = np.array([[2.0, 0.1, 1.0, 0.0], [1e-3, 0.0, 2e-3, 0.0], [1.0, np.nan, 0.0, 5.0]], dtype=np.float32)
    np.testing.assert_allclose(measure.relative_errors(values, true), [0.05, 2, np.inf], rtol=1e-6)
    np.testing.assert_allclose(measure.relative_errors(values, true, 0.1), [0.05, 0.02, np.inf], rtol=1e-6)


def test_the_truth_is_that_of_the_lights() -> None:
    lights = CLASSES[1].lights(5, 12)
    true = measure.truth(lights, 6)
    assert measure.relative_errors(lights.coefficients("exact", 6, np.float64), true).max() <= 1e-13
    lower = measure.truth(lights, 3)
    np.testing.assert_allclose(true[:, :9], lower, rtol=0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 2, 7])
@pytest.mark.parametrize("light_class", [CLASSES[1], CLASSES[3]], ids=lambda c: c.name)
def test_errors_of_fused_calls(order: int, light_class: LightClass) -> None:
    (series,) = fused.fused_series("float32")
    lights = light_class.lights(5, 12)
    true = measure.truth(lights, order)
    values = series.coefficients(lights, order, np.float32)
    assert values.shape == (12, 1)
    assert series.errors(values, true).max() <= 3e-6
    np.testing.assert_allclose(series.errors(values + true[:, :1], true), 1, atol=1e-5)
    assert np.isinf(series.errors(values * np.nan, true)).all()
    assert fused.fused_series("float64") == []


def test_the_exponent_of_growth() -> None:
    orders = [2, 4, 8, 16, 32, 64]
    seconds = [5.0, 5.0, *(1e-6 * n**1.7 for n in orders[2:5]), np.nan]
    assert measure.exponent(orders, seconds) == pytest.approx(1.7, abs=1e-9)
    assert np.isnan(measure.exponent([2, 4, 8], [1.0, 2.0, 3.0]))


def test_times_stop_at_the_largest_order(register: Callable[..., None]) -> None:
    register(dummy())
    lights = CLASSES[0].lights(1, 8)
    both = [series for series in measure.all_series("sphere") if series.label in ("exact", "dummy")]
    library, other = measure.best_seconds(both, lights, 9, "float32", rounds=1, budget=1e-4)
    assert library > 0
    assert np.isnan(other)


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def drawn(
    figure: str, draw: Callable[[Run], Drawn], folder: Path, numbers: str = ""
) -> tuple[Drawn, list[dict[str, str]], list[float]]:
    """The figure, the rows of its CSV, and the shares that it reported."""
    shares: list[float] = []
    run = Run(figure, folder, quick=True, report=lambda share, _: shares.append(share))
    with style.look():
        result = draw(run)
    return result, rows_of(folder / f"{numbers or figure}.csv"), shares


def increasing(shares: Iterable[float]) -> bool:
    listed = list(shares)
    return listed == sorted(listed) and listed[0] >= 0 and listed[-1] <= 1


@pytest.fixture
def only_exact_and_dummy(register: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    register(dummy())
    for module in (growth, speed_error, stability):
        for name in ("all_series", "main_series"):
            if hasattr(module, name):
                few = [series for series in measure.all_series("sphere") if series.label in ("exact", "dummy")]
                monkeypatch.setattr(module, name, lambda kind, few=few: few)


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_growth_draws_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "SHOWN", ("sphere_whole", "sphere_clipped"))
    result, rows, shares = drawn("growth", growth.draw, tmp_path)
    assert (tmp_path / "growth.png").is_file()
    assert increasing(shares)
    reached = {name: max(int(row["order"]) for row in rows if row["method"] == name) for name in ("exact", "dummy")}
    assert reached == {"exact": 64, "dummy": 8}
    fused = [row for row in rows if "Eq. 5" in row["method"]]
    assert {row["precision"] for row in fused} == {"float32"}
    assert {(row["lights"], row["method"]) for row in fused} == {
        ("sphere_whole", "exact, with Eq. 5"),
        ("sphere_clipped", "exact, with Eq. 5"),
        ("sphere_clipped", "glossy lobe, with Eq. 5"),
    }
    assert all(float(row["microseconds"]) > 0 for row in rows)
    cells = {(row[0], row[1], row[2]): row[3] for row in result.tables[0].rows}
    assert 0 < float(cells["sphere_clipped", "float32", "exact"]) < 4


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_speed_and_error_of_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed_error, "CLASSES", CLASSES[1:2])
    monkeypatch.setattr(speed_error, "QUICK_ORDERS", (1, 2, 8, 16))
    result, rows, shares = drawn("speed_error", speed_error.draw, tmp_path)
    assert increasing(shares)
    for precision, floor in (("float32", 3e-6), ("float64", 1e-13)):
        assert (tmp_path / f"speed_error_sphere_clipped_{precision}.png").is_file()
        own = [row for row in rows if row["precision"] == precision]
        for row in own:
            error = float(row["worst_error"])
            assert float(row["median_error"]) <= error
            assert error <= floor if row["method"].startswith("exact") else 1e-3 <= error <= 1.1e-2
        assert {row["order"] for row in own if row["method"] == "dummy"} == {"1", "2", "8"}
    ratios = result.tables[0].rows
    assert [row[:3] for row in ratios] == [["sphere_clipped", p, "dummy"] for p in ("float32", "float64")]
    assert all(float(cell) > 0 for row in ratios for cell in row[3:6])
    assert ratios[0][6] == ""


@pytest.mark.usefixtures("only_exact_and_dummy")
def test_a_map_of_what_is_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "REGIONS", stability.REGIONS[:2])
    monkeypatch.setattr(stability, "KINDS", {"sphere": "spheres"})
    result, rows, shares = drawn("stability", stability.draw, tmp_path, "stability_sphere_map_8")
    assert increasing(shares)
    assert [name for name in names(tmp_path) if "map" in name] == [
        f"stability_sphere_map_{order}.{kind}" for order in (16, 8) for kind in ("csv", "png")
    ]
    assert (tmp_path / "stability_sphere_horizon_16.png").is_file()
    for row in rows:
        hidden = np.radians(float(row["elevation [°]"])) < -float(row["half angle [rad]"])
        for method, least, most in (("exact", 0, 3e-6), ("dummy", 1e-6, 1.1e-2)):
            error = row[f"{method}, float32"]
            assert error == "hidden" if hidden else least <= float(error) <= most
    table = {row[2]: row[3:] for row in result.tables[0].rows if row[1] == "all lights"}
    assert all(cell.endswith(" · 0.0 % · 0.0 %") for cell in table["exact"])
    assert [bool(cell) for cell in table["dummy"]] == [True, False, True, False]
    worst, over, broken = table["dummy"][0].split(" · ")
    assert 1e-3 <= float(worst) <= 1.1e-2
    assert float(over.removesuffix(" %")) >= 90
    assert broken == "0.0 %"


def made_map(errors: list[list[float]]) -> stability.Map:
    series = measure.all_series("sphere")[0]
    return stability.Map("sphere", stability.REGIONS[0], 8, "float32", series, np.array(errors))


def test_shares_of_a_map_by_hand() -> None:
    unknown, covered = stability.UNKNOWN, stability.COVERED
    of = made_map([[1e-6, unknown, 0.5], [covered, np.inf, 1e-4]])
    assert of.worst() == 0.5
    assert of.share_over_limit() == 0.5  # what is not finite is above any limit
    assert of.share_not_finite() == 0.25


def test_a_coarse_map_fills_its_picture() -> None:
    unknown = stability.UNKNOWN
    of = made_map([[1, unknown, 2], [unknown] * 3, [3, unknown, 4], [unknown] * 3])
    np.testing.assert_array_equal(stability._filled(of.errors), [[1, 1, 2], [1, 1, 2], [3, 3, 4], [3, 3, 4]])


def test_a_slow_method_has_a_coarse_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "batch_size", lambda *_: 20)
    region = replace(stability.REGIONS[0], title="some lights")
    monkeypatch.setattr(stability, "main_series", lambda kind: measure.all_series(kind)[:1])
    for of in stability._measure(Run("stability", Path(), quick=True), "sphere", region, lambda *_: None):
        rows, columns = (np.flatnonzero(~np.isnan(of.errors).all(axis=axis)) for axis in (1, 0))
        np.testing.assert_array_equal(rows, [0, 3, 6])
        np.testing.assert_array_equal(columns, [0, 3, 6, 9, 12])


@pytest.mark.slow
def test_all_figures_quickly(tmp_path: Path) -> None:
    assert command.main(["--quick", "--out", str(tmp_path)]) == 0
    page = (tmp_path / PAGE).read_text()
    for figure in figures.FIGURES:
        assert f'<h2 id="{figure.name}">' in page
    assert all((tmp_path / name).is_file() for name in names(tmp_path) if name in page)
