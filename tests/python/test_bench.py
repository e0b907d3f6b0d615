# SPDX-License-Identifier: MIT
"""What `shlight bench` measures with, prints, writes and refuses; no test depends on how fast anything is."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_cases import names, putter

import shlight
from shlight import _core
from shlight.bench import builds, calls, command, compare, inputs, options, peer, sections
from shlight.bench.rounds import Spread, Work, alternate
from shlight.bench.row import Bench, Row, read
from shlight.bench.run import Run, Section
from shlight.commands import CommandError


class Clock:
    """Time passes only in works."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now

    def work(self, seconds: list[float], count: int = 1) -> Work:
        """Takes these times, one turn after the other."""
        left = iter(seconds)

        def call() -> None:
            self.now += next(left)

        return Work(call, count)


def test_ratios_are_medians_of_turns_and_the_first_turn_is_not_measured() -> None:
    # The machine is ten times as slow in the second half; the ratio is 1/2 throughout but for one round.
    clock, shares = Clock(), list[float]()
    slow = [1.0] * 5 + [10.0] * 5
    works = {"a": clock.work([50, *(s / 2 for s in slow[1:])]), "b": clock.work([*slow[:3], 4.0, *slow[4:]])}
    seconds = alternate(works, 9, clock, lambda share, name: shares.append(share))
    assert shares == sorted(shares)
    row = Run("basis", 1, 9).ratio(seconds, "a", "b", unit="× b", bound=0.6)
    assert (row.value, row.low, row.high, row.met, row.detail) == (0.5, 0.5, 0.5, True, "5 s ÷ 10 s")
    assert Spread.of(np.array([9.0, 1, 3, 2, 100])) == Spread(3, 2, 9)
    np.testing.assert_allclose(alternate({"c": clock.work([9, 1, 2], 2)}, 2, clock)["c"], [0.5, 1])  # of one light


def made(value: float, name: str = "a", spread: float = 0.0, **more: object) -> Row:
    return replace(Row("basis", name, value, value - spread, value + spread, "×"), **more)


@pytest.mark.parametrize(
    ("bound", "bound_is", "met"),
    [(None, "most", None), (2.0, "most", True), (1.9, "most", False), (2.0, "least", True), (2.1, "least", False)],
)
def test_bounds(bound: float | None, bound_is: str, met: bool | None) -> None:
    assert made(2.0, bound=bound, bound_is=bound_is).met is met


def bench_of(*rows: Row, **machine: str) -> Bench:
    return Bench({"processor": "x", **machine}, {"lights": 10, "rounds": 9}, list(rows))


def test_changes_beyond_the_spread_are_flagged() -> None:
    old = bench_of(made(1.0, "noisy", 0.2), made(1.0, "better", 0.01), made(2.0, "worse", 0.01), made(1.0, "trifle"),
                   made(1.5, "scaling", 0.01, bound_is="least"), made(3.0, "gone"))  # fmt: skip
    new = bench_of(made(1.3, "noisy", 0.2), made(0.8, "better", 0.01), made(3.0, "worse", 0.01), made(1.01, "trifle"),
                   made(1.9, "scaling", 0.01, bound_is="least"), made(3.0, "new"), processor="y")  # fmt: skip
    found = compare.changes(new, old)
    flags = {change.new.name: (change.beyond_spread, compare._flag(change)) for change in found}
    assert flags == {
        "noisy": (False, ""),
        "better": (True, "better"),
        "worse": (True, "WORSE"),
        "trifle": (False, ""),
        "scaling": (True, "better"),
    }
    text = compare.comparison(new, old)
    assert text.startswith("not the same processor: y now, x before\n")
    assert "3 of 5 rows changed" in text


def test_lights_are_what_their_names_say() -> None:
    for kind, cut in (("clipped", 1.0), ("whole", 0.0), ("mixed", 0.25)):
        lights = inputs.spheres(kind, 400)
        assert lights.centers.dtype == lights.radii.dtype == np.float32
        height, radii = lights.centers[:, 2], lights.radii
        assert (height > -radii).all()
        assert np.mean(height < radii) == cut
    heights = inputs.quads(401)[..., 2]
    np.testing.assert_array_equal((heights < 0).any(axis=1), np.arange(401) % 2 == 0)
    assert (heights > 0).any(axis=1).all()


# --- sections ----------------------------------------------------------------------------------------------------


@pytest.fixture
def own_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    """The library's own basis in place of sphericart's, which the tests do not need."""
    monkeypatch.setattr(peer, "basis", lambda points, order: calls.work("basis", len(points), order))
    monkeypatch.setattr(peer, "check_installed", lambda: None)


@pytest.mark.usefixtures("own_peer")
def test_a_small_run_of_all_sections(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Run, "size", lambda self, usual: (4, 3))
    for section in sections.SECTIONS:
        shares: list[float] = []
        rows = section.measure(Run(section.name, 12, 1, lambda share, text, shares=shares: shares.append(share)))
        assert shares == sorted(shares)
        assert 0 <= shares[0] <= shares[-1] <= 1
        assert rows
        assert len({row.name for row in rows}) == len(rows)
        for row in rows:
            assert row.section == section.name
            assert row.low <= row.value <= row.high
        Bench({}, {}, rows).to_json()  # which knows finite numbers only


def test_planted_times_give_their_ratios(own_peer: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def planted(self: Run, works: dict[str, Work], part: object = None, clock: object = None) -> dict[str, np.ndarray]:
        known = {"sphericart": 4.0, "clipped sphere": 1.0, "cap, 2": 1.5, "10 spheres": 2.0}
        order = {name: int(name.rpartition("n = ")[2]) if "n = " in name else 1 for name in works}
        return {name: np.full(self.rounds, known.get(name, 3.0) * order[name] ** 1.5) for name in works}

    monkeypatch.setattr(Run, "alternate", planted)
    found = {}
    for section in ("spheres", "growth", "threads", "many"):
        (measure,) = (known.measure for known in sections.SECTIONS if known.name == section)
        found |= {(section, row.name): row for row in measure(Run(section, 12, 9))}
    assert found["spheres", "clipped sphere, n = 32"].value == 0.25
    assert found["spheres", "clipped sphere, Lambert, n = 8"].met is False
    assert found["growth", "clipped sphere, n = 16 … 64"].value == pytest.approx(1.5)
    assert found["threads", "cap, n = 8"].value == 2.0
    assert found["threads", "quad, n = 8"].met is False
    assert found["many", "1000 spheres"].value == 1.5


def test_two_builds_make_the_same_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(builds, "SECONDS", 0.0)
    own = Path(shlight.__file__).parents[1]
    rows = builds.measure(own, Run("basis", 10, 2))
    assert [row.name for row in rows] == list(sections.works(Run("basis", 10, 2)))
    assert all(row.value > 0 and row.bound == builds.MOST for row in rows)


# --- the command, with stand-ins for sections ---------------------------------------------------------------------


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


def test_a_run_and_one_against_it(tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]) -> None:
    use(TWO)
    first, second = tmp_path / "new" / "1.json", tmp_path / "new" / "2.json"
    assert command.main(["--quick", "--out", str(first)]) == 0
    bench = read(first)
    assert [row.name for row in bench.rows] == ["first", "second"]
    assert bench.settings == {"lights": options.QUICK_LIGHTS, "rounds": options.QUICK_ROUNDS}
    assert bench.machine["instruction set"] == _core.kernel_target()
    said = capsys.readouterr().out
    assert "1/1 Two rows\n" in said
    assert "Two rows\n\n|" in said
    assert "1 of 1 bounds are met\n" in said
    assert said.endswith(f"results: {first}\n")

    first.write_text(first.read_text().replace("7.0", "3.5"))
    assert command.main(["--out", str(second), "--compare", str(first)]) == 0
    assert command.main(["--read", str(second), "--compare", str(first)]) == 0
    assert capsys.readouterr().out.count("1 of 2 rows changed") == 2
    assert names(first.parent) == ["1.json", "2.json"]


def test_an_interrupt_leaves_the_file_before(
    tmp_path: Path, use: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    use(TWO, VAIN)
    out = tmp_path / "a.json"
    out.write_text("before")
    assert command.main(["--out", str(out)]) == 130
    assert (names(tmp_path), out.read_text()) == (["a.json"], "before")
    assert capsys.readouterr().err == "shlight bench: interrupted; nothing was written\n"


@pytest.mark.parametrize(
    "content", ["", "[]", '{"format": 1}', Bench({}, {}, [made(1.0)]).to_json().replace("1.0", "NaN")]
)
def test_other_files_are_refused(content: str, tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text(content)
    with pytest.raises(CommandError, match=r"other\.json is not a file that shlight bench wrote"):
        read(file)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["bases"], "there is no section 'bases'; there are: basis, "),
        (["--compare", "/nowhere/b.json"], "cannot read /nowhere/b.json: No such file or directory"),
        (["--against", "/nowhere"], "there is no built package shlight in /nowhere"),
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


def test_the_list_needs_no_peer() -> None:
    code = "import sys; sys.modules['sphericart'] = None; from shlight.bench.command import main; main(['--list'])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert [line.split()[0] for line in done.stdout.splitlines()] == [section.name for section in sections.SECTIONS]
