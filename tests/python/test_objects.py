# SPDX-License-Identifier: MIT
"""Objects of the core in Python's own hands: copies, pickles, and none without a value."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scene_cases import lit_floor
from shading_cases import MATERIALS

import shlight
from shlight import Bsdf
from shlight_tools.methods import coefficient_methods, shading_methods

WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    **{f"pickle{p}": lambda x, p=p: pickle.loads(pickle.dumps(x, p)) for p in range(pickle.HIGHEST_PROTOCOL + 1)},
}
every_way = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)


@every_way
@pytest.mark.parametrize("name", [*MATERIALS, "mirror", "sum"])
def test_materials_keep_their_values(name: str, way: Callable[[Any], Any]) -> None:
    mirror = Bsdf.ggx(0, [0.9, 0.5, 0.1])
    bsdf = {**MATERIALS, "mirror": mirror, "sum": 0.5 * mirror + Bsdf.layer(mirror, MATERIALS["plastic"])}[name]
    again = way(bsdf)
    wi, wo = [[0.6, 0, 0.8], [-0.6, 0.1, 0.3]], [-0.3, 0, 0.9]
    np.testing.assert_array_equal(again.evaluate(wi, wo), bsdf.evaluate(wi, wo))
    light = [-0.5, 0.2, 0.4]
    expected = shlight.shade_spheres(light, 0.2, bsdf, [0.1, 0.7])
    np.testing.assert_array_equal(shlight.shade_spheres(light, 0.2, again, [0.1, 0.7]), expected)


@pytest.mark.parametrize(
    "state",
    [
        [((2.0, 0, 1.5), (1, 1, 1), None)],
        [((0.5, 3, 1.5), (1, 1, 1), None)],
        [((0.5, 2, 1.0), (1, 1, 1), None)],
        [(None, (1, -1, 1), None)],
        [(None, (1, 1, 1), [0.5])],
        [(None, (1, 1, 1), [2.0] * 129)],
        [(None, (1, 1, 1), [float("nan")] * 129)],
    ],
)
def test_a_pickle_that_was_tampered_with_is_refused(state: Any) -> None:
    with pytest.raises(ValueError):
        Bsdf._from_state(state)  # type: ignore[attr-defined]


@every_way
def test_reports_and_methods_keep_their_values(way: Callable[[Any], Any]) -> None:
    _, report = shlight.render(lit_floor(), 8, 6, return_report=True, max_bounces=0)
    methods = (*coefficient_methods().values(), *shading_methods().values())
    for value in (report, *methods):
        again = way(value)
        for name in (name for name in dir(value) if not name.startswith("_")):
            assert getattr(again, name) == getattr(value, name)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy])
def test_copies_of_a_scene_do_not_change_it(way: Callable[[Any], Any]) -> None:
    scene = lit_floor()
    expected = shlight.render(scene, 8, 6, max_bounces=0)
    again = way(scene)
    np.testing.assert_array_equal(shlight.render(again, 8, 6, max_bounces=0), expected)
    again.set_environment((1, 1, 1))
    assert not np.array_equal(shlight.render(again, 8, 6, max_bounces=0), expected)
    np.testing.assert_array_equal(shlight.render(scene, 8, 6, max_bounces=0), expected)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_a_scene_says_that_it_cannot_be_pickled(protocol: int) -> None:
    with pytest.raises(TypeError, match="build it in the process"):
        pickle.dumps(shlight.Scene(), protocol)


EMPTY_OBJECTS = """
import numpy, shlight
from shlight import _core
from shlight_tools import _methods
def ways(bound):
    class Derived(bound):
        def __init__(self): pass
    class Newer(bound):
        def __new__(cls): return super().__new__(cls)
    yield bound
    yield lambda: bound.__new__(bound)
    yield lambda: object.__new__(bound)
    yield lambda: bound.__mro__[1].__new__(bound)
    yield from (Derived, lambda: Derived.__new__(Derived), Newer)
bound = [kind for module in (_core, _methods) for kind in vars(module).values() if isinstance(kind, type)]
for kind in (kind for kind in bound if not issubclass(kind, Exception)):
    print(kind, flush=True)
    for make in ways(kind):
        try:
            made = make()
        except TypeError:
            continue
        assert kind in (shlight.KeptLight, shlight.Scene), make
        if kind is shlight.KeptLight:
            made.clear()
            assert made.record_count == 0
        else:
            made.add_sphere_light((0, 0, 1), 0.1, (1, 1, 1))
            made.set_camera(numpy.eye(4), 1.0)
            shlight.render(made, 2, 2)
"""


def test_no_object_is_without_a_value() -> None:
    """In a process of its own, which such an object would end; the last line that it prints names the kind."""
    done = subprocess.run([sys.executable, "-c", EMPTY_OBJECTS], capture_output=True, text=True, check=False)
    assert done.returncode == 0, [*done.stdout.splitlines()[-1:], done.stderr]
    assert len(done.stdout.splitlines()) > 10


def test_a_material_says_what_it_is_made_of() -> None:
    assert repr(Bsdf.lambert(0.25)) == "Bsdf(lambert * (0.25, 0.25, 0.25))"
    assert repr(0 * Bsdf.lambert(1)) in ("Bsdf(black)", "Bsdf(lambert * (0, 0, 0))")
    layered = Bsdf.layer(Bsdf.ggx(0.5, 0.04, ior=1.5), Bsdf.lambert((0.7, 0.1, 0)))
    assert repr(layered) == (
        "Bsdf(ggx(roughness=0.5) * (0.04, 0.04, 0.04) + ggx(roughness=0.5, fresnel='dielectric') * (0.96, 0.96, 0.96)"
        " + lambert * (0.7, 0.1, 0) under a layer)"
    )
