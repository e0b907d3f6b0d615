# SPDX-License-Identifier: MIT
"""What pickles of the core's objects name, beside their class."""

from __future__ import annotations

from typing import Any


def restored(kind: Any, state: Any) -> Any:
    return kind._from_state(state)
