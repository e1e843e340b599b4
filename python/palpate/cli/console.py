"""Where the command line writes, and how it waits."""

from __future__ import annotations

import io
import os
import sys
import threading
from collections.abc import Callable
from typing import TypeVar

from rich.console import Console

PROGRAM = "palpate"

Result = TypeVar("Result")


def results() -> Console:
    """For results: stdout. In colour on a terminal, plain text and never wrapped elsewhere."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a ° that an old terminal can't show is no reason to fail
    console = Console(highlight=False, emoji=False)  # a part may be called :car:
    if not console.is_terminal:
        console.width = 110
    return console


def complain(message: str) -> None:
    """One line on stderr, if there is one."""
    line = " ".join(message.split())
    if getattr(sys, "stderr", None) is not None:  # None if the process was started with it closed
        sys.stderr.write(f"{PROGRAM}: {line}\n")


def patiently(work: Callable[[], Result], *, saying: str) -> Result:
    """The result of `work`, which may take long: a spinner on a terminal; an interrupt is heard at once."""
    outcome: list[Result] = []
    failure: list[BaseException] = []

    def run() -> None:
        try:
            outcome.append(work())
        except BaseException as error:  # raised again below, in the main thread
            failure.append(error)

    # The core doesn't look for signals while it computes, the main thread does while it waits.
    worker = threading.Thread(target=run, daemon=True)
    console = Console(stderr=True)
    try:
        worker.start()
        if console.is_terminal:
            with console.status(saying):
                _wait_for(worker)
        else:
            _wait_for(worker)
    except KeyboardInterrupt:
        # Ends the worker too, which a return from here would not.
        sys.stdout.flush()
        os._exit(130)
    if failure:
        raise failure[0]
    return outcome[0]


def _wait_for(worker: threading.Thread) -> None:
    while worker.is_alive():
        worker.join(timeout=0.1)
