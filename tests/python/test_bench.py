# SPDX-License-Identifier: MIT
"""What `./dev bench` measures, and its statistics; no test depends on how fast anything is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shlight
from shlight_tools.bench import builds, calls, compare, inputs, peer, sections
from shlight_tools.bench.rounds import Spread, Work, alternate
from shlight_tools.bench.row import Bench, Row
from shlight_tools.bench.run import Run


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


@pytest.mark.slow
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
