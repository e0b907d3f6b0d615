# SPDX-License-Identifier: MIT
"""Loads native modules with their own Embree.

Official Blenders keep Embree 4 in the process' global symbol scope. A module linked to another Embree would bind to
those functions instead: no error, but every ray misses. RTLD_DEEPBIND makes the module look in its own libraries first.
It is used only there, because it also binds the module to the C library's allocator: Debian's Blender replaces that
allocator, and runs on the very Embree that the module is linked to.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import os
import re
import sys
from pathlib import Path
from types import ModuleType


def load_native(name: str) -> ModuleType:
    """Imports and returns a module such as shlight._core; the interpreter's dlopen flags are as before afterwards."""
    if not _foreign_embree_is_global(name):
        return importlib.import_module(name)
    flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_DEEPBIND)
    try:
        return importlib.import_module(name)
    finally:
        sys.setdlopenflags(flags)


def _foreign_embree_is_global(name: str) -> bool:
    """Whether Embree's functions are in the global scope, but not those of the library that a module is linked to."""
    maps = Path("/proc/self/maps")
    if not hasattr(os, "RTLD_DEEPBIND") or not maps.is_file():
        return False
    if not hasattr(ctypes.CDLL(None), "rtcNewDevice"):
        return False
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        return False
    # In a wheel the library's name has a hash behind the version.
    own = re.search(rb"(libembree\d+)(-\w+)?\.so", Path(spec.origin).read_bytes())
    return own is None or re.search(own.group(1) + rb"(-\w+)?\.so", maps.read_bytes()) is None
