# SPDX-License-Identifier: GPL-3.0-or-later
"""The package `shlight` with its native module, which the add-on renders with."""

from __future__ import annotations

import functools
import sys


@functools.cache
def native_problem() -> str:
    """Why the package cannot be used and what to do; empty if it can."""
    try:
        from shlight import render  # noqa: F401
    except ImportError as error:
        return (
            f"the Python package 'shlight' cannot be loaded ({error}): install it with "
            f"'{sys.executable} -m pip install <shlight's source tree>', or enable the add-on of a source tree where "
            f"'./dev setup' has built it for Python {sys.version_info.major}.{sys.version_info.minor}; restart Blender"
        )
    return ""
