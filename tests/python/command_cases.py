# SPDX-License-Identifier: MIT
"""What the tests of commands that measure share: what a folder holds, and parts put in place of the real ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest


def names(folder: Path) -> list[str]:
    """Of its files."""
    return sorted(path.name for path in folder.iterdir())


def putter(monkeypatch: pytest.MonkeyPatch, name: str, *modules: ModuleType) -> Callable[..., None]:
    """Puts others in place of the parts that these modules know by this name."""

    def put(*others: object) -> None:
        for module in modules:
            monkeypatch.setattr(module, name, list(others))

    return put
