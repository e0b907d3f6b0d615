# SPDX-License-Identifier: MIT
"""Lets the tests import their shared helpers from this directory; fixtures that several files use."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

sys.path.append(str(Path(__file__).parent))


@pytest.fixture
def register(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Registers further methods; all of them give 1.001 times what "exact" gives."""
    from shlight import methods
    from shlight.charts.lights import Lights

    real_methods, real = methods.coefficient_methods(), Lights.coefficients

    def coefficients(self: Lights, method: str, *arguments: object, **named: object) -> object:
        if method in real_methods:
            return real(self, method, *arguments, **named)
        known = {key: value for key, value in named.items() if key not in ("samples", "tolerance")}
        return real(self, "exact", *arguments, **known) * 1.001

    def add(*others: SimpleNamespace) -> None:
        all_methods = real_methods | {other.name: other for other in others}
        monkeypatch.setattr(methods, "coefficient_methods", lambda: all_methods)
        monkeypatch.setattr(Lights, "coefficients", coefficients)

    return add
