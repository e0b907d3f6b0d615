# SPDX-License-Identifier: MIT
"""Expressions as a program of the core: each operation once, in an order in which arguments come first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from shlight import _core
from shlight.nodes.inputs import SOURCES
from shlight.nodes.script_registers import CoreScript
from shlight.nodes.values import Step, Value, in_order, operations, result_count

if TYPE_CHECKING:
    from shlight.nodes.textures import ImageLookup

CONSTANT, INPUT, OPERATION = 0, 1, 2


class Table:
    """Numbers over one to three coordinates in 0 … 1, the first of which is the last axis of `values`."""

    def __init__(self, values: Any) -> None:
        self.values = np.ascontiguousarray(values, dtype=np.float32)
        self.sizes = list(reversed(self.values.shape))


class ProgramBuilder:
    """Lists the steps of expressions; `attributes` may be shared with another program of the material."""

    def __init__(self, attributes: list[str] | None = None) -> None:
        self.attributes: list[str] = [] if attributes is None else attributes
        self._steps: list[tuple[int, float, int, int, list[int]]] = []
        self._tables: list[tuple[Any, list[int]]] = []
        self._images: list[ImageLookup] = []
        self._scripts: list[CoreScript] = []
        self._numbers: dict[Step, int] = {}  # first value of a step
        self._known: dict[Any, int] = {}  # the same by what the step computes
        self._resources: dict[int, int] = {}
        self._values = 0
        self._results: list[int] = []

    def result(self, values: Sequence[Value]) -> int:
        """Makes values results of the program; the number of the first."""
        first = len(self._results)
        for value in values:
            for step in in_order([value.step], self._numbers):
                self._numbers[step] = self._add(step)
            self._results.append(self._numbers[value.step] + value.output)
        return first

    def program(self) -> _core.ShaderProgram:
        """The program of all listed steps; waits for pictures that are still being read."""
        images, scripts = [lookup.core for lookup in self._images], [own.core for own in self._scripts]
        return _core.shader_program(self._steps, self._tables, images, scripts, self._results)

    def input_number(self, source: str, index: int | str) -> tuple[int, int]:
        """How the program refers to an input."""
        if isinstance(index, str):
            if index not in self.attributes:
                self.attributes.append(index)
            index = self.attributes.index(index)
        return SOURCES[source], index

    def _add(self, step: Step) -> int:
        arguments = [self._numbers[a.step] + a.output for a in step.arguments]
        entry, count = self._entry(step, arguments)
        key = (*entry[:4], tuple(entry[4]), str(entry[1]))
        if key not in self._known:
            self._known[key] = self._values
            self._steps.append(entry)
            self._values += count
        return self._known[key]

    def _entry(self, step: Step, arguments: list[int]) -> tuple[tuple[int, float, int, int, list[int]], int]:
        if step.name == "constant":
            return (CONSTANT, step.data, 0, 0, []), 1
        if step.name == "input":
            source, index, component = step.data
            return (INPUT, 0.0, *self.input_number(source, index), [component]), 1
        number = operations()[step.name][0]
        if isinstance(step.data, float):  # over which a slope's difference is taken
            return (OPERATION, step.data, number, 0, arguments), result_count(step)
        return (OPERATION, 0.0, number, self._resource(step.data), arguments), result_count(step)

    def _resource(self, data: Any) -> int:
        if data is None or isinstance(data, int):  # no parameter, or a mode
            return data or 0
        if isinstance(data, CoreScript):
            if data not in self._scripts:
                self._scripts.append(data)
            return self._scripts.index(data)
        if id(data) not in self._resources:
            if isinstance(data, Table):
                self._resources[id(data)] = len(self._tables)
                self._tables.append((data.values, data.sizes))
            else:
                self._resources[id(data)] = len(self._images)
                self._images.append(data)
        return self._resources[id(data)]
