# SPDX-License-Identifier: GPL-3.0-or-later
"""The package `shlight` with its native module, which the add-on renders with.

In the source tree it lies beside the add-on. The add-on's zip has it in wheels: Blender 4.2 and later unpack those of
an extension, and of a legacy add-on they are unpacked here, into the add-on's own folder, with which they go.
"""

from __future__ import annotations

import contextlib
import importlib.util
import re
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Collection
from pathlib import Path

ADDON = Path(__file__).resolve().parent
WHEELS = ADDON / "wheels"
SOURCE_TREE = ADDON.parents[1] / "python_bindings"
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"
MANIFEST = ADDON / "blender_manifest.toml"


def _version() -> str:
    return re.findall(r'^version = "(.+)"', MANIFEST.read_text(encoding="utf-8"), re.MULTILINE)[0]


RUNNING = _version()  # Blender 3.4 goes on with the modules it has when another version is installed

_unpacking_problem = ""
_unpacked: Path | None = None  # what `import` finds


def numpy_problem() -> str:
    """Says what to install where Blender's Python lacks numpy, as Debian's may; empty if it has it."""
    if importlib.util.find_spec("numpy") is not None:
        return ""
    return "Blender's Python lacks numpy: install it ('apt install python3-numpy' on Debian) and restart Blender"


def find_packages() -> None:
    """Makes `import shlight` work where Blender does not see to that itself."""
    global _unpacking_problem, _unpacked
    if WHEELS.is_dir() and not __package__.startswith("bl_ext."):
        try:
            _unpacked = _unpack()
            _add_to_path(_unpacked)
        except (OSError, zipfile.BadZipFile) as error:
            _unpacking_problem = f"its wheels cannot be unpacked into {WHEELS} ({error})"
    elif importlib.util.find_spec("shlight") is None and (SOURCE_TREE / "shlight" / "__init__.py").is_file():
        _add_to_path(SOURCE_TREE)


def forget_packages() -> None:
    """Undoes `find_packages`; what is imported stays until Blender ends."""
    if _unpacked is not None and str(_unpacked) in sys.path:
        sys.path.remove(str(_unpacked))


def _add_to_path(folder: Path) -> None:
    if str(folder) not in sys.path:
        sys.path.append(str(folder))


def _unpack() -> Path:
    """Unpacks the wheels for this Python, all or nothing, whatever other Blenders do at the same time.

    Returns the folder. What another version has left in WHEELS is removed: Blender 3.4 installs one over the other.
    """
    named = re.findall(r'"\./wheels/(.+?)"', MANIFEST.read_text(encoding="utf-8"))
    wheels = [WHEELS / name for name in named if f"-{TAG}-" in name]
    folder = WHEELS / f"unpacked-{TAG}-{max((wheel.stat().st_mtime_ns for wheel in wheels), default=0)}"
    if not folder.is_dir():
        part = Path(tempfile.mkdtemp(prefix=".part-", dir=WHEELS))
        try:
            for wheel in wheels:
                with zipfile.ZipFile(wheel) as archive:
                    # The add-on that runs is this one.
                    names = [name for name in archive.namelist() if not name.startswith("shlight_blender/")]
                    archive.extractall(part, names)
            part.chmod(0o755)
            try:
                part.rename(folder)
            except OSError:
                if not folder.is_dir():
                    raise
        finally:
            shutil.rmtree(part, ignore_errors=True)
    _remove_others(named, folder)
    return folder


def _remove_others(named: Collection[str], unpacked: Path) -> None:
    """Removes wheels that are not named and what was unpacked before, unless this process uses it."""
    used = Path(getattr(sys.modules.get("shlight"), "__file__", None) or unpacked / "shlight/__init__.py").parents[1]
    with contextlib.suppress(OSError):  # others' files
        for old in WHEELS.iterdir():
            if old.suffix == ".whl" and old.name not in named:
                old.unlink()
            elif old.name.startswith(f"unpacked-{TAG}") and old not in {unpacked, used}:
                shutil.rmtree(old)


def native_problem() -> str:
    """Why the package cannot be used and what to do; empty if it can."""
    if problem := numpy_problem():
        return problem
    try:
        import shlight
        from shlight import render  # noqa: F401
    except ImportError as error:
        return f"the Python package 'shlight' cannot be loaded ({_unpacking_problem or error}): {_advice()}"
    wanted = _version()
    if wanted != RUNNING:
        return f"version {wanted} of the add-on is installed, and version {RUNNING} is running: restart Blender"
    if WHEELS.is_dir() and shlight.__version__ != wanted:
        return (
            f"the add-on is version {wanted}, and the Python package 'shlight' in {Path(shlight.__file__).parent} is "
            f"version {shlight.__version__}: restart Blender; if that does not help, remove other copies of the add-on "
            "or that package"
        )
    return ""


def _advice() -> str:
    pythons = _pythons_of_wheels()
    if not pythons:
        return (
            f"install it with '{sys.executable} -m pip install <shlight's source tree>', or enable the add-on of a "
            f"source tree where './dev setup' has built it for Python {PYTHON}; restart Blender"
        )
    if PYTHON not in pythons:
        return f"this Blender has Python {PYTHON}, and this zip is for {' and '.join(pythons)}; use another Blender"
    return "install the add-on's zip again and restart Blender"


def _pythons_of_wheels() -> list[str]:
    """Versions of Python that the add-on has wheels for; none in the source tree."""
    tags = {match for wheel in WHEELS.glob("shlight-*.whl") for match in re.findall(r"-cp(3)(\d+)-cp", wheel.name)}
    return [f"{major}.{minor}" for major, minor in sorted(tags, key=lambda tag: int(tag[1]))]
