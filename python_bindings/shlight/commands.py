# SPDX-License-Identifier: MIT
"""What the commands of `shlight` share: how they end, and where results wait until they are complete."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from pathlib import Path
from typing import NoReturn

# Exit codes that shells report for processes ended by SIGINT, SIGPIPE and SIGTERM.
INTERRUPTED, PIPE_CLOSED, TERMINATED = 130, 141, 143


class CommandError(Exception):
    """A command cannot go on. text: for the user. exit_code: 2 for a bad request, 1 for a failure on the way."""

    def __init__(self, text: str, exit_code: int) -> None:
        super().__init__(text)
        self.exit_code = exit_code


class Parser(argparse.ArgumentParser):
    """Says on one line what is wrong with a command line, and raises SystemExit(2)."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def run_command(command: str, work: Callable[[], None], *, when_interrupted: str) -> int:
    """Does the work and returns the exit code of the command; what ends it early is said in one line.

    command: as the user called it, such as "shlight render".
    """

    def complain(text: str, exit_code: int) -> int:
        print(f"{command}: {text}", file=sys.stderr)
        return exit_code

    try:
        with _terminable():
            work()
    except SystemExit as stop:  # the options were not understood, and that was said; or terminated
        return stop.code if isinstance(stop.code, int) else 1
    except KeyboardInterrupt:
        return complain(f"interrupted; {when_interrupted}", INTERRUPTED)
    except CommandError as error:
        return complain(str(error), error.exit_code)
    except BrokenPipeError:
        raise  # standard output was closed; run_to_exit says so
    except OSError as error:
        return complain(f"{error.filename}: {error.strerror}" if error.filename else str(error), 2)
    return 0


def run_to_exit(program: str, work: Callable[[], int]) -> int:
    """Does all that a program does and returns its exit code; an interrupt and a closed output are said in one line."""
    try:
        code = work()
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print(f"{program}: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Python flushes stdout once more when it exits; that must not fail a second time.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        print(f"{program}: standard output was closed before all was written", file=sys.stderr)
        return PIPE_CLOSED


def check_folder(out: Path) -> None:
    """Raises CommandError where no folder of this name can be made, because a file is in the way."""
    nearest = next(path for path in (out, *out.parents) if path.exists())
    if not nearest.is_dir():
        raise CommandError(f"{nearest} is a file; --out wants a folder", 2)


@contextmanager
def work_folder(out: Path) -> Iterator[Path]:
    """A temporary folder on the file system of `out`; gone afterwards, whatever happens."""
    place = next(folder for folder in (out.absolute(), *out.absolute().parents) if folder.is_dir())
    try:
        folder = tempfile.TemporaryDirectory(prefix=".shlight-", dir=place)
    except OSError as error:
        raise CommandError(f"cannot write to {out}: {error.strerror}", 2) from None
    with folder as name:
        yield Path(name)


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Ctrl-C waits meanwhile, and never reaches threads and processes that begin meanwhile: they end with this one."""
    resource_tracker.ensure_running()  # it would be begun with the first process, and end the block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _terminable() -> Iterator[None]:
    """A polite request to end (SIGTERM) cleans up as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(*_: object) -> NoReturn:
        raise SystemExit(TERMINATED)

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
