# SPDX-License-Identifier: GPL-3.0-or-later
"""The script that another Blender runs: it makes the add-on a package of the name it has in the first one.

usage: <Blender or Python> start.py -- <package> <sys.path> <module of the worker> <folder> <file descriptor>
"""

import importlib
import importlib.util
import os
import sys
from pathlib import Path

import bpy  # noqa: F401 - before the path grows: it has to be the one of this Blender

ADDON = Path(__file__).resolve().parent


def main() -> None:
    """Serves the request."""
    package, path, worker, *arguments = sys.argv[sys.argv.index("--") + 1 :]
    sys.path += [folder for folder in path.split(os.pathsep) if folder not in sys.path]
    spec = importlib.util.spec_from_file_location(
        package, ADDON / "__init__.py", submodule_search_locations=[str(ADDON)]
    )
    assert spec is not None
    assert spec.loader is not None
    sys.modules[package] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[package])
    importlib.import_module(f"{package}.{worker}").main(arguments)


if __name__ == "__main__":
    main()
