# SPDX-License-Identifier: MIT
"""Numbers, vectors and colours that vary over a surface: expressions from which shader programs are made.

An expression is built by Python's operators and by the functions of `shlight.nodes`; the core evaluates it in float32
for many hits at once. What has constant arguments only is computed at once and costs a hit nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NoReturn, TypeAlias

import numpy as np
from numpy.typing import NDArray

from shlight import _core

LARGEST_COLOR, LARGEST_RADIANCE = 1e10, 1e15  # docs/conventions.md


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Step:
    """A constant, an input or an operation; `data` is the constant, or (source, index or name, component), or a table,
    image, script or mode."""

    name: str
    arguments: tuple[Value, ...] = ()
    data: Any = None


@lru_cache(maxsize=1)
def operations() -> dict[str, tuple[int, int, int]]:
    """Number, argument count and result count of the core's operations, by name."""
    return {name: (number, count, results) for number, (name, count, results) in enumerate(_core.shader_operations())}


class Expression:
    """The base of numbers and vectors that vary: it refuses the words of Python that need one value."""

    __slots__ = ()
    __array_ufunc__ = None  # an array of numpy leaves operators to the expression, which knows what it takes

    def __bool__(self) -> NoReturn:
        raise TypeError(
            "an expression of shlight.nodes is neither true nor false before a surface is shaded. In place of if, and, "
            "or: nodes.select(condition, a, b), and nodes.mix_color(b, a, condition) of colours; in place of min and "
            "max: nodes.minimum, nodes.maximum, nodes.clamp; in place of a < b < c: (a < b) * (b < c)"
        )

    def __eq__(self, other: object) -> bool:
        """Whether the other is this very expression; nodes.equal(a, b) compares what they give."""
        if _floats(other) is not None:
            raise TypeError("== says nothing of what an expression gives; nodes.equal(a, b) is 1 where a equals b")
        return self is other

    __hash__ = object.__hash__


def _of_numbers(name: str) -> tuple[Callable[[Value, Number], Value], Callable[[Value, Number], Value]]:
    """An operator of numbers by its operation: the methods of its left and of its right operand."""

    def left(a: Value, b: Number) -> Value:
        return arithmetic(name, a, b) if _is_number(b) else NotImplemented

    def right(b: Value, a: Number) -> Value:
        return arithmetic(name, a, b) if _is_number(a) else NotImplemented

    return left, right


def _of_vectors(name: str) -> tuple[Callable[[Vector, Varying], Vector], Callable[[Vector, Varying], Vector]]:
    """The same of vectors, by component. A material on the right multiplies itself."""

    def left(a: Vector, b: Varying) -> Vector:
        if hasattr(b, "is_anisotropic"):
            return NotImplemented
        return type(a)(*(arithmetic(name, *pair) for pair in zip(a, triple(b), strict=True)))

    def right(b: Vector, a: Varying) -> Vector:
        return type(b)(*(arithmetic(name, *pair) for pair in zip(triple(a), b, strict=True)))

    return left, right


class Value(Expression):
    """A number at each hit. Comparisons give 1 where they hold, else 0; `==` is `nodes.equal`."""

    __slots__ = ("output", "step")

    def __init__(self, step: Step, output: int = 0) -> None:
        self.step = step
        self.output = output

    @property
    def constant(self) -> float | None:
        """The number, if it is the same everywhere."""
        return float(self.step.data) if self.step.name == "constant" else None

    __add__, __radd__ = _of_numbers("add")
    __sub__, __rsub__ = _of_numbers("subtract")
    __mul__, __rmul__ = _of_numbers("multiply")
    __truediv__, __rtruediv__ = _of_numbers("divide")
    __pow__, __rpow__ = _of_numbers("power")
    __lt__, __gt__ = _of_numbers("less")

    def __neg__(self) -> Value:
        return subtract(0.0, self)

    def __abs__(self) -> Value:
        return operation("absolute", self)

    def __le__(self, other: Number) -> Value:
        return maximum(self < other, equal(self, other)) if _is_number(other) else NotImplemented

    def __ge__(self, other: Number) -> Value:
        return maximum(self > other, equal(self, other)) if _is_number(other) else NotImplemented

    def __repr__(self) -> str:
        return f"{self.constant:g}" if self.constant is not None else f"<{self.step.name}>"


def _is_number(value: Any) -> bool:
    """Whether an operator of a number takes it; vectors and shaders have operators of their own."""
    return isinstance(value, Value | float | int | np.number) or (isinstance(value, np.ndarray) and value.ndim == 0)


class Vector(Expression):
    """Three numbers at each hit; operators go by component, and a number stands for three equal ones."""

    __slots__ = ("x", "y", "z")

    def __init__(self, x: Number, y: Number, z: Number) -> None:
        self.x, self.y, self.z = number(x), number(y), number(z)

    def __iter__(self) -> Iterator[Value]:
        return iter((self.x, self.y, self.z))

    __add__, __radd__ = _of_vectors("add")
    __sub__, __rsub__ = _of_vectors("subtract")
    __mul__, __rmul__ = _of_vectors("multiply")
    __truediv__, __rtruediv__ = _of_vectors("divide")
    __pow__, __rpow__ = _of_vectors("power")

    def __neg__(self) -> Vector:
        return 0.0 - self

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """The numbers, if they are the same everywhere."""
        x, y, z = self.x.constant, self.y.constant, self.z.constant
        return None if x is None or y is None or z is None else (x, y, z)

    def as_number(self) -> Value:
        """The conversion to a number: the mean."""
        return (self.x + self.y + self.z) / 3.0

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.x}, {self.y}, {self.z})"


class Color(Vector):
    """Linear RGB at each hit."""

    __slots__ = ("alpha",)

    def __init__(self, r: Number, g: Number, b: Number, alpha: Number = 1.0) -> None:
        super().__init__(r, g, b)
        self.alpha = number(alpha)

    def as_number(self) -> Value:
        """The conversion to a number: the luminance, as Rec. 709 weighs linear RGB."""
        r, g, b = _core.LUMINANCE
        return self.x * r + self.y * g + self.z * b


Number: TypeAlias = "Value | float | Vector"
Varying: TypeAlias = "Value | Vector | float | Sequence[float]"


def number(value: Any, name: str = "", low: float = -math.inf, high: float = math.inf) -> Value:
    """A number as an expression.

    name: of the argument of a public function that the number is, "" of a part of an expression. An argument that is no
        expression must be finite and lie in low … high. Raises ValueError naming it.
    """
    if isinstance(value, Value):
        return value
    if isinstance(value, Vector):
        return value.as_number()
    known = _floats(value)
    if known is None or known.ndim != 0:
        kind = type(value).__name__
        raise ValueError(f"{name or 'value'} must be a number or an expression of shlight.nodes, got {kind}")
    _check_range(name, known, low, high)
    return Value(Step("constant", (), float(known)))


def _floats(value: Any) -> NDArray[np.float32] | None:
    """Real numbers as the core has them, None for anything else; what is too large is infinite."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        return None
    if array.dtype.kind not in "fiub":
        return None
    with np.errstate(over="ignore"):
        return array.astype(np.float32)


def _check_range(name: str, known: NDArray[np.float32], low: float, high: float) -> None:
    if name and not (np.isfinite(known) & (known >= low) & (known <= high)).all():
        range_of = "be finite" if (low, high) == (-math.inf, math.inf) else f"lie in [{low:g}, {high:g}]"
        raise ValueError(f"{name} must {range_of}, got {known.tolist()}")


def triple(value: Any, name: str = "", low: float = -math.inf, high: float = math.inf) -> tuple[Value, Value, Value]:
    """Three numbers as expressions; a number stands for three equal ones. See `number`."""
    if isinstance(value, Vector):
        return value.x, value.y, value.z
    if isinstance(value, Value):
        return value, value, value
    known = _floats(value)
    if known is None or known.shape not in ((), (3,)):
        raise ValueError(
            f"{name or 'value'} must be a number, three numbers or an expression of shlight.nodes, "
            f"got {type(value).__name__}"
        )
    _check_range(name, known, low, high)
    x, y, z = (number(component) for component in np.broadcast_to(known, (3,)))
    return x, y, z


def vector(value: Any, name: str = "") -> Vector:
    """A vector; see `triple`."""
    return value if isinstance(value, Vector) and not isinstance(value, Color) else Vector(*triple(value, name))


def color(value: Any, name: str = "", low: float = -math.inf, high: float = math.inf) -> Color:
    """A colour; see `triple`."""
    return value if isinstance(value, Color) else Color(*triple(value, name, low, high))


def reflectance(value: Any, name: str) -> Color:
    """A colour that is multiplied with what a lobe reflects; see `number`."""
    return color(value, name, 0.0, LARGEST_COLOR)


def steps(name: str, *arguments: Number, data: Any = None) -> tuple[Value, ...]:
    """All results of an operation of the core."""
    values = tuple(number(argument) for argument in arguments)
    step = Step(name, values, data)
    results = result_count(step)
    if name not in DIFFERENCES and data is None and all(value.constant is not None for value in values):
        return tuple(number(result) for result in _computed(name, tuple(value.constant or 0.0 for value in values)))
    return tuple(Value(step, output) for output in range(results))


def result_count(step: Step) -> int:
    """How many values an operation of the core makes; a script has its own."""
    return len(step.data.results) if step.name == "script" else operations()[step.name][2]


def operation(name: str, *arguments: Number, data: Any = None) -> Value:
    """The only result of an operation of the core."""
    return steps(name, *arguments, data=data)[0]


# Operations that images and bump maps use: the differences of a value to the neighbouring camera rays, and to places
# near the hit.
DIFFERENCES = ("right", "below", "near_x", "near_y")


@lru_cache(maxsize=4096)
def _computed(name: str, constants: tuple[float, ...]) -> tuple[float, ...]:
    operation_number, _, results = operations()[name]
    count = len(constants)
    listed: list[tuple[int, float, int, int, list[int]]] = [(0, constant, 0, 0, []) for constant in constants]
    listed.append((2, 0.0, operation_number, 0, list(range(count))))
    program = _core.shader_program(listed, [], [], [], list(range(count, count + results)))
    return tuple(float(value) for value in program.evaluate([], 1)[:, 0])


def add(a: Number, b: Number) -> Value:
    """a + b."""
    x, y = number(a), number(b)
    return y if x.constant == 0.0 else x if y.constant == 0.0 else operation("add", x, y)


def subtract(a: Number, b: Number) -> Value:
    """a - b."""
    x, y = number(a), number(b)
    return x if y.constant == 0.0 else operation("subtract", x, y)


def multiply(a: Number, b: Number) -> Value:
    """a b."""
    x, y = number(a), number(b)
    if x.constant == 1.0 or y.constant == 0.0:
        return y
    return x if y.constant == 1.0 or x.constant == 0.0 else operation("multiply", x, y)


def arithmetic(name: str, a: Number, b: Number) -> Value:
    """An operation of two numbers, without those that change nothing."""
    return {"add": add, "subtract": subtract, "multiply": multiply}.get(name, lambda x, y: operation(name, x, y))(a, b)


def minimum(a: Number, b: Number) -> Value:
    """The smaller of two numbers."""
    return operation("minimum", a, b)


def maximum(a: Number, b: Number) -> Value:
    """The larger of two numbers."""
    return operation("maximum", a, b)


def equal(a: Number, b: Number) -> Value:
    """1 where two numbers are the same, else 0."""
    return operation("equal", a, b)


def clamp(value: Number, low: Number = 0.0, high: Number = 1.0) -> Value:
    """The number, or the end of the interval that it lies beyond."""
    return minimum(maximum(value, low), high)


def sqrt(value: Number) -> Value:
    """The square root; 0 of what is negative."""
    return operation("sqrt", value)


def select(condition: Number, if_true: Number, if_false: Number) -> Value:
    """One of two numbers, by whether the first is 0."""
    constant = number(condition).constant
    if constant is not None:
        return number(if_true if constant != 0.0 and not math.isnan(constant) else if_false)
    return operation("select", condition, if_true, if_false)


def dot(a: Vector, b: Vector) -> Value:
    """The scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def length(a: Vector) -> Value:
    """How long a vector is."""
    return sqrt(dot(a, a))


def normalize(a: Vector) -> Vector:
    """The unit vector along a vector; 0 for 0."""
    return a / length(a)


def in_order(wanted: Iterable[Step], known: Container[Step] = ()) -> Iterator[Step]:
    """All steps of expressions, each once and after its arguments; `known`: steps that are left out."""
    seen: set[Step] = set()
    waiting = list(wanted)
    while waiting:
        step = waiting[-1]
        missing = [a.step for a in step.arguments if a.step not in seen and a.step not in known]
        if missing:
            waiting += missing
            continue
        waiting.pop()
        if step not in seen and step not in known:
            seen.add(step)
            yield step


def right(value: Number) -> Value:
    """How much the value grows to the camera ray of the pixel to the right."""
    return operation("right", value)


def below(value: Number) -> Value:
    """How much the value grows to the camera ray of the pixel below."""
    return operation("below", value)
