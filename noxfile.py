# SPDX-License-Identifier: MIT
"""Tests that take long, which `./dev test --all` runs: of the add-on with versions of Blender beside that of .venv, of
the core and the package with fuzz targets and sanitizers, and of the core for Arm."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import nox
from nox.command import CommandFailed

# Versions of CPython, Blender and numpy that go together.
BLENDERS = [("3.11", "4.2", "numpy>=1.26,<2"), ("3.11", "5.0", "numpy>=1.26,<2"), ("3.13", "5.2", "numpy>=2")]
ROOT = Path(__file__).parent
LAMPS = [f"tests/blender/test_{name}.py" for name in ("light_matrix", "lights_of_instances", "seen_lamps")]
# They need no Blender, another one, or shlight installed.
LEFT_OUT = [f"tests/blender/test_{name}.py" for name in ("debian_blender", "preview", "survey", "examples")]


def install(session: nox.Session, *packages: str) -> None:
    """These, and what the package, its tests and its build need."""
    project = nox.project.load_toml("pyproject.toml")
    needed = [*project["project"]["dependencies"], *project["project"]["optional-dependencies"]["test"]]
    session.install(*packages, "matplotlib", *needed, *project["build-system"]["requires"])


def build(session: nox.Session, folder: str, options: list[str], *targets: str) -> None:
    executable = f"-DPython_EXECUTABLE={session.virtualenv.location}/bin/python"
    session.run("cmake", *options, executable, external=True, silent=True)
    session.run("cmake", "--build", folder, "--target", *targets, external=True)


def run_each(session: nox.Session, *commands: list[str], **options: Any) -> None:
    """Runs all of them, and fails after the last if any has."""
    failed = []
    for command in commands:
        try:
            session.run(*command, **options)
        except CommandFailed:
            failed.append(" ".join(command))
    if failed:
        session.error("\n".join(failed))


@nox.session(reuse_venv=True)
@nox.parametrize(("python", "blender", "numpy"), BLENDERS, ids=[blender for _, blender, _ in BLENDERS])
def blender(session: nox.Session, blender: str, numpy: str) -> None:
    """The tests on lamps in full, the others of the add-on without the slow ones."""
    install(session, f"bpy=={blender}.*", numpy)
    if session.python != "3.11":  # whose module is that of .venv
        options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSHLIGHT_ALL_TARGETS=OFF"]
        build(session, f"build/blender-{blender}", ["-S", ".", "-B", f"build/blender-{blender}", *options], "_core")
    path = ":".join(str(ROOT / name) for name in ("python_bindings", "blender_addon", "tools"))
    others = ["-m", "not slow", "tests/blender", *(f"--ignore={name}" for name in LAMPS + LEFT_OUT)]
    zipped = ["tests/extension/test_dist.py::test_the_zip_is_an_extension"]
    runs = [["python", "-m", "pytest", "-q", *tests, *session.posargs] for tests in (LAMPS, others, zipped)]
    run_each(session, *runs, env={"PYTHONPATH": path})


FUZZ_SECONDS = 60  # of each target
# Scripts that never end take a minute under a sanitizer until they are ended.
FUZZ_OPTIONS = ["-timeout=300", "-max_len=1024", "-len_control=0", "-print_final_stats=1"]
# Python has to load these before all else.
RUNTIMES = ["libclang_rt.asan-x86_64.so", "libstdc++.so.6"]
# CPython keeps memory until it ends.
OPTIONS = {"ASAN_OPTIONS": "detect_leaks=0", "UBSAN_OPTIONS": "print_stacktrace=1"}
# Libraries that were not compiled with it, such as Embree, have an order that it does not see.
OPTIONS["TSAN_OPTIONS"] = f"ignore_noninstrumented_modules=1 suppressions={ROOT}/tests/core/threads.supp"
ONETBB = "https://github.com/uxlfoundation/oneTBB", "v2022.3.0"
# These bound their address space, of which a sanitizer takes terabytes, measure times or memory, or need Blender or
# the installed package.
NOT_SANITIZED = ["any_argument", "bench", "bench_picture", "cli", "fuzz", "load", "resources", "result_memory"]


@nox.session(python="3.11", reuse_venv=True)
def fuzz(session: nox.Session) -> None:
    """Each target of tests/fuzz, from inputs that it found before; `nox -s fuzz -- 600 polygons`: one for longer."""
    install(session)
    seconds, *names = session.posargs or [str(FUZZ_SECONDS)]
    build(session, "build/asan", ["--preset", "asan"], "shlight_fuzzers")
    runs = []
    for name in names or sorted(path.stem for path in (ROOT / "tests/fuzz").glob("*.cpp")):
        corpus = ROOT / "build/fuzz" / name
        corpus.mkdir(parents=True, exist_ok=True)
        options = [f"-max_total_time={seconds}", f"-artifact_prefix={corpus}-", *FUZZ_OPTIONS]
        runs.append([f"build/asan/tests/fuzz/fuzz_{name}", *options, str(corpus)])
    run_each(session, *runs, external=True)


def linked_package(folder: Path) -> Path:
    """The sources of the package and of the tools, as links, beside the modules of another build."""
    package = folder / "package"
    shutil.rmtree(package, ignore_errors=True)
    for source, module in ((ROOT / "python_bindings/shlight", "_core"), (ROOT / "tools/shlight_tools", "_methods")):
        links = package / source.name
        shutil.copytree(source, links, copy_function=os.symlink, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
        for library in (folder / "modules").glob(f"{module}.*.so"):
            (links / library.name).symlink_to(library)
    return package


def build_onetbb(session: nox.Session, folder: Path) -> None:
    """One that tells the sanitizer what waits for what: without that every task would be reported."""
    source, (url, version) = folder.with_name("tbb-source"), ONETBB
    if (folder / "lib").exists():
        return
    session.run("git", "clone", "-q", "--depth=1", f"--branch={version}", url, str(source), external=True)
    options = ["-DTBB_SANITIZE=thread", "-DTBB_TEST=OFF", "-DTBB_STRICT=OFF", "-DTBBMALLOC_BUILD=OFF"]
    options += ["-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DCMAKE_INSTALL_LIBDIR=lib"]
    build(session, f"{source}/build", ["-S", str(source), "-B", f"{source}/build", *options], "all")
    session.run("cmake", "--install", f"{source}/build", "--prefix", str(folder), external=True)


@nox.session(python="3.11", reuse_venv=True)
@nox.parametrize("preset", ["asan", "tsan"], ids=["asan", "tsan"])
def sanitizer(session: nox.Session, preset: str) -> None:
    """asan: addresses and undefined behaviour, in the core's tests and the quick ones of Python; tsan: threads, in the
    core's tests."""
    install(session)
    folder = ROOT / "build" / preset
    if preset == "tsan":
        build_onetbb(session, folder / "tbb")
    build(session, str(folder), ["--preset", preset], "all", "shlight_tests")
    # The sanitizer for threads of GCC 12 hangs where the system places memory at random.
    session.run("setarch", "-R", "ctest", "--preset", preset, env=OPTIONS, external=True)
    if preset == "asan":
        sanitize_python(session, folder)


def sanitize_python(session: nox.Session, folder: Path) -> None:
    found = [session.run("clang++", f"-print-file-name={name}", external=True, silent=True) for name in RUNTIMES]
    preloaded = ":".join(str(path).strip() for path in found)
    path = f"{linked_package(folder)}:{ROOT}/blender_addon"
    env = {**OPTIONS, "LD_PRELOAD": preloaded, "PYTHONPATH": path}
    left_out = [f"--ignore=tests/python/test_{name}.py" for name in NOT_SANITIZED]
    alone = ["interrupt_ends_a_long_call", "endless_loop_ends", "command_renders_models", "by_name[denoise"]
    left_out += ["-k", " and ".join(f"not {name}" for name in alone)]  # likewise
    session.run("python", "-m", "pytest", "-q", "-m", "not slow", "tests/python", *left_out, *session.posargs, env=env)


@nox.session(python="3.11", reuse_venv=True)
def arm(session: nox.Session) -> None:
    """The core's tests for 64-bit Arm, whose kernels are of NEON, by QEMU."""
    build(session, "build/arm", ["--preset", "arm"], "shlight_tests")
    session.run("ctest", "--preset", "arm", *session.posargs, external=True)
