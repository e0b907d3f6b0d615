# SPDX-License-Identifier: MIT
"""Loads the compiled core with its own libraries.

Blender keeps Embree 4 and oneTBB in the process' global symbol scope. A module linked to another Embree would bind to
those functions instead: no error, but every ray misses. RTLD_DEEPBIND makes the module look in its own libraries first.
"""

from __future__ import annotations

import importlib
import os
import sys
from types import ModuleType


def load_core() -> ModuleType:
    """Imports and returns shlight._core; the interpreter's dlopen flags are as before afterwards."""
    if not hasattr(os, "RTLD_DEEPBIND"):
        return importlib.import_module("shlight._core")
    flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_DEEPBIND)
    try:
        return importlib.import_module("shlight._core")
    finally:
        sys.setdlopenflags(flags)
