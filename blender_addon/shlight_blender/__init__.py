# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender add-on: the render engine "shlight", noise-free direct light from area lights."""

import atexit

from .native import find_packages, forget_packages, numpy_problem

bl_info = {
    "name": "shlight",
    "author": "The shlight authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine",
    "description": "Noise-free direct light from area lights with spherical harmonics",
    "category": "Render",
}


find_packages()


def register() -> None:
    """Adds the engine, its scene settings and its panels to Blender. Does nothing where they are.

    Without numpy only the preferences are added, which say so.
    Raises RuntimeError if they are those of another copy of the add-on.
    """
    import bpy

    from . import preferences

    if problem := numpy_problem():
        print(f"shlight: {problem}")
        preferences.register()
        return
    from . import engine, properties, running
    from .compare import registration
    from .osl import operators
    from .ui import panels

    if properties.are_registered():
        return
    other = bpy.types.RenderEngine.bl_rna_get_subclass_py(running.ENGINE)
    if other is not None and not other.__module__.startswith(f"{__name__}."):
        copy = other.__module__.rpartition(".")[0]
        raise RuntimeError(f"shlight is enabled already, as {copy}; disable that in Preferences > Add-ons first")
    find_packages()
    preferences.register()
    properties.register()
    engine.register()
    panels.register()
    registration.register()
    operators.register()
    if not bpy.app.binary_path:
        # Python with the module bpy hangs or crashes at its end while an add-on's classes are registered.
        atexit.register(unregister)


def unregister() -> None:
    """Stops renders and removes everything that `register` added. Does nothing where it is removed."""
    from . import preferences

    if numpy_problem():
        preferences.unregister()
        return
    from . import engine, properties
    from .compare import registration
    from .osl import operators
    from .ui import panels

    if not properties.are_registered():
        return
    atexit.unregister(unregister)
    engine.unregister()
    registration.unregister()
    operators.unregister()
    panels.unregister()
    preferences.unregister()
    properties.unregister()
    forget_packages()
