# SPDX-License-Identifier: MIT
"""Plants faults in a copy of the sources, one at a time, builds it, and reports the test that catches each.

`./dev test --faults` plants those of faults.toml, or those of them whose text holds one of the given words; with
`--random N --seed S` N others, drawn from the sources by the mutations of mutations.py. A listed fault names the test
that catches it, which runs alone; after a drawn one the quick tests run until one fails. Exits with 1 if a fault is
missed.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

from mutations import draw

ROOT = Path(__file__).parent.parent.parent
LIST = Path(__file__).parent / "faults.toml"
COMPILED = {".cpp", ".h"}
MINUTES = 20  # that tests may take; a fault that makes them hang is caught
CORE = ("ctest", "--test-dir", "build", "--label-exclude", "pytest", "--parallel", "2", "--stop-on-failure")
PYTEST = (sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider")
# test_faults.py fails as soon as a text of the list is gone, whatever took its place.
QUICK = ("-m", "not slow", "--ignore=tests/python/test_faults.py")


@dataclass(frozen=True)
class Fault:
    """A text that stands once in a file, what is put there instead, and the test that catches it ("" if not known)."""

    about: str
    file: str
    find: str
    put: str
    test: str = ""

    def planted(self, text: str) -> str:
        if text.count(self.find) != 1:
            raise ValueError(f"{self.file} has {text.count(self.find)} times {self.find!r} ({self.about})")
        return text.replace(self.find, self.put)


def listed() -> list[Fault]:
    return [Fault(**each) for each in tomllib.loads(LIST.read_text())["fault"]]


class Copy:
    """The sources in a folder of their own, built and tested there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._is_built = False  # as its sources are
        paths = ("python_bindings", "blender_addon", "tools")
        path = os.pathsep.join(str(folder / name) for name in paths)
        self._environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"}
        names = subprocess.check_output(["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=ROOT, text=True)
        for name in names.rstrip("\0").split("\0"):
            self._write(name, (ROOT / name).read_bytes())

    def _write(self, name: str, content: bytes) -> None:
        """Leaves files that have this content as they are, which then need no compiling."""
        file = self.folder / name
        if not file.is_file() or file.read_bytes() != content:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
            shutil.copymode(ROOT / name, file)
            self._is_built &= file.suffix not in COMPILED

    def _run(self, command: tuple[str, ...], minutes: float | None = None) -> tuple[bool, str]:
        """Whether a command ends well in time, and what it prints."""
        # A group of its own, so that what tests started ends with them.
        with subprocess.Popen(
            command,
            cwd=self.folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            process_group=0,
        ) as process:
            try:
                output = process.communicate(timeout=minutes and 60 * minutes)[0]
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                return False, "hangs"
        return process.returncode == 0, output

    def build(self) -> tuple[bool, str]:
        if self._is_built:
            return True, ""
        python = f"-DPython_EXECUTABLE={sys.executable}"
        done, output = self._run(("cmake", "--preset", "dev", "-B", "build", python))
        if done:
            done, output = self._run(("cmake", "--build", "build", "--target", "all", "shlight_tests"))
        self._is_built = done
        return done, output

    def caught_by(self, fault: Fault) -> str:
        """The test that fails with this fault, "the compiler", or "" if all pass."""
        content = (ROOT / fault.file).read_bytes()
        self._write(fault.file, fault.planted(content.decode()).encode())
        try:
            if not self.build()[0]:
                return "the compiler"
            commands = [command_of(fault.test)] if fault.test else quick_tests(fault.file)
            for command in commands:
                passed, output = self._run(command, MINUTES)
                if not passed:
                    return failed_test(output)
            return ""
        finally:
            self._write(fault.file, content)


def command_of(test: str) -> tuple[str, ...]:
    """The command of one test: of ctest's suites, or of pytest."""
    return (*PYTEST, *test.split()) if test.startswith("tests/") else (*CORE, "--tests-regex", f"^{test}$")


def quick_tests(file: str) -> list[tuple[str, ...]]:
    """Commands that test a file without the slow tests, those most likely to fail first."""
    core, python, blender = CORE, (*PYTEST, *QUICK, "tests/python"), (*PYTEST, *QUICK, "tests/blender")
    if file.startswith("blender_addon/"):
        return [blender, python]
    return [python, blender] if file.endswith(".py") else [core, python, blender]


def failed_test(output: str) -> str:
    for pattern in (r"^(?:FAILED|ERROR) (\S+)", r"- (\S+) \((?:Failed|Timeout|SEGFAULT|Subprocess.*|ILLEGAL)\)"):
        if found := re.search(pattern, output, re.MULTILINE):
            return found[1]
    return "hangs" if output == "hangs" else f"ended without a failed test: {output[-300:]}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="./dev test --faults", description=__doc__)
    parser.add_argument("words", nargs="*", help="plant the listed faults whose file or text holds one of them")
    parser.add_argument("--random", type=int, metavar="N", help="plant N faults drawn from the sources")
    parser.add_argument("--seed", type=int, default=1, help="of the drawn ones (default 1)")
    parser.add_argument("--folder", type=Path, default=ROOT / "build/faults", help="of the copy (default build/faults)")
    arguments = parser.parse_args()
    if arguments.random is None:
        words = arguments.words or [""]
        faults = [each for each in listed() if any(word in f"{each.file} {each.about}" for word in words)]
    else:
        faults = [Fault(*each) for each in draw(ROOT, arguments.random, arguments.seed)]
    if not faults:
        parser.error("no listed fault speaks of that")
    copy = Copy(arguments.folder.resolve())
    print("building the copy", flush=True)
    done, output = copy.build()
    if not done:
        sys.exit(output)
    missed = 0
    for number, fault in enumerate(faults, 1):
        caught = copy.caught_by(fault)
        # A listed fault is the tests' to catch.
        missed += not caught or (caught == "the compiler" and arguments.random is None)
        print(f"{number}/{len(faults)} {caught or 'MISSED'} | {fault.file}: {fault.about}", flush=True)
    print(f"{len(faults) - missed} of {len(faults)} caught")
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()
