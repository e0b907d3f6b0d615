# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that make numbers, vectors and colours of others."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.colors import (
    brightness_contrast,
    gamma,
    hsl_from_rgb,
    hsv_from_rgb,
    hue_saturation,
    invert,
    ramp,
    rgb_from_hsl,
    rgb_from_hsv,
)
from shlight.nodes.mathematics import MATH, VECTOR_MATH, clamp_range, map_range, mapping, rotate, rotate_euler
from shlight.nodes.program import Table
from shlight.nodes.values import clamp, operation

from .nodes import NodeInputs, ReadNode

# Number of entries that Cycles reads from ramps and curves.
TABLE_SIZE = 257


def _clamped(inputs: NodeInputs, result: Any) -> Any:
    return clamp(result) if getattr(inputs.node, "use_clamp", False) else result


def _math(inputs: NodeInputs) -> Value:
    a, b, c = (inputs.number(i) for i in range(3))
    return _clamped(inputs, MATH[inputs.node.operation](a, b, c))


def _vector_math(inputs: NodeInputs) -> Value | Vector:
    a, b, c = (inputs.vector(i) for i in range(3))
    found = VECTOR_MATH[inputs.node.operation](a, b, c, inputs.number("Scale"))
    wants_number = inputs.output.identifier == "Value"
    if wants_number == isinstance(found, Value):
        return found
    return nodes.values.number(0.0) if wants_number else Vector(0.0, 0.0, 0.0)


def _mix(inputs: NodeInputs) -> Value | Vector:
    node = inputs.node
    suffix = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
    if suffix is None:
        inputs.remark(f"data type {node.data_type} is not supported; 0 is used")
        return nodes.values.number(0.0)
    a, b = (f"{letter}_{suffix}" for letter in "AB")
    if node.data_type == "VECTOR" and node.factor_mode != "UNIFORM":
        shares = inputs.vector("Factor_Vector")
        shares = Vector(*(clamp(t) for t in shares)) if node.clamp_factor else shares
        return inputs.vector(a) * (1.0 - shares) + inputs.vector(b) * shares
    factor = inputs.number("Factor_Float")
    factor = clamp(factor) if node.clamp_factor else factor
    if node.data_type == "RGBA":
        return _blended(inputs, inputs.color(a), inputs.color(b), factor, node.clamp_result)
    read = inputs.vector if node.data_type == "VECTOR" else inputs.number
    return read(a) * (1.0 - factor) + read(b) * factor


def _mix_rgb(inputs: NodeInputs) -> Color:
    return _blended(inputs, inputs.color(1), inputs.color(2), clamp(inputs.number(0)), inputs.node.use_clamp)


def _blended(inputs: NodeInputs, a: Color, b: Color, factor: Value, clamped: bool) -> Color:
    found = nodes.colors.BLENDS[inputs.node.blend_type](a, b, factor)
    return Color(*(clamp(c) for c in found)) if clamped else found


def _map_range(inputs: NodeInputs) -> Value | Vector:
    node = inputs.node
    kind = node.interpolation_type.lower()
    if node.data_type != "FLOAT_VECTOR":
        names = ("Value", "From Min", "From Max", "To Min", "To Max")
        steps = inputs.number("Steps")
        given = (inputs.number(name) for name in names)
        return map_range(*given, interpolation=kind, steps=steps, clamped=node.clamp)
    ends = ("Vector", "From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3", "Steps_FLOAT3")
    columns = zip(*(inputs.vector(name) for name in ends), strict=True)
    return Vector(*(map_range(*c[:5], interpolation=kind, steps=c[5], clamped=node.clamp) for c in columns))


def _clamp(inputs: NodeInputs) -> Value:
    value, low, high = (inputs.number(name) for name in ("Value", "Min", "Max"))
    return clamp_range(value, low, high) if inputs.node.clamp_type == "RANGE" else clamp(value, low, high)


def _color_ramp(inputs: NodeInputs) -> Color | Value:
    band = inputs.node.color_ramp
    table = np.array([band.evaluate(i / (TABLE_SIZE - 1)) for i in range(TABLE_SIZE)])
    found = ramp(inputs.number("Fac"), table, interpolate=band.interpolation != "CONSTANT")
    return found.alpha if inputs.output.identifier == "Alpha" else found


Function = Callable[[float], float]


@dataclass(frozen=True)
class CurveRange:
    """The interval in which Cycles tabulates the curves of a node, and how they go on beyond it."""

    low: float
    high: float
    extrapolates: bool

    def curve(self, evaluate: Function, value: Value) -> Value:
        """A function of one number as a table."""
        steps = TABLE_SIZE - 1
        table = np.array([evaluate(float(x)) for x in np.linspace(self.low, self.high, TABLE_SIZE)])
        place = (value - self.low) / (self.high - self.low)
        inside = operation("table1", place, data=Table(table))
        if not self.extrapolates:
            return inside
        below = float(table[0]) + place * (float(table[1] - table[0]) * steps)
        above = float(table[-1]) + (place - 1.0) * (float(table[-1] - table[-2]) * steps)
        return nodes.values.select(place < 0.0, below, nodes.values.select(place > 1.0, above, inside))


def _curves(inputs: NodeInputs) -> tuple[CurveRange, list[Function]]:
    """The range and the functions of a node's curves."""
    mapping_ = inputs.node.mapping
    mapping_.initialize()
    ends = [curve.points[i].location[0] for curve in mapping_.curves for i in (0, len(curve.points) - 1)]
    low, high = min(ends), max(ends)
    if not low < high:
        low, high = 0.0, 1.0
    functions: list[Function] = [partial(mapping_.evaluate, curve) for curve in mapping_.curves]
    return CurveRange(low, high, mapping_.extend == "EXTRAPOLATED"), functions


def _curved(own: Iterable[Value], functions: Iterable[Function], spread: CurveRange, t: Value) -> list[Value]:
    return [(1.0 - t) * a + t * spread.curve(f, a) for a, f in zip(own, functions, strict=False)]


def _after(second: Function, first: Function) -> Function:
    return lambda x: second(first(x))


def _rgb_curves(inputs: NodeInputs) -> Color:
    spread, (*channels, whole) = _curves(inputs)
    functions = [_after(f, whole) for f in channels]
    return Color(*_curved(inputs.color("Color"), functions, spread, inputs.number("Fac")))


def _vector_curves(inputs: NodeInputs) -> Vector:
    spread, functions = _curves(inputs)
    return Vector(*_curved(inputs.vector("Vector"), functions, spread, inputs.number("Fac")))


def _float_curve(inputs: NodeInputs) -> Value:
    spread, functions = _curves(inputs)
    return _curved([inputs.number("Value")], functions, spread, inputs.number("Factor"))[0]


def _component(inputs: NodeInputs, v: Vector) -> Value:
    index = next(i for i, output in enumerate(inputs.node.outputs) if output == inputs.output)
    return tuple(v)[index]


def _separate(inputs: NodeInputs, mode: str = "RGB") -> Value:
    return _component(inputs, _FROM_RGB[mode](inputs.color(0)))


def _combine(inputs: NodeInputs, mode: str = "RGB") -> Color:
    return _TO_RGB[mode](Color(*(inputs.number(i) for i in range(3))))


def _vector_rotate(inputs: NodeInputs) -> Vector:
    node, v, center = inputs.node, inputs.vector("Vector"), inputs.vector("Center")
    if node.rotation_type == "EULER_XYZ":
        return rotate_euler(v - center, inputs.vector("Rotation"), invert=node.invert) + center
    axes = {"X_AXIS": Vector(1.0, 0.0, 0.0), "Y_AXIS": Vector(0.0, 1.0, 0.0), "Z_AXIS": Vector(0.0, 0.0, 1.0)}
    axis = axes[node.rotation_type] if node.rotation_type in axes else inputs.vector("Axis")
    angle = inputs.number("Angle")
    return rotate(v - center, axis, -angle if node.invert else angle) + center


def _hue_saturation(inputs: NodeInputs) -> Color:
    hue, saturation, value, factor = (inputs.number(name) for name in ("Hue", "Saturation", "Value", "Fac"))
    return hue_saturation(inputs.color("Color"), hue, saturation, value, factor)


def _normal(inputs: NodeInputs) -> Value | Vector:
    own = nodes.values.normalize(Vector(*inputs.node.outputs["Normal"].default_value))
    if inputs.output.identifier == "Normal":
        return own
    return nodes.values.dot(own, nodes.values.normalize(inputs.vector("Normal")))


_FROM_RGB: dict[str, Callable[[Vector], Vector]] = {"RGB": lambda c: c, "HSV": hsv_from_rgb, "HSL": hsl_from_rgb}
_TO_RGB: dict[str, Callable[[Color], Color]] = {"RGB": lambda c: c, "HSV": rgb_from_hsv, "HSL": rgb_from_hsl}

VALUE_NODES: dict[str, ReadNode] = {
    "MATH": _math,
    "VECT_MATH": _vector_math,
    "MIX": _mix,
    "MIX_RGB": _mix_rgb,
    "MAP_RANGE": _map_range,
    "CLAMP": _clamp,
    "VALTORGB": _color_ramp,
    "CURVE_RGB": _rgb_curves,
    "CURVE_VEC": _vector_curves,
    "CURVE_FLOAT": _float_curve,
    "SEPARATE_COLOR": lambda inputs: _separate(inputs, inputs.node.mode),
    "COMBINE_COLOR": lambda inputs: _combine(inputs, inputs.node.mode),
    "SEPRGB": _separate,
    "COMBRGB": _combine,
    "SEPHSV": lambda inputs: _separate(inputs, "HSV"),
    "COMBHSV": lambda inputs: _combine(inputs, "HSV"),
    "SEPXYZ": lambda inputs: _component(inputs, inputs.vector(0)),
    "COMBXYZ": lambda inputs: Vector(*(inputs.number(i) for i in range(3))),
    "HUE_SAT": _hue_saturation,
    "BRIGHTCONTRAST": lambda i: brightness_contrast(i.color("Color"), i.number("Bright"), i.number("Contrast")),
    "GAMMA": lambda inputs: gamma(inputs.color("Color"), inputs.number("Gamma")),
    "INVERT": lambda inputs: invert(inputs.color("Color"), inputs.number("Fac")),
    "RGBTOBW": lambda inputs: inputs.color("Color").as_number(),
    "NORMAL": _normal,
    "VECTOR_ROTATE": _vector_rotate,
    "MAPPING": lambda i: mapping(
        i.vector("Vector"),
        i.vector("Location"),
        i.vector("Rotation"),
        i.vector("Scale"),
        i.node.vector_type.lower(),
    ),
}
