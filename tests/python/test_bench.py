# SPDX-License-Identifier: MIT
"""What `shlight bench` measures with and how; no test depends on how fast anything is."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shlight
from shlight import _core
from shlight.bench import (
    against_methods,
    against_peer,
    compare,
    growth,
    inputs,
    kinds,
    memory,
    peer,
    sections,
    table,
    targets,
    threads,
)
from shlight.bench.operations import OPERATIONS
from shlight.bench.rounds import Spread, Work, alternate
from shlight.bench.row import Bench, Row, read
from shlight.bench.run import Run, Section
from shlight.commands import CommandError

# --- rounds and rows ---------------------------------------------------------------------------------------------


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


def test_works_take_turns_and_the_first_is_not_measured() -> None:
    clock, turns = Clock(), []
    works = {"a": clock.work([100, 1, 2, 3], 2), "b": clock.work([100, 10, 20, 30], 5)}
    seconds = alternate(works, 3, clock, lambda share, name: turns.append((share, name)))
    np.testing.assert_allclose(seconds["a"], [0.5, 1, 1.5])
    np.testing.assert_allclose(seconds["b"], [2, 4, 6])
    assert [name for _, name in turns] == ["a", "b"] * 4
    shares = [share for share, _ in turns]
    assert shares == sorted(shares)
    assert 0 <= shares[0] < shares[-1] < 1


def test_ratios_are_of_times_in_the_same_round() -> None:
    # The machine is ten times as slow in the second half; the ratio is 1/2 throughout but for one round.
    clock = Clock()
    slow = [1.0] * 5 + [10.0] * 5
    works = {"a": clock.work([s / 2 for s in slow]), "b": clock.work([*slow[:3], 4.0, *slow[4:]])}
    seconds = alternate(works, 9, clock)
    row = Run("basis", 1, 9).ratio(seconds, "a", "b", unit="× b", bound=0.6)
    assert (row.value, row.low, row.high, row.met) == (0.5, 0.5, 0.5, True)
    assert row.detail == "5 s ÷ 10 s"


def test_median_and_quartiles_by_hand() -> None:
    assert Spread.of(np.array([9.0, 1, 3, 2, 100])) == Spread(3, 2, 9)


def made(value: float, name: str = "a", spread: float = 0.0, **more: object) -> Row:
    return replace(Row("basis", name, value, value - spread, value + spread, "×"), **more)


@pytest.mark.parametrize(
    ("bound", "bound_is", "met"),
    [(None, "most", None), (2.0, "most", True), (1.9, "most", False), (2.0, "least", True), (2.1, "least", False)],
)
def test_bounds(bound: float | None, bound_is: str, met: bool | None) -> None:
    assert made(2.0, bound=bound, bound_is=bound_is).met is met


def test_a_file_holds_what_was_measured(tmp_path: Path) -> None:
    bench = Bench({"processor": "π"}, {"lights": 3, "rounds": 9}, [made(0.5, bound=0.6), made(2, "b", 0.25)])
    file = tmp_path / "a.json"
    file.write_text(bench.to_json(), encoding="utf-8")
    assert read(file) == bench
    assert json.loads(file.read_text(encoding="utf-8"))["rows"][0]["met"] is True


@pytest.mark.parametrize(
    "content", ["", "[]", "{}", '{"format": 1}', '{"format": 1, "machine": {}, "settings": {}, "rows": [{"name": 1}]}']
)
def test_other_files_are_refused(content: str, tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text(content)
    with pytest.raises(CommandError, match=r"other\.json is not a file that shlight bench wrote"):
        read(file)


def test_what_is_not_a_number_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "nan.json"
    file.write_text(Bench({}, {}, [made(1.0)]).to_json().replace("1.0", "NaN"))
    with pytest.raises(CommandError, match="not a file that shlight bench wrote"):
        read(file)
    with pytest.raises(ValueError):
        Bench({}, {}, [made(float("nan"))]).to_json()


# --- comparison and tables ---------------------------------------------------------------------------------------


def bench_of(*rows: Row, **machine: str) -> Bench:
    return Bench({"processor": "x", **machine}, {"lights": 10, "rounds": 9}, list(rows))


def test_changes_beyond_the_spread_are_flagged() -> None:
    old = bench_of(made(1.0, "noisy", 0.2), made(1.0, "better", 0.01), made(2.0, "worse", 0.01), made(1.0, "trifle"),
                   made(1.5, "scaling", 0.01, bound_is="least"), made(3.0, "gone"))  # fmt: skip
    new = bench_of(made(1.3, "noisy", 0.2), made(0.8, "better", 0.01), made(3.0, "worse", 0.01), made(1.01, "trifle"),
                   made(1.9, "scaling", 0.01, bound_is="least"), made(3.0, "new"))  # fmt: skip
    found = {change.new.name: change for change in compare.changes(new, old)}
    assert list(found) == ["noisy", "better", "worse", "trifle", "scaling"]
    assert found["worse"].ratio == 1.5
    text = compare.comparison(new, old)
    flags = {cells[1]: cells[-1] for cells in map(split, text.splitlines()) if len(cells) == 6}
    assert {name: flags[name] for name in found} == {
        "noisy": "",
        "better": "better",
        "worse": "WORSE",
        "trifle": "",
        "scaling": "better",
    }
    assert "3 of 5 rows changed" in text


def split(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_other_machines_are_named() -> None:
    text = compare.comparison(bench_of(made(1.0), processor="new"), bench_of(made(1.0), processor="old"))
    assert text.startswith("not the same processor: new now, old before\n")
    nothing = compare.comparison(bench_of(made(1.0)), bench_of(made(1.0, "other")))
    assert nothing == "the two runs have no row in common"


def test_a_table_lines_up() -> None:
    rows = [made(0.5, "short", bound=0.6), made(1234.5, "a longer name", 2)]
    lines = table.section("Title", rows).splitlines()
    assert lines[:2] == ["Title", ""]
    assert len({len(line) for line in lines[2:]}) == 1
    assert split(lines[4]) == ["short", "0.5", "", "×", "≤ 0.6", "met"]
    assert split(lines[5]) == ["a longer name", "1234", "1232 … 1236", "×", "", ""]


# --- inputs ------------------------------------------------------------------------------------------------------


def test_lights_are_what_their_names_say() -> None:
    for kind, cut in (("clipped", 1.0), ("whole", 0.0), ("mixed", 0.25)):
        lights = inputs.spheres(kind, 400)
        assert lights.centers.dtype == lights.radii.dtype == np.float32
        height, radii = lights.centers[:, 2], lights.radii
        assert (height > -radii).all()
        assert np.mean(height < radii) == cut
    quads = inputs.quads(401)
    heights = quads.vertices[..., 2]
    below = (heights < 0).any(axis=1)
    np.testing.assert_array_equal(below, np.arange(401) % 2 == 0)
    assert (heights > 0).any(axis=1).all()
    assert quads.vertices.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(inputs.directions(50), axis=-1), 1, atol=1e-6)


def test_each_kind_of_work_is_the_call_that_it_names() -> None:
    works = kinds.works(8, 5)
    clipped, quads = inputs.spheres("clipped", 8), inputs.quads(8)
    expected = {
        "basis": shlight.sh_basis(inputs.directions(8), 5),
        "clipped sphere": shlight.sphere_coefficients(clipped.centers, clipped.radii, 5),
        "quad": shlight.polygon_coefficients(quads.vertices, 5),
    }
    for name, values in expected.items():
        np.testing.assert_array_equal(works[name].call(), values)
    assert {work.count for work in works.values()} == {8}


def test_fused_work_takes_every_band() -> None:
    lights, terms = inputs.spheres("clipped", 8), inputs.lobe_terms(16)
    coefficients = shlight.sphere_coefficients(lights.centers, lights.radii, 16, dtype=np.float64)
    columns = [band * band + band + m for band in range(16) for m in range(band + 1)]
    np.testing.assert_allclose(lights.fused(16).call(), coefficients[:, columns] @ terms, atol=1e-4)


# --- sections ----------------------------------------------------------------------------------------------------


@pytest.fixture
def own_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    """The library's own basis in place of sphericart's, which the tests do not need."""

    def basis(directions: np.ndarray, order: int) -> Work:
        return Work(lambda: shlight.sh_basis(directions, order, threads=1), len(directions))

    monkeypatch.setattr(peer, "basis", basis)
    monkeypatch.setattr(peer, "check_installed", lambda: None)


@pytest.mark.usefixtures("own_peer")
@pytest.mark.parametrize("section", [s for s in sections.SECTIONS if s.name not in ("memory",)], ids=lambda s: s.name)
def test_a_small_run_of_each_section(section: Section) -> None:
    shares: list[float] = []
    before = _core.kernel_target()
    rows = section.measure(Run(section.name, 12, 2, lambda share, text: shares.append(share)))
    assert _core.kernel_target() == before
    assert shares == sorted(shares)
    assert 0 <= shares[0] <= shares[-1] <= 1
    assert rows
    assert len({row.name for row in rows}) == len(rows)
    for row in rows:
        assert row.section == section.name
        assert np.isfinite(row.value)
        assert row.low <= row.value <= row.high
    Bench({}, {}, rows).to_json()


def test_the_bounds_of_the_library() -> None:
    assert against_peer.CLIPPED == {8: 0.5, 16: 0.4, 32: 0.3}
    assert against_peer.FUSED == {8: 0.30, 16: 0.25, 32: 0.15}
    assert growth.BOUNDS == {("clipped sphere", (16, 64)): 2.05}
    assert (threads.BOUND, targets.LANES) == (1.8, 2.2)


@pytest.mark.usefixtures("own_peer")
def test_planted_times_give_their_ratios(monkeypatch: pytest.MonkeyPatch) -> None:
    def planted(self: Run, works: dict[str, Work], part: object = None, clock: object = None) -> dict[str, np.ndarray]:
        def seconds(name: str) -> float:
            order = int(name.rpartition("n = ")[2]) if "n = " in name else 1
            slow = {"sphericart": 4.0, "basis": 2.0, "clipped sphere": 1.0}.get(name, 3.0)
            return slow * order**1.5

        return {name: np.full(self.rounds, 1e-9 * seconds(name)) for name in works}

    monkeypatch.setattr(Run, "alternate", planted)
    run = Run("x", 12, 9)
    assert [row.value for row in against_peer.measure_basis(run)[:3]] == [0.5] * 3
    of_spheres = {row.name: row for row in against_peer.measure_spheres(run)}
    assert of_spheres["clipped sphere, n = 32"].value == 0.25
    assert of_spheres["clipped sphere, n = 32"].detail == "1 ns ÷ 4 ns"
    assert of_spheres["clipped sphere, fused, n = 8"].met is False
    for row in growth.measure(run):
        assert row.value == pytest.approx(1.5)
    assert [row.value for row in threads.measure(run)] == [1.0] * 16
    assert {row.unit for row in against_methods.measure(run)} == {"× zhou_wei", "× wang_ramamoorthi"}


@pytest.mark.parametrize("on_two_cores", [11, 3, 2])
def test_turns_on_one_core_do_not_count_and_are_repeated(monkeypatch: pytest.MonkeyPatch, on_two_cores: int) -> None:
    def planted(self: Run, works: dict[str, Work], part: object = None, clock: object = None) -> dict[str, np.ndarray]:
        on_two = np.arange(self.rounds) < on_two_cores
        seconds = {}
        for name in works:
            gain = 1.7 if name.startswith("one call of ") else 1.9
            seconds[name] = 1e-9 / np.where(on_two & name.endswith(", 2"), gain, 1.0)
        seconds["memset, 2"][:] = 2e-12
        seconds["before quad, 2"][0] = 1e-9  # and so neither this turn of the quad nor that of the work before it
        return seconds

    monkeypatch.setattr(Run, "alternate", planted)
    rows = {row.name: row for row in threads.measure(Run("x", 12, 11))}
    basis, quad, warped = (rows[f"{name}, n = 8"] for name in ("basis", "quad", "warped lobe"))
    assert basis.value == pytest.approx(1.9 if on_two_cores > 2 else 1.0)
    assert rows["multiply-adds"].value == 1.0  # of all turns
    assert rows["memset"].met is None
    if on_two_cores == 11:
        gains = "11 of 33 turns, 1.00 in all; 1.70 after a pause"
        assert basis.detail == f"1 ns ÷ 0.526 ns; {gains}; writes at 97 % of memset"
        assert "; 10 of 33 turns," in quad.detail
        assert "; 10 of 33 turns," in warped.detail
        assert "writes" not in warped.detail
        assert basis.met
        assert quad.met
    elif on_two_cores == 3:
        assert "; 9 of 99 turns," in basis.detail
        assert basis.met
        assert "; 6 of 99 turns had two cores: all count," in quad.detail
    else:
        assert "; 6 of 99 turns had two cores: all count, 1.00 in all; 1.00 after a pause" in basis.detail
    if on_two_cores < 11:
        assert quad.met is False
        assert quad.value == 1.0


def test_a_turn_of_threads_is_calls_in_a_row() -> None:
    calls: list[int] = []
    work = threads._in_a_row(Work(lambda: calls.append(1), 5))
    work.call()
    assert (len(calls), work.count) == (threads.CALLS, 5 * threads.CALLS)


def test_operations_are_counted_for_kinds_that_there_are() -> None:
    assert set(OPERATIONS) <= set(kinds.works(1, 1))
    # Order 4: 6 steps of the recurrence, 6 pairs of products, 3 powers of the azimuth.
    assert OPERATIONS["basis"](4) == 4 * 6 + 2 * 6 + 6 * 3 + 15
    for count in OPERATIONS.values():
        counts = [count(order) for order in (1, 2, 4, 8, 16, 32, 64)]
        assert all(0 < low < high for low, high in itertools.pairwise(counts))
        assert 3 < counts[-1] / counts[-2] < 8.1


def test_memory_is_what_a_call_adds() -> None:
    count = 200_000
    growth, result = memory._probed("basis", 8, count)
    assert result == 4 * 64 * count
    assert result * 0.98 <= growth <= result + 3e7


def test_a_probe_that_fails_says_why() -> None:
    with pytest.raises(CommandError, match=r"(?s)the memory of nothing could not be measured:.*KeyError"):
        memory._probed("nothing", 8, 4)
