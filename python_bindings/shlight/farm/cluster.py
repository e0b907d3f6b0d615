# SPDX-License-Identifier: MIT
"""The workers: those of a scheduler, or processes on this machine that end with this one."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from shlight.commands import CommandError, interrupts_blocked
from shlight.farm.pictures import Source
from shlight.farm.tasks import Result, Task, perform_on_worker
from shlight.farm.tls import Tls

# A frame that has taken down so many workers is given up; of a scheduler elsewhere its own configuration counts.
WORKER_DEATHS = 2
CONNECT_SECONDS = 15
POLL_SECONDS = 0.5
LOST = "the scheduler is lost; the same command started again goes on"


def check_dask() -> None:
    """Raises CommandError where Dask distributed is missing."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise CommandError("Dask distributed is missing: pip install 'shlight[farm]'", 1) from None


@contextmanager
def connected(scheduler: str | None, workers: int, tls: Tls | None, say: Callable[[str], None]) -> Iterator[Any]:
    """A client of the scheduler of this address, or of one on this machine with so many workers."""
    check_dask()
    import dask
    from distributed import Client, LocalCluster

    settings = {
        "distributed.scheduler.allowed-failures": WORKER_DEATHS - 1,
        # A large scene holds Python's lock for long while it is exported.
        "distributed.scheduler.worker-ttl": None,
        "distributed.admin.tick.limit": "1h",
        # A paused worker would wait for ever: the scene stays open. One that takes too much is ended.
        "distributed.worker.memory.pause": False,
        "distributed.comm.timeouts.connect": f"{CONNECT_SECONDS}s",
    }
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        security = tls.security() if tls else None
        address: Any = scheduler
        if scheduler is None:
            with interrupts_blocked():
                address = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    host="127.0.0.1",
                    protocol="tls" if tls else "tcp",
                    security=security,
                    dashboard_address="127.0.0.1:0",
                    silence_logs="CRITICAL",
                )
            stack.callback(_close, address)
        try:
            client = Client(address, security=security, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise CommandError(f"no connection to the scheduler {scheduler}: {error}", 1) from None
        stack.callback(_close, client)
        # Without bokeh it is a page of links.
        has_dashboard = scheduler is not None or importlib.util.find_spec("bokeh") is not None
        if has_dashboard and "dashboard" in client.scheduler_info().get("services", {}):
            say(f"dashboard: {client.dashboard_link}")
        yield client


def _close(what: Any) -> None:
    with suppress(Exception):  # of a scheduler that is gone
        what.close(timeout=5)


class Workers:
    """Tasks under way on a cluster."""

    def __init__(
        self, client: Any, source: Source, threads: int, say: Callable[[str], None], archive: Path | None
    ) -> None:
        self._client = client
        self._source, self._threads = source, threads
        self._say = say
        self._tasks: dict[Any, Task] = {}
        self._said: set[str] = set()
        if archive is not None:
            client.upload_file(str(archive), load=False)
        client.subscribe_topic("all", self._hear)

    def submit(self, task: Task) -> None:
        """Gives a task to the cluster, which begins those first that came first."""
        own = self._client.cluster is not None
        future = self._client.submit(perform_on_worker, self._source, task, self._threads, own, pure=False)
        self._tasks[future] = task

    def ended(self) -> list[tuple[Task, Callable[[], Result]]]:
        """Tasks that have ended, each with what gives its result or raises; none after half a second."""
        from distributed import wait

        with self._client.as_current(), suppress(TimeoutError, CancelledError):
            wait(list(self._tasks), timeout=POLL_SECONDS, return_when="FIRST_COMPLETED")
        if self._client.status != "running" or any(future.status in ("cancelled", "lost") for future in self._tasks):
            raise CommandError(LOST, 1)
        done = [future for future in self._tasks if future.done()]
        if not done:
            self._say_what_hinders()
        return [(self._tasks.pop(future), self._result_of(future)) for future in done]

    def _say_what_hinders(self) -> None:
        """Once, of workers that do nothing; the tasks that they were given wait."""
        with suppress(OSError, TimeoutError):
            workers = self._client.scheduler_info()["workers"]
            hindrances = {
                f"worker {address} is paused, since it lacks memory"
                for address, worker in workers.items()
                if worker["status"] == "paused"
            }
            if not workers and not self._client.nthreads():  # the client's own refresh can leave the first one empty
                hindrances.add("the scheduler has no workers")
            for hindrance in sorted(hindrances - self._said):
                self._say(f"waiting: {hindrance}")
            self._said |= hindrances

    def _result_of(self, future: Any) -> Callable[[], Result]:
        def result() -> Result:
            from distributed import KilledWorker

            try:
                return future.result(timeout=10 * CONNECT_SECONDS)
            except KilledWorker as error:
                deaths = f"{error.allowed_failures + 1} workers died while they rendered it"
                raise RuntimeError(f"{deaths}, killed or out of memory") from None
            except (CancelledError, OSError) as error:
                if isinstance(error, CancelledError) or self._client.status != "running":
                    raise CommandError(LOST, 1) from None
                raise

        return result

    def cancel(self, tasks: Callable[[Task], bool]) -> None:
        """Tasks that are not needed any more."""
        chosen = [future for future, task in self._tasks.items() if tasks(task)]
        for future in chosen:
            del self._tasks[future]
        self._client.cancel(chosen)

    def close(self) -> None:
        """Leaves the cluster without these tasks."""
        with suppress(Exception):  # of a scheduler that is gone
            self._client.unsubscribe_topic("all")
            self.cancel(lambda _: True)

    def _hear(self, event: Any) -> None:
        message = event[1]
        if message.get("action") == "remove-worker" and not message.get("expected"):
            lost = len(message.get("processing-tasks", ()))
            self._say(f"worker {message.get('worker')} is lost" + (f"; {lost} of its tasks begin anew" if lost else ""))


def core_count() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def default_workers(tasks: int) -> int:
    """Processes on this machine: one for each core, as far as there is work for them."""
    return max(1, min(tasks, core_count()))
