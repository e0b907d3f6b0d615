# SPDX-License-Identifier: MIT
"""Pictures of models and of scenes that scripts build with shlight, for the command `shlight render`."""

from __future__ import annotations

import ast
import errno
import os
import runpy
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from shlight._core import Scene
from shlight.commands import CommandError
from shlight.images import read_environment
from shlight.models import SUFFIXES, load
from shlight.progress import Progress
from shlight.rendering import render

BUILDERS = ("build_scene", "build")  # functions of scripts that return a Scene
SIZE = (960, 640)


def is_still(path: Path) -> bool:
    """Whether a file is a model, or a script that uses shlight without Blender."""
    if path.suffix.lower() in SUFFIXES:
        return True
    if path.suffix.lower() != ".py":
        return False
    try:
        script = ast.parse(path.read_bytes(), str(path))
    except SyntaxError:
        return False
    imported = set()
    for node in ast.walk(script):
        if isinstance(node, ast.Import):
            imported |= {name.name.partition(".")[0] for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            imported.add(node.module.partition(".")[0])
    return "shlight" in imported and "bpy" not in imported


def render_still(
    path: Path,
    out: Path,
    *,
    size: tuple[int, int],
    environment: Path | None,
    settings: Mapping[str, Any],
    threads: int,
) -> None:
    """Renders a model or a script's scene to a .png or .exr file.

    environment: a picture of all directions, as Scene.set_environment takes it. settings: keywords of `render`.
    Raises CommandError, ValueError or OSError where that cannot be.
    """
    if out.suffix.lower() not in (".png", ".exr"):
        raise ValueError(f"out must end in .png or .exr, got '{out}'")
    _check_writable(out)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = load(path) if path.suffix.lower() in SUFFIXES else _built(path)
    for warning in caught:
        print(f"shlight render: {warning.message}", file=sys.stderr)
    if environment is not None:
        scene.set_environment(read_environment(environment))
    bar = Progress(1)
    bar.begin(f"rendering {path.name}")
    try:
        given = {name: _value(text) for name, text in settings.items()}
        result = render(scene, *size, threads=threads, progress=bar.step, **given)
    except TypeError as error:
        raise ValueError(f"--set: {error}") from None
    finally:
        bar.interrupt()
    result.save(out)
    report = result.report
    assert report is not None
    if report.dark:
        raise CommandError(f"{out} is black: {report.dark}; --environment FILE gives it a sky", 1)
    print(f"{out}: {report.build_seconds + report.render_seconds:.1f} s, noise {report.noise:.2g}")


def _check_writable(out: Path) -> None:
    """Raises the OSError that a file would meet after its render."""
    folder = out.absolute().parent
    known = os.access in os.supports_effective_ids
    problem = errno.ENOENT
    if folder.is_dir():
        problem = 0 if os.access(folder, os.W_OK, effective_ids=known) else errno.EACCES
    if problem:
        raise OSError(problem, os.strerror(problem), str(out))


def _built(path: Path) -> Scene:
    sys.path.insert(0, str(path.parent))
    try:
        names = runpy.run_path(str(path))
        build = next((names[name] for name in BUILDERS if name in names), None)
        if build is None:
            raise CommandError(f"{path}: there is no function {' or '.join(BUILDERS)}() in it", 2)
        scene = build()
    except CommandError:
        raise
    except Exception as error:
        raise CommandError(f"{path}: {type(error).__name__}: {error}", 1) from error
    finally:
        sys.path.remove(str(path.parent))
    if not isinstance(scene, Scene):
        raise CommandError(f"{path}: {build.__name__}() must return a shlight.Scene, got {type(scene).__name__}", 2)
    return scene


def _value(text: Any) -> Any:
    """A setting as Python writes it; what is not Python is a string."""
    try:
        return ast.literal_eval(text)
    except (SyntaxError, ValueError):
        return text
