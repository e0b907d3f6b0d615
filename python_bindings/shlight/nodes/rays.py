# SPDX-License-Identifier: MIT
"""Kinds of rays, which materials may tell apart: an expression is rebuilt for each kind before the core gets it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, MutableMapping
from enum import IntEnum
from typing import Any
from weakref import WeakKeyDictionary

from shlight.nodes.values import (
    Color,
    Step,
    Value,
    Vector,
    arithmetic,
    in_order,
    number,
    operation,
    operations,
    select,
    steps,
)

FOOTPRINTS = frozenset(f"footprint{count}" for count in range(1, 5))  # operations that noise is filtered by

# A function that gives what takes the place of a step, and None where the step stays.
Replace = Callable[[Step], Value | None]
# The results that take the place of a step's, None where nothing changes.
Replaced = MutableMapping[Step, tuple[Value, ...] | None]


# `unfiltered` keeps here what it has found, since expressions that bend bent ones share it. If each copied all that is
# below it, each of some nodes in a row would double what there is.
_UNFILTERED: Replaced = WeakKeyDictionary()


class Ray(IntEnum):
    """CAMERA: from the camera. SHADOW: from a surface to a light. LIGHT: along which an emitter lights a surface."""

    CAMERA, SHADOW, LIGHT = range(3)


def _kind(kind: Ray) -> Value:
    return Value(Step("ray", (), kind))


def camera_ray() -> Value:
    """1 for rays from the camera, else 0."""
    return _kind(Ray.CAMERA)


def shadow_ray() -> Value:
    """1 for rays between a surface and a light, else 0."""
    return _kind(Ray.SHADOW)


def on_ray(values: Iterable[Value], kind: Ray | None, *, filtered: bool = True) -> list[Value]:
    """Expressions as a ray of this kind, or of any, finds them. filtered: as the pictures and noises in them are."""

    def known(step: Step) -> Value | None:
        return number(float(step.data == kind)) if step.name == "ray" and kind is not None else None

    return _replaced(values, known, _UNFILTERED if kind is None and not filtered else {}, filtered=filtered)


def unfiltered(value: Value) -> Value:
    """The number with pictures and noises as they are at the hit: what bends a mean gives no mean of what it bends."""
    return on_ray([value], None, filtered=False)[0]


def with_vectors(values: Iterable[Value], vectors: Mapping[str, Vector]) -> list[Value]:
    """Expressions that read other vectors in the place of some sources, "position" for instance."""
    known = _by_source(vectors)
    return _replaced(values, lambda step: known.get(step.data) if step.name == "input" else None, {})


def beside(value: Value, side: str, width: float, vectors: Mapping[str, Vector]) -> Value:
    """A number as it is `width` pixels to the side "near_x" or "near_y" of the hit, where some sources are these."""
    known = _by_source(vectors)

    def moved(step: Step) -> Value | None:
        if step.name != "input":
            return None
        here = Value(step)
        return known[step.data] if step.data in known else here + operation(side, here, data=width)

    return _replaced([value], moved, {})[0]


def _by_source(vectors: Mapping[str, Vector]) -> dict[Any, Value]:
    return {(source, 0, i): c for source, own in vectors.items() for i, c in enumerate(own)}


def _replaced(values: Iterable[Value], replace: Replace, found: Replaced, *, filtered: bool = True) -> list[Value]:
    wanted = list(values)
    for step in in_order((value.step for value in wanted), found):
        own = _rebuilt(step, found, replace)
        found[step] = own if filtered or not _is_filter(step) else _at_the_place(step, own)
    return [_result(value, found) for value in wanted]


def color_on_ray(color: Color, kind: Ray, *, filtered: bool = True) -> Color:
    """A colour as a ray of this kind finds it; see on_ray."""
    return Color(*on_ray((*color, color.alpha), kind, filtered=filtered))


def has_filters(values: Iterable[Value]) -> bool:
    """Whether a picture or noise, which the distance of camera rays filters, is part of expressions."""
    return any(_is_filter(step) for step in in_order(value.step for value in values))


def _is_filter(step: Step) -> bool:
    if step.name == "image":
        return any(share.constant != 0.0 for share in step.arguments[2:])
    return step.name in FOOTPRINTS


def _result(value: Value, found: Replaced) -> Value:
    results = found[value.step]
    return value if results is None else results[value.output]


def _rebuilt(step: Step, found: Replaced, replace: Replace) -> tuple[Value, ...] | None:
    if (new := replace(step)) is not None:
        return (new,)
    if all(found[a.step] is None for a in step.arguments):
        return None
    arguments = [_result(a, found) for a in step.arguments]
    if step.name == "select":
        return (select(*arguments),)
    if step.name in ("add", "subtract", "multiply"):
        return (arithmetic(step.name, *arguments),)
    return steps(step.name, *arguments, data=step.data)


def _at_the_place(image: Step, rebuilt: tuple[Value, ...] | None) -> tuple[Value, ...]:
    """A picture that is looked up with no footprint, or none of a noise. rebuilt: the results of the step that takes
    its place, if any."""
    if image.name in FOOTPRINTS:
        return (number(0.0),) * operations()[image.name][2]
    u, v = (image if rebuilt is None else rebuilt[0].step).arguments[:2]
    return steps("image", u, v, 0.0, 0.0, 0.0, 0.0, data=image.data)
