# SPDX-License-Identifier: MIT
"""Scripts of Open Shading Language, whose instructions the core interprets hit by hit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from shlight import _core
from shlight.nodes import inputs as sources
from shlight.nodes.oso import Instruction, Script, Symbol, parse
from shlight.nodes.values import Color, Value, Varying, Vector, color, number, steps, vector

GLOBALS: dict[str, Callable[[], Value | Vector]] = {
    "P": sources.position,
    "N": sources.normal,
    "Ng": sources.geometric_normal,
    "I": sources.towards_viewer,
    "u": lambda: sources.barycentric().x,
    "v": lambda: sources.barycentric().y,
}
# Functions by component, which have the same name in the core.
FUNCTIONS = frozenset(
    "floor ceil round trunc sign step smoothstep sqrt inversesqrt cbrt pow exp exp2 expm1 log log2 log10 logb erf erfc "
    "sin cos tan asin acos atan atan2 sinh cosh tanh isnan isinf isfinite".split()
)
INTEGER_ONLY = frozenset(("bitand", "bitor", "xor", "compl", "shl", "shr", "and", "or"))
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
NOTHING = frozenset(("nop", "end", "useparam", "printf", "fprintf", "warning", "error"))
SPARE = 4  # registers after the last one, as instructions of several registers need them
MOST_REGISTERS, MOST_NESTED = 1 << 20, 100
MOST_NUMBERS = 128, 32  # of inputs and outputs
# Functions whose value only spaces of these names leave as it is.
SAME_SPACE = ("common", "world", "rgb", "RGB")


@dataclass(frozen=True)
class CoreScript:
    """A script as the core has it; equal ones are one."""

    code: bytes
    registers: bytes
    arguments: int
    results: tuple[int, ...]

    @property
    def core(self) -> tuple[Any, Any, int, list[int]]:
        """The arguments of the core."""
        code, registers = (np.frombuffer(words, np.uint32) for words in (self.code, self.registers))
        return code, registers, self.arguments, list(self.results)


def osl(script: str, /, **inputs: Varying) -> dict[str, Value | Vector]:
    """The outputs, by name, of a script of Open Shading Language that was compiled by oslc.

    script: the text of the .oso file. inputs: the script's parameters by name; those that are left out have the values
        that the script gives them. Numbers, vectors and colours are supported, not closures, matrices, textures,
        derivatives and attributes. A script that jumps back a million times ends there.
    Functions are rounded as in Cycles. Raises ValueError naming the argument, also where the script uses what is not
    supported.
    """
    known, arguments = [], []
    parsed = parse(script)
    for name, given in inputs.items():
        symbol = parsed.symbols.get(name)
        if symbol is None or symbol.kind != "param" or symbol.length is not None or not symbol.default:
            raise ValueError(f"{name} is no number, vector or colour that the script asks for")
        parts = [number(given, name)] if symbol.width == 1 else list(vector(given, name))
        constants = [part.constant for part in parts]
        if None in constants:
            arguments.append((name, parts))
        else:
            known.append((name, tuple(constants)))
    core, read, outputs = _translated(script, tuple(known), tuple(name for name, _ in arguments))
    values = [part for _, parts in arguments for part in parts]
    for name in read:
        found = GLOBALS[name]()
        values += [found] if isinstance(found, Value) else list(found)
    made = iter(steps("script", *values, data=core))
    results: dict[str, Value | Vector] = {}
    for name, kind in outputs:
        if kind in ("float", "int"):
            results[name] = next(made)
        else:
            results[name] = (Color if kind == "color" else Vector)(next(made), next(made), next(made))
    return results


@lru_cache(maxsize=64)
def _translated(
    script: str, known: tuple[tuple[str, tuple[float, ...]], ...], given: tuple[str, ...]
) -> tuple[CoreScript, list[str], list[tuple[str, str]]]:
    """The core's script; names of globals that it reads after its arguments; names and types of outputs."""
    return _Translation(parse(script), dict(known), given).result()


@lru_cache(maxsize=1)
def _numbers() -> dict[str, int]:
    return {name: i for i, name in enumerate(_core.script_instructions())}


class _Translation:
    """Lists the core's instructions of a script, one for each component.

    What is known of inputs counts: a product with a constant 0 is 0 whatever the other factor is, as in Cycles, which
    optimizes a script for its inputs.
    """

    def __init__(self, script: Script, known: dict[str, tuple[float, ...]], given: tuple[str, ...]) -> None:
        self.script, self.known = script, known
        self.code: list[list[int]] = []
        self.registers: list[np.uint32] = []
        self.loops: list[tuple[list[int], list[int]]] = []  # jumps of `break` and of `continue`
        self.returns: list[list[int]] = []
        self.depth = 0
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
        symbols = script.symbols.values()
        self.arguments = [script.symbols[name] for name in given]
        used = {argument.name for op in script.code for argument in op.arguments}
        self.globals = [s for s in symbols if s.kind == "global" and s.name in used and s.name in GLOBALS]
        for symbol in [*self.arguments, *self.globals]:
            symbol.register = self.reserve([0.0] * symbol.width)
        self.argument_count = len(self.registers)
        for symbol in symbols:
            if symbol not in self.globals and symbol not in self.arguments:
                self.place(symbol)

    def place(self, symbol: Symbol) -> None:
        """Gives a symbol registers, with what it holds at first."""
        if symbol.type not in ("float", "int", "color", "point", "vector", "normal") or symbol.kind == "global":
            return
        size = symbol.width * (symbol.length if symbol.length is not None else 1)
        if symbol.kind == "param" and symbol.name in self.known:
            symbol.default, symbol.is_initialized = list(self.known[symbol.name]), False
        values = (symbol.default + [0.0] * size)[:size]
        if symbol.kind in ("param", "const") and symbol.writes == 0 and not symbol.is_initialized:
            symbol.known = tuple(values)
        symbol.register = self.reserve(values, is_int=symbol.is_int)

    def result(self) -> tuple[CoreScript, list[str], list[tuple[str, str]]]:
        for symbol in self.arguments:
            if symbol.is_int:
                self.emit("to_int", symbol.register, symbol.register)
        for name, (first, last) in self.script.first_values.items():
            symbol = self.script.symbols.get(name)
            if symbol is not None and symbol not in self.arguments and name not in self.known:
                self.block(first, last)
        self.returns.append([])
        self.block(self.script.begin, len(self.script.code))
        self.land(self.returns.pop())
        results: list[int] = []
        outputs = [s for s in self.script.symbols.values() if s.kind == "oparam" and s.register >= 0]
        outputs = [s for s in outputs if s.length is None]
        for symbol in outputs:
            results += [self.as_float(symbol, i) for i in range(symbol.width)]
        if self.argument_count > MOST_NUMBERS[0] or len(results) > MOST_NUMBERS[1]:
            raise ValueError("script has too many inputs or outputs")
        code = np.array(self.code, np.uint32).tobytes()
        registers = np.array([*self.registers, *[0] * SPARE], np.uint32).tobytes()
        core = CoreScript(code, registers, self.argument_count, tuple(results))
        return core, [s.name for s in self.globals], [(s.name, s.type) for s in outputs]

    # Registers

    def reserve(self, values: list[float], *, is_int: bool = False) -> int:
        """The first of registers that hold these values at first."""
        if len(self.registers) + len(values) > MOST_REGISTERS:
            raise ValueError("script has arrays that are too large")
        first = len(self.registers)
        with np.errstate(over="ignore", invalid="ignore"):
            made = np.array(values, np.float64)
            made = made.astype(np.int64).astype(np.int32) if is_int else made.astype(np.float32)
        self.registers += list(made.view(np.uint32))
        return first

    def temporary(self, size: int = 1) -> int:
        return self.reserve([0.0] * size)

    def constant(self, value: float, *, is_int: bool = False) -> int:
        return self.reserve([value], is_int=is_int)

    def emit(self, name: str, to: int, a: int = 0, b: int = 0, c: int = 0) -> int:
        """Adds an instruction; the register that it writes."""
        self.code.append([_numbers()[name], to, a, b, c])
        return to

    def made(self, name: str, a: int, b: int = 0, c: int = 0) -> int:
        """The same with a register of its own."""
        return self.emit(name, self.temporary(), a, b, c)

    def own(self, symbol: Symbol, i: int = 0) -> int:
        """The register of a component; a number has one for all."""
        if symbol.register < 0:
            kind = {"global": symbol.name, "closure": "closures", "string": "strings that vary", "matrix": "matrices"}
            what = kind.get("global" if symbol.kind == "global" else symbol.type, symbol.type)
            raise ValueError(f"script uses {what}, which is not supported")
        return symbol.register + (i if symbol.width == 3 else 0)

    def as_float(self, symbol: Symbol, i: int = 0) -> int:
        register = self.own(symbol, i)
        if not symbol.is_int:
            return register
        return register if symbol.known == (0.0,) else self.made("to_float", register)

    def as_int(self, symbol: Symbol, i: int = 0) -> int:
        register = self.own(symbol, i)
        return register if symbol.is_int else self.made("to_int", register)

    # Instructions that only compute

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
        """What Cycles makes of constants 0 and 1, and of two constants."""
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
        elif name == "pow" and special:
            name, *arguments = special
        for i in range(to.width):
            self.emit(name, self.own(to, i), *(self.as_float(argument, i) for argument in arguments))

    def special_power(self, to: Symbol, base: Symbol, exponent: Symbol) -> list[Any] | None:
        """What Cycles makes of powers with a constant; None where that is done, [] where there is nothing special."""
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

    def together(self, registers: list[int]) -> int:
        """The first of registers side by side that hold what others do."""
        first = self.temporary(len(registers))
        for i, register in enumerate(registers):
            self.emit("copy", first + i, register)
        return first

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
        for i, (first, place, length) in enumerate(self.places(source, index)):
            own = self.emit("load", self.temporary(), first, place, length)
            of_source = Symbol("temp", "int" if source.is_int else "float", "", register=own)
            self.emit("copy", self.own(to, i), self.as_int(of_source) if to.is_int else self.as_float(of_source))

    def set_element(self, op: Instruction) -> None:
        to, index, source = op.arguments
        for i, (first, place, length) in enumerate(self.places(to, index)):
            self.emit("store", first, place, self.as_int(source, i) if to.is_int else self.as_float(source, i), length)

    def places(self, array: Symbol, index: Symbol) -> list[tuple[int, int, int]]:
        """Of each component of an element: the first register, the register of the index, and the length."""
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

    def truth(self, symbol: Symbol, i: int = 0) -> int:
        """A register that is 0 only where a number is."""
        if symbol.is_int:
            return self.own(symbol, i)
        is_zero = self.made("equal", self.as_float(symbol, i), self.constant(0.0))
        return self.made("int_equal", is_zero, self.constant(0.0, is_int=True))

    # Instructions that jump

    def jump(self, list_of_jumps: list[int], unless: int | None = None) -> None:
        """Adds a jump to a list of those that will land at one place."""
        list_of_jumps.append(len(self.code))
        self.emit("jump" if unless is None else "jump_unless", 0, unless or 0)

    def land(self, jumps: list[int]) -> None:
        """The next instruction is where jumps lead to."""
        for place in jumps:
            self.code[place][1] = len(self.code)

    def block(self, first: int, last: int) -> None:
        """Instructions from one up to another."""
        self.depth += 1
        if self.depth > MOST_NESTED:
            raise ValueError("script has blocks that lie too deep in each other")
        while first < last:
            op = self.script.code[first]
            after = first + 1
            if op.jumps:
                ends = [after, *op.jumps]
                if ends != sorted(ends) or ends[-1] > last:
                    raise ValueError(f"script has a jump of {op.name} that leads nowhere")
                after = ends[-1]
            self.instruction(op, first)
            first = after
        self.depth -= 1

    def instruction(self, op: Instruction, place: int) -> None:
        if op.name in NOTHING:
            return
        counts = {"if": 2, "for": 4, "while": 4, "dowhile": 4, "functioncall": 1}
        if len(op.jumps) != counts.get(op.name, 0):
            raise ValueError(f"script has jumps of {op.name} that are missing")
        if op.name == "if":
            self.branch(op, place)
        elif op.name in ("for", "while", "dowhile"):
            self.loop(op, place)
        elif op.name == "functioncall":
            self.returns.append([])
            self.block(place + 1, op.jumps[0])
            self.land(self.returns.pop())
        elif op.name in ("break", "continue") and self.loops:
            self.jump(self.loops[-1][op.name == "continue"])
        elif op.name in ("return", "exit") and self.returns:
            self.jump(self.returns[-1 if op.name == "return" else 0])
        elif op.name in self.handlers:
            self.compute(op)
        else:
            raise ValueError(f"script uses {op.name}, which is not supported")

    def compute(self, op: Instruction) -> None:
        try:
            self.handlers[op.name](op)
        except (TypeError, IndexError) as error:  # another number of arguments than an instruction has
            raise ValueError(f"script uses {op.name} in a way that is not supported") from error

    def branch(self, op: Instruction, place: int) -> None:
        to_else: list[int] = []
        self.jump(to_else, unless=self.truth(op.arguments[0]))
        self.block(place + 1, op.jumps[0])
        if op.jumps[1] > op.jumps[0]:
            to_end: list[int] = []
            self.jump(to_end)
            self.land(to_else)
            self.block(*op.jumps)
            to_else = to_end
        self.land(to_else)

    def loop(self, op: Instruction, place: int) -> None:
        condition, body, step, end = op.jumps
        self.block(place + 1, condition)
        again = len(self.code)
        breaks, continues = [], []  # type: list[int], list[int]
        self.loops.append((breaks, continues))
        if op.name != "dowhile":
            self.block(condition, body)
            self.jump(breaks, unless=self.truth(op.arguments[0]))
        self.block(body, step)
        self.land(continues)
        self.block(step, end)
        if op.name == "dowhile":
            self.block(condition, body)
            self.jump(breaks, unless=self.truth(op.arguments[0]))
        self.emit("jump", again)
        self.loops.pop()
        self.land(breaks)


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
        function = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide}[name]
        return [float(value) for value in function(x, y)]
