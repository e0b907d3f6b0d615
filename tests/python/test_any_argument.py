# SPDX-License-Identifier: MIT
"""Whatever is passed to a public function gives a result or an error that names the argument."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import argument_walk
import pytest

import shlight
from shlight import images
from shlight_tools import methods

PROCESSES, THINNED = 4, 6


def public_functions() -> Iterator[tuple[str, Any]]:
    for name in shlight.__all__:
        value = getattr(shlight, name)
        if isinstance(value, type) and not issubclass(value, Exception):
            for method in vars(value):
                operator = method in ("__mul__", "__rmul__")
                if (operator or not method.startswith("_")) and callable(getattr(value, method)):
                    yield f"{name}.{method}", getattr(value, method)
        elif callable(value) and not isinstance(value, type):
            yield name, value
    for module in (images, methods):
        for name in module.__all__:
            yield f"{module.__name__.rpartition('.')[2]}.{name}", getattr(module, name)


def argument_names(function: Any) -> set[str]:
    """The names of a function's arguments; those of the core's operators are in the first line of its docstring."""
    if inspect.isfunction(function):
        return set(inspect.signature(function).parameters) - {"self"}
    return set(re.findall(r"(\w+): ", function.__doc__.splitlines()[0])) - {"self"}


def test_the_walk_knows_every_function_and_argument() -> None:
    functions = dict(public_functions())
    walked: dict[str, set[str]] = {}
    for call, (_, arguments) in argument_walk.CALLS.items():
        walked.setdefault(call.split("/")[0], set()).update(arguments)
    assert walked == {name: argument_names(function) for name, function in functions.items()}


# Several in a process, whose start takes longer than most of them; the last line that it prints names the call.
@pytest.mark.parametrize("first", range(PROCESSES))
@pytest.mark.parametrize("step", [THINNED, pytest.param(1, marks=pytest.mark.slow)])
def test_any_argument_is_answered(first: int, step: int) -> None:
    """Each argument gets one in `step` of the wrong values, and the next argument those that follow them."""
    calls = list(argument_walk.CALLS)[first::PROCESSES]
    walk = [sys.executable, str(Path(argument_walk.__file__)), str(step), *calls]
    done = subprocess.run(walk, capture_output=True, text=True, check=False, timeout=200)
    assert done.returncode == 0, done.stderr.splitlines()[-20:]
    assert not done.stdout


@pytest.mark.parametrize("other", [None, 0.5, "x", [1.0], object()])
def test_only_materials_add_up(other: Any) -> None:
    with pytest.raises(TypeError):
        argument_walk.GGX + other
    with pytest.raises(TypeError):
        other + argument_walk.GGX


def test_numbers_in_messages_are_those_that_were_given() -> None:
    scene = argument_walk.new_scene()
    with pytest.raises(ValueError, match=rf"^width .*\b{2**40}$"):
        shlight.render(scene, 2**40, 2, max_bounces=0)
    with pytest.raises(ValueError, match=rf"^samples .* {-(2**40)}$"):
        methods.render_monte_carlo(scene, 2, 2, samples=-(2**40))
