# SPDX-License-Identifier: MIT
"""What calls say of wrong arguments: which row of a batch, and which name was meant."""

from __future__ import annotations

import ast
import difflib
import functools
import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

import numpy as np

from shlight._arrays import CORE_AXES

Function = TypeVar("Function", bound=Callable[..., Any])


def names_rows(function: Function) -> Function:
    """The function, whose errors about a row of the flat arrays, a text and its number, name the caller's row."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except ValueError as error:
            if len(error.args) != 2:
                raise
            text, row = error.args
            arguments = signature.bind(*given, **named).arguments
        raise ValueError(_with_row(text, row, arguments))

    return cast("Function", call)


def _with_row(text: str, row: int, arguments: Mapping[str, Any]) -> str:
    shapes = {
        name: np.shape(value)[: len(np.shape(value)) - CORE_AXES[name]]
        for name, value in arguments.items()
        if name in CORE_AXES
    }
    name = re.match(r"\w*", text)[0]  # type: ignore[index]
    own = shapes.get(name)
    if not own:
        return text
    index = np.unravel_index(row, np.broadcast_shapes(*shapes.values()))[-len(own) :]
    place = ", ".join(str(i if size > 1 else 0) for i, size in zip(index, own, strict=True))
    return f"{name}[{place}]{text[len(name) :]}"


def explained(function: Function) -> Function:
    """A function of the native module whose errors about arguments that it does not have are short.

    Its own list the types of all arguments.
    """
    signature = _signature(function)

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except TypeError as error:
            if "incompatible function arguments" not in str(error):
                raise
            text = _why(signature, given, named) or str(error)
        raise TypeError(text)

    del call.__wrapped__  # whoever asks about the function shall not be led to the native one
    call.__signature__ = signature  # type: ignore[attr-defined]
    call.__doc__ = (function.__doc__ or "").partition("\n")[2].strip()
    return cast("Function", call)


def explain_methods(kind: type) -> None:
    """Makes `explained` of all public methods of a class of the native module."""
    constructor: Any = vars(kind)["__init__"]
    if (constructor.__doc__ or "").startswith("__init__("):
        own = list(_signature(constructor).parameters.values())[1:]
        kind.__signature__ = inspect.Signature(own)  # type: ignore[attr-defined]
    for name, method in list(vars(kind).items()):
        if not name.startswith("_") and callable(method):
            made = explained(getattr(kind, name))
            setattr(kind, name, staticmethod(made) if isinstance(method, staticmethod) else made)


def _signature(function: Callable[..., Any]) -> inspect.Signature:
    """The signature that pybind11 writes into the first line of a docstring, without its types."""
    head = (function.__doc__ or "").partition("\n")[0]
    call: Any = ast.parse(f"def call{head[head.index('(') :]}: ...").body[0]
    listed, kinds = call.args, inspect.Parameter
    no_default = [None] * (len(listed.args) - len(listed.defaults))
    parameters = [
        kinds(own.arg, kind, default=kinds.empty if default is None else _constant(default))
        for kind, arguments, defaults in (
            (kinds.POSITIONAL_OR_KEYWORD, listed.args, [*no_default, *listed.defaults]),
            (kinds.KEYWORD_ONLY, listed.kwonlyargs, listed.kw_defaults),
        )
        for own, default in zip(arguments, defaults, strict=True)
    ]
    return inspect.Signature(parameters)


def _constant(written: ast.expr) -> Any:
    text = ast.unparse(written)
    return float(text) if text in ("inf", "-inf") else ast.literal_eval(written)


def _likeness(given: str, name: str) -> tuple[bool, float]:
    """Orders the names that a misspelt one may stand for: a part of a name is nearer to it than to others."""
    return given in name, difflib.SequenceMatcher(None, given, name).ratio()


def _why(signature: inspect.Signature, given: tuple[Any, ...], named: Mapping[str, Any]) -> str:
    """What is wrong with a call; empty if its arguments are those of the signature."""
    for name in named:
        if name not in signature.parameters:
            others = sorted(set(signature.parameters) - {"self"} - set(named))
            near = max(others, key=lambda other: _likeness(name, other), default="")
            return f"unknown argument {name!r}; did you mean {near!r}?" if near else f"unknown argument {name!r}"
    try:
        signature.bind(*given, **named)
    except TypeError as error:
        return str(error)
    return ""
