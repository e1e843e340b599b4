"""Tasks of a campaign on a Dask cluster: spread over its workers, taken back in order.

Dask gives the task of a worker that was killed to another one. What is lost with this process is what was not
written yet: tasks are handed out only so far ahead of the one that is waited for.
"""

from __future__ import annotations

import logging
import os
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from palpate import __version__
from palpate.experiments.build import build

if TYPE_CHECKING:
    from distributed import Client, Future

    from palpate.experiments.campaign import Row

AHEAD = 8  # tasks of each worker that are handed out, so that one slow task does not keep others from work
LEAST_AHEAD = 64
ANSWERS_WITHIN = 20.0  # seconds in which a scheduler answers
BUSY = 120.0  # the same for processes of this machine, which may have more to do than it can
PATIENCE = 300.0  # seconds without any worker: a cluster that grows on demand may take minutes for its first
OFTEN = 10  # workers that may end at one task; by Dask's own default, 3, one bad moment would end a campaign


def computed_on(
    cluster: str, task: Callable[..., Row], settings: dict[str, Any], *, numbers: list[int]
) -> Iterator[tuple[int, Row]]:
    """Each number with its row, in order.

    Raises:
        ValueError: No such cluster; Dask is missing, or another build of palpate is on a worker.
        ConnectionError: The cluster is lost, or a task ended its worker too often.
    """
    try:
        import distributed  # noqa: F401 - whether it is there
    except ImportError:
        raise ValueError(
            "cluster: needs Dask, which is not installed; run pip install 'palpate[cluster]'"
        ) from None
    with ExitStack() as stack:
        client = _client(cluster, stack)
        ahead = max(LEAST_AHEAD, AHEAD * sum(client.nthreads().values()))
        waiting: deque[tuple[int, Future]] = deque()
        for number in numbers:
            waiting.append((number, client.submit(_row, task, settings, build(), number, pure=False)))
            if len(waiting) == ahead:
                yield _next(client, waiting)
        while waiting:
            yield _next(client, waiting)


def _row(task: Callable[..., Row], settings: dict[str, Any], wanted: str, number: int) -> Row:  # noqa: PLR0917
    if wanted != build():
        raise ValueError(
            f"cluster: a worker has another build of palpate {__version__} (got {build()}, not {wanted}); "
            "install the same on all"
        )
    return task(number, **settings)


def _client(cluster: str, stack: ExitStack) -> Client:
    from distributed import Client

    kind, _, count = cluster.partition(":")
    if kind == "local":
        return stack.enter_context(Client(_local(cluster, count, stack)))
    if not count:
        raise ValueError(
            f"cluster: unknown (got {cluster!r}); give local, local:N or the address of a Dask scheduler"
        )
    try:
        return stack.enter_context(Client(cluster, timeout=ANSWERS_WITHIN))
    except (OSError, ValueError):
        raise ValueError(
            f"cluster: no Dask scheduler answers at {cluster!r}; start one (dask scheduler), or give local"
        ) from None


def _local(cluster: str, count: str, stack: ExitStack) -> Any:
    import dask
    from distributed import LocalCluster

    if cluster != "local" and not (count.isascii() and count.isdigit() and int(count) > 0):
        raise ValueError(
            f"cluster: its number of processes must be 1 or more (got {cluster!r}); give local:2"
        )
    timeouts = dict.fromkeys(("connect", "tcp"), f"{BUSY:.0f}s")
    stack.enter_context(
        dask.config.set(
            {"distributed.scheduler.allowed-failures": OFTEN, "distributed.comm.timeouts": timeouts}
        )
    )
    # One thread each: the processes are what is parallel. A nanny starts a worker that was killed again.
    return stack.enter_context(
        LocalCluster(
            n_workers=int(count) if count else os.cpu_count(),
            threads_per_worker=1,
            processes=True,
            dashboard_address=":0",  # any free port: other clusters may have the usual one
            silence_logs=logging.CRITICAL,
            env={"RAYON_NUM_THREADS": "1"},
        )
    )


def _next(client: Client, waiting: deque[tuple[int, Future]]) -> tuple[int, Row]:
    from distributed import KilledWorker, TimeoutError

    number, future = waiting.popleft()
    alone_since: float | None = None
    while True:
        try:
            return number, future.result(timeout=1.0)
        except TimeoutError:
            if future.done():
                return number, future.result()  # it has just ended, or the error is the task's own
            if client.status == "closed":
                raise _lost("the connection to the scheduler is lost") from None
            if client.nthreads():
                alone_since = None
                continue
            alone_since = alone_since or time.monotonic()
            if time.monotonic() - alone_since > PATIENCE:
                raise _lost(f"it has had no worker for {PATIENCE:.0f} s") from None
        except KilledWorker:
            raise _lost(f"task {number} ended its worker again and again") from None
        except CancelledError:
            raise _lost("the connection to the scheduler is lost") from None


def _lost(why: str) -> ConnectionError:
    return ConnectionError(f"cluster: {why}; the same command goes on from what was written")
