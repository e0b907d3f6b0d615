# SPDX-License-Identifier: MIT
"""Instructions of Open Shading Language that only compute, as instructions of the core, one for each component."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from shlight.nodes.oso import Instruction, Symbol
from shlight.nodes.script_registers import Registers

# Functions by component, which have the same name in the core.
FUNCTIONS = (
    "floor", "ceil", "round", "trunc", "sign", "step", "smoothstep", "sqrt", "inversesqrt", "cbrt", "pow", "exp",
    "exp2", "expm1", "log", "log2", "log10", "logb", "erf", "erfc", "sin", "cos", "tan", "asin", "acos", "atan",
    "atan2", "sinh", "cosh", "tanh", "isnan", "isinf", "isfinite",
)  # fmt: skip
INTEGER_ONLY = ("bitand", "bitor", "xor", "compl", "shl", "shr", "and", "or")
# Comparisons: the core's, whether the operands change places, and whether it is negated.
COMPARISONS = {
    "lt": ("less", False, False),
    "gt": ("less", True, False),
    "le": ("less_equal", False, False),
    "ge": ("less_equal", True, False),
    "eq": ("equal", False, False),
    "neq": ("equal", False, True),
}
LUMINANCE = (0.2125072330236435, 0.7153501510620117, 0.0721426010131836)  # of Rec. 709, as Cycles has it
# Spaces of colours and places that are the scene's own.
SAME_SPACE = ("common", "world", "rgb", "RGB")


class Computation(Registers):
    """Lists instructions that compute.

    What is known of inputs counts: a product with a constant 0 is 0 whatever the other factor is, as in Cycles, which
    optimizes a script for its inputs.
    """

    def __init__(self) -> None:
        super().__init__()
        self.handlers: dict[str, Callable[[Instruction], None]] = {
            "assign": lambda op: self.assign(*op.arguments),
            "arraycopy": self.array_copy,
            **dict.fromkeys(("add", "sub", "mul", "div", "mod", "fmod", "min", "max"), self.arithmetic),
            **dict.fromkeys(("neg", "abs", "fabs"), self.negation),
            **dict.fromkeys(COMPARISONS, self.comparison),
            **dict.fromkeys(FUNCTIONS, self.function),
            **dict.fromkeys(INTEGER_ONLY, self.of_integers),
            **dict.fromkeys(("color", "point", "vector", "normal"), self.construct),
            **dict.fromkeys(("noise", "snoise"), self.noise),
            **dict.fromkeys(("dot", "length", "distance", "normalize", "cross", "luminance"), self.of_vectors),
            "compref": self.element,
            "aref": self.element,
            "compassign": self.set_element,
            "aassign": self.set_element,
            "transformc": self.transform_color,
            "sincos": self.sine_and_cosine,
            "clamp": self.clamp,
            "mix": self.mix,
            "select": self.select,
        }

    def compute(self, op: Instruction) -> None:
        """Lists what an instruction does. Raises ValueError for one that is not supported."""
        if op.name not in self.handlers:
            raise ValueError(f"script uses {op.name}, which is not supported")
        try:
            self.handlers[op.name](op)
        except (TypeError, IndexError, OverflowError, ValueError) as error:  # arguments are missing, or of other kinds
            if str(error).startswith("script"):
                raise
            raise ValueError(f"script uses {op.name} in a way that is not supported") from error

    def assign(self, to: Symbol, source: Symbol) -> None:
        for i in range(to.width):
            self.emit("copy", self.own(to, i), self.as_int(source, i) if to.is_int else self.as_float(source, i))
        if source.known is not None and to.kind in ("local", "temp") and to.writes == 1 and to.length is None:
            to.known = (source.known * 3)[: to.width] if len(source.known) == 1 else source.known
            if to.is_int:
                to.known = tuple(float(int(value)) for value in to.known)

    def set_known(self, to: Symbol, values: list[float]) -> None:
        """Assigns a constant."""
        made = Symbol("const", "int" if to.is_int else to.type, "", known=tuple(values * (to.width // len(values))))
        made.register = self.reserve(list(made.known or ()), is_int=to.is_int)
        self.assign(to, made)

    def array_copy(self, op: Instruction) -> None:
        to, source = op.arguments
        for i in range(to.width * min(to.length or 0, source.length or 0)):
            self.emit("copy", self.own(to) + i, self.own(source) + i)

    def arithmetic(self, op: Instruction) -> None:
        to, a, b = op.arguments
        if self.simplified(op.name, to, a, b):
            return
        name = op.name
        if to.is_int:
            for_int = {"fmod": "mod"}.get(name, name)
            self.emit(f"int_{for_int}", self.own(to), self.as_int(a), self.as_int(b))
            return
        if name == "mod":
            name = "fmod"
        # Cycles divides by a constant as C does.
        if b.known is not None and not _all(b, 0.0) and (name == "div" or (op.name == "mod")):
            name = f"plain_{name}"
        for i in range(to.width):
            self.emit(name, self.own(to, i), self.as_float(a, i), self.as_float(b, i))

    def simplified(self, name: str, to: Symbol, a: Symbol, b: Symbol) -> bool:
        """Whether constants make it an assignment, as Cycles finds, which is then listed."""
        same = {
            "add": a if _all(b, 0.0) else b if _all(a, 0.0) else None,
            "sub": a if _all(b, 0.0) else None,
            "mul": a if _all(b, 1.0) or _all(a, 0.0) else b if _all(a, 1.0) or _all(b, 0.0) else None,
            "div": a if _all(b, 1.0) else None,
        }.get(name)
        if same is not None:
            self.assign(to, same)
        elif (name == "sub" and a is b) or (name in ("div", "mod", "fmod") and _all(b, 0.0)):
            self.set_known(to, [0.0])
        elif name in ("add", "sub", "mul", "div") and a.known is not None and b.known is not None:
            self.set_known(to, _computed(name, a, b, to))
        else:
            return False
        return True

    def negation(self, op: Instruction) -> None:
        to, a = op.arguments
        name = "neg" if op.name == "neg" else "abs"
        if a.known is not None:
            self.set_known(to, [-value if name == "neg" else abs(value) for value in a.known])
            return
        for i in range(to.width):
            register = self.as_int(a, i) if to.is_int else self.as_float(a, i)
            self.emit(f"int_{name}" if to.is_int else name, self.own(to, i), register)

    def comparison(self, op: Instruction) -> None:
        to, a, b = op.arguments
        name, swapped, negated = COMPARISONS[op.name]
        of_int = a.is_int and b.is_int
        found = -1
        for i in range(max(a.width, b.width)):
            x, y = (self.own(s, i) if of_int else self.as_float(s, i) for s in ((b, a) if swapped else (a, b)))
            own = self.made(f"int_{name}" if of_int else name, x, y)
            found = own if found < 0 else self.made("and", found, own)
        self.emit("int_equal" if negated else "copy", self.own(to), found, self.constant(0.0, is_int=True))

    def function(self, op: Instruction) -> None:
        to, *arguments = op.arguments
        name, count = op.name, 3 if op.name == "smoothstep" else 2 if op.name in ("pow", "atan2", "step") else 1
        if len(arguments) != count:
            raise ValueError(f"script uses {name} with {len(arguments)} arguments, which is not supported")
        if name == "pow" and (special := self.special_power(to, *arguments)) is None:
            return
        if name == "pow" and special:
            name, *arguments = special
        for i in range(to.width):
            self.emit(name, self.own(to, i), *(self.as_float(argument, i) for argument in arguments))

    def special_power(self, to: Symbol, base: Symbol, exponent: Symbol) -> list[Any] | None:
        """The function and its arguments that Cycles takes for a power with constants: [] for most, None where it was
        listed."""
        if _all(exponent, 0.0) or _all(base, 0.0):
            self.set_known(to, [1.0 if _all(exponent, 0.0) else 0.0])
            return None
        if _all(exponent, 1.0):
            self.assign(to, base)
            return None
        if base.known is None and exponent.known is not None and exponent.type == "float":
            names = {2.0: "mul", 0.5: "sqrt", -0.5: "inversesqrt", float(np.float32(1.0 / 3.0)): "cbrt"}
            name = names.get(float(np.float32(exponent.known[0])))
            if name is not None:
                return [name, base, base] if name == "mul" else [name, base]
        return []

    def of_integers(self, op: Instruction) -> None:
        to, *arguments = op.arguments
        self.emit(op.name, self.own(to), *(self.as_int(argument) for argument in arguments))

    def construct(self, op: Instruction) -> None:
        to, *parts = op.arguments
        space = parts.pop(0).text if parts[0].type == "string" else "common"
        if len(parts) != 3 or (space not in SAME_SPACE and (op.name, space) != ("color", "hsv")):
            raise ValueError(f"script uses {op.name}s of {space}, which are not supported")
        if all(part.known is not None for part in parts) and space != "hsv":
            self.set_known(to, [part.known[0] for part in parts if part.known])
            return
        for i, part in enumerate(parts):
            self.emit("copy", self.own(to, i), self.as_float(part))
        if space == "hsv":
            self.emit("hsv_to_rgb", self.own(to), self.own(to))

    def transform_color(self, op: Instruction) -> None:
        to, first, last, source = op.arguments
        if first.text == last.text or {first.text, last.text} <= set(SAME_SPACE):
            self.assign(to, source)
        elif first.text == "hsv" and last.text in SAME_SPACE:
            self.emit("hsv_to_rgb", self.own(to), self.own(source))
        else:
            raise ValueError(f"script turns colours from {first.text} to {last.text}, which is not supported")

    def noise(self, op: Instruction) -> None:
        to, *place = op.arguments
        kind = place.pop(0).text if place and place[0].type == "string" else op.name
        if to.width != 1 or kind not in ("noise", "snoise", "perlin", "uperlin") or not 0 < len(place) <= 2:
            raise ValueError(f"script uses noise of the kind {kind} and of {to.type}s, which is not supported")
        registers = [self.as_float(symbol, i) for symbol in place for i in range(symbol.width)]
        found = self.made(f"perlin{len(registers)}", self.together(registers))
        if kind in ("noise", "uperlin"):
            half = self.constant(0.5)
            found = self.made("add", self.made("mul", found, half), half)
        self.emit("copy", self.own(to), found)

    def of_vectors(self, op: Instruction) -> None:
        to, *symbols = op.arguments
        vectors = [[self.as_float(symbol, i) for i in range(3)] for symbol in symbols]
        if op.name == "dot":
            found = [self.made("dot", *(self.together(own) for own in vectors))]
        elif op.name == "luminance":
            weights = [self.constant(part) for part in LUMINANCE]
            found = [self.made("dot", self.together(vectors[0]), weights[0])]
        elif op.name == "cross":
            pairs = ((1, 2), (2, 0), (0, 1))
            found = [self.made("cross_term", *(self.together([own[i], own[j]]) for own in vectors)) for i, j in pairs]
        else:
            if op.name == "distance":
                vectors = [[self.made("sub", a, b) for a, b in zip(*vectors, strict=True)]]
            first = self.together(vectors[0])
            size = self.made("sqrt", self.made("dot", first, first))
            found = [size]
            if op.name == "normalize":
                share = self.made("div", self.constant(1.0), size)  # 0 of 0
                found = [self.made("mul", part, share) for part in vectors[0]]
        for i, register in enumerate(found):
            self.emit("copy", self.own(to, i), register)

    def element(self, op: Instruction) -> None:
        to, source, index = op.arguments
        if source.length is None and index.known is not None:
            part = self.own(source) + min(max(int(index.known[0]), 0), 2)
            self.assign(to, Symbol("temp", "float", "", register=part))
            return
        for i, (first, place, length) in enumerate(self.places(source, index)):
            own = self.emit("load", self.temporary(), first, place, length)
            of_source = Symbol("temp", "int" if source.is_int else "float", "", register=own)
            self.emit("copy", self.own(to, i), self.as_int(of_source) if to.is_int else self.as_float(of_source))

    def set_element(self, op: Instruction) -> None:
        to, index, source = op.arguments
        for i, (first, place, length) in enumerate(self.places(to, index)):
            self.emit("store", first, place, self.as_int(source, i) if to.is_int else self.as_float(source, i), length)

    def places(self, array: Symbol, index: Symbol) -> list[tuple[int, int, int]]:
        """The first register of each component of an element, the register of the index, and the length."""
        place = self.as_int(index)
        if array.length is None:
            return [(self.own(array), place, 3)]
        if array.width == 1:
            return [(self.own(array), place, max(array.length, 1))]
        last, zero, three = (self.constant(n, is_int=True) for n in (max(array.length, 1) - 1, 0, 3))
        place = self.made("int_mul", self.made("int_max", self.made("int_min", place, last), zero), three)
        return [(self.own(array, i), place, 3 * max(array.length, 1) - 2) for i in range(3)]

    def sine_and_cosine(self, op: Instruction) -> None:
        angle, sine, cosine = op.arguments
        for i in range(sine.width):
            a = self.made("copy", self.as_float(angle, i))
            self.emit("sin", self.own(sine, i), a)
            self.emit("cos", self.own(cosine, i), a)

    def clamp(self, op: Instruction) -> None:
        to, x, low, high = op.arguments
        names = ("int_max", "int_min") if to.is_int else ("max", "min")
        for i in range(to.width):
            a, b, c = (self.as_int(s, i) if to.is_int else self.as_float(s, i) for s in (x, low, high))
            self.emit(names[1], self.own(to, i), self.made(names[0], a, b), c)

    def mix(self, op: Instruction) -> None:
        to, a, b, share = op.arguments
        if _all(share, 0.0) or _all(share, 1.0) or a is b:
            self.assign(to, b if _all(share, 1.0) else a)
            return
        for i in range(to.width):
            x, y, t = (self.as_float(symbol, i) for symbol in (a, b, share))
            second = self.made("mul", y, t)
            if not _all(a, 0.0):
                second = self.made("add", self.made("mul", x, self.made("sub", self.constant(1.0), t)), second)
            self.emit("copy", self.own(to, i), second)

    def select(self, op: Instruction) -> None:
        to, if_false, if_true, condition = op.arguments
        for i in range(to.width):
            chosen = self.truth(condition, i)
            self.emit("select", self.own(to, i), chosen, self.as_float(if_true, i), self.as_float(if_false, i))


def _all(symbol: Symbol, value: float) -> bool:
    """Whether a symbol is known to be the same number in all components."""
    return symbol.known is not None and all(own == value for own in symbol.known)


def _computed(name: str, a: Symbol, b: Symbol, to: Symbol) -> list[float]:
    x, y = (np.resize(np.array(s.known, np.float64), to.width) for s in (a, b))
    if to.is_int:
        found = {"add": x + y, "sub": x - y, "mul": x * y, "div": np.trunc(x / y)}[name]
        return [float((int(value) + 2**31) % 2**32 - 2**31) for value in found]
    x, y = x.astype(np.float32), y.astype(np.float32)
    with np.errstate(all="ignore"):
        found = x + y if name == "add" else x - y if name == "sub" else x * y if name == "mul" else x / y
    return [float(value) for value in found]
