# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender add-on: the render engine "shlight", noise-free direct light from area lights."""

import atexit
import importlib.util
import sys
from pathlib import Path

bl_info = {
    "name": "shlight",
    "author": "The shlight authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine",
    "description": "Noise-free direct light from area lights with spherical harmonics",
    "category": "Render",
}


def _find_native_package() -> None:
    """In the source tree the package `shlight` lies beside the add-on and need not be installed."""
    package = Path(__file__).resolve().parents[2] / "python_bindings"
    if importlib.util.find_spec("shlight") is None and (package / "shlight" / "__init__.py").is_file():
        sys.path.append(str(package))


_find_native_package()


def register() -> None:
    """Adds the engine, its scene settings and its panels to Blender. Does nothing where they are."""
    import bpy

    from . import engine, panels, preferences, properties

    if properties.are_registered():
        return
    preferences.register()
    properties.register()
    engine.register()
    panels.register()
    if getattr(bpy.app, "module", False):
        # Python with the module bpy hangs at its end while an add-on's classes are registered.
        atexit.register(unregister)


def unregister() -> None:
    """Stops renders and removes everything that `register` added. Does nothing where it is removed."""
    from . import engine, panels, preferences, properties

    if not properties.are_registered():
        return
    atexit.unregister(unregister)
    engine.unregister()
    panels.unregister()
    preferences.unregister()
    properties.unregister()
