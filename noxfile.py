# SPDX-License-Identifier: MIT
"""Tests of the add-on with versions of Blender beside that of .venv; `./dev test --all` runs them."""

from __future__ import annotations

from pathlib import Path

import nox

# Versions of CPython, Blender and numpy that go together.
BLENDERS = [("3.11", "4.2", "numpy>=1.26,<2"), ("3.11", "5.0", "numpy>=1.26,<2"), ("3.13", "5.2", "numpy>=2")]
ROOT = Path(__file__).parent
LAMPS = [f"tests/blender/test_{name}.py" for name in ("light_matrix", "lights_of_instances", "seen_lamps")]
# They need no Blender, another one, or shlight installed.
LEFT_OUT = [f"tests/blender/test_{name}.py" for name in ("debian_blender", "preview", "survey", "examples")]


@nox.session(reuse_venv=True)
@nox.parametrize(("python", "blender", "numpy"), BLENDERS, ids=[blender for _, blender, _ in BLENDERS])
def blender(session: nox.Session, blender: str, numpy: str) -> None:
    """The tests on lamps in full, the others of the add-on without the slow ones."""
    project = nox.project.load_toml("pyproject.toml")
    needed = [*project["project"]["dependencies"], *project["project"]["optional-dependencies"]["test"]]
    session.install(f"bpy=={blender}.*", numpy, "matplotlib", *needed, *project["build-system"]["requires"])
    if session.python != "3.11":  # whose module is that of .venv
        build = f"build/blender-{blender}"
        executable = f"-DPython_EXECUTABLE={session.virtualenv.location}/bin/python"
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DSHLIGHT_ALL_TARGETS=OFF"]
        session.run("cmake", "-S", ".", "-B", build, "-G", "Ninja", *options, executable, external=True)
        session.run("cmake", "--build", build, "--target", "_core", external=True)
    path = ":".join(str(ROOT / name) for name in ("python_bindings", "blender_addon", "tools"))
    others = ["-m", "not slow", "tests/blender", *(f"--ignore={name}" for name in LAMPS + LEFT_OUT)]
    zipped = ["tests/extension/test_dist.py::test_the_zip_is_an_extension"]
    for tests in (LAMPS, others, zipped):
        session.run("python", "-m", "pytest", "-q", *tests, *session.posargs, env={"PYTHONPATH": path})
