"""Campaigns: one task for each of many numbers, here or on a Dask cluster; each row is on disk as it comes.

A file of rows is JSON lines: a header (`schemas/rows-1.json`), then a row for each number, in their order. At
every moment it is the beginning of what it will be, so that a run that was killed goes on from there, and the
rows are the same bit for bit wherever they were computed and however often that was stopped. Only what a row
says under "seconds" depends on the machine.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from palpate import __version__
from palpate.experiments.build import build

Row: TypeAlias = dict[str, Any]
CLUSTER_HELP = "local, local:N, or the address of a Dask scheduler; else this process alone"
SCHEMA, VERSION = "palpate-rows", 1


def run(  # noqa: PLR0917 - what is computed, by what, and where it goes
    name: str,
    settings: dict[str, Any],
    numbers: Iterable[int],
    task: Callable[..., Row],
    file: str | Path,
    *,
    cluster: str | None = None,
    progress: Progress | None = None,
    quiet: bool = False,
) -> list[Row]:
    """The rows of all numbers, in their order; those in `file` already are not computed again.

    Args:
        name: Of the campaign; the file's header has it.
        settings: What `task` is given beside a number; JSON. The file's header has them.
        numbers: One row is computed for each.
        task: `task(number, **settings)` returns a row, JSON. A function of a module, so that other processes
            find it; same arguments, same row, but for what it says under "seconds".
        file: Where the rows go, each as soon as it and all before it are there.
        cluster: None: this process. `"local"` or `"local:N"`: N processes of this machine, one for each core
            if N is not given. Else the address of a Dask scheduler, such as `"tcp://10.0.0.5:8786"`.
        progress: Where a bar is shown; None: one of its own on stderr, if that is a terminal.
        quiet: Say nothing of how far it is, where there is no terminal.

    Returns:
        The rows as they are read from the file, each with its "number".

    Raises:
        ValueError: A file of another campaign, build or numbers; a cluster that is none; Dask is missing;
            another build of palpate on a worker.
        ConnectionError: The cluster is lost, or a task ended its worker too often.
    """
    file, wanted = Path(file), sorted(set(numbers))
    header = _header(name, settings)
    known = _taken_up(file, header)
    missing = [number for number in wanted if number not in known]
    if missing and known and missing[0] < max(known):
        raise ValueError(f"file: {str(file)!r} holds rows of other numbers; name another one, or remove it")
    if missing:
        computed = _computed(task, settings, numbers=missing, cluster=cluster)
        with Bar(progress, name, total=len(wanted), done=len(wanted) - len(missing), quiet=quiet) as advance:
            for number, row in _written(file, computed):
                known[number] = row
                advance()
    return [known[number] for number in wanted]


def read(file: str | Path) -> tuple[Row, list[Row]]:
    """The header of a file and its rows, those that are there; a last line that was cut short is left out.

    Raises:
        ValueError: If it is not a file of rows.
    """
    whole = Path(file).read_bytes().rpartition(b"\n")[0]
    try:
        header, *rows = [json.loads(line) for line in whole.splitlines()]
        if header["schema"] == SCHEMA and header["version"] == VERSION:
            return header, rows
    except (ValueError, LookupError, TypeError):
        pass
    raise ValueError(f"file: {str(file)!r} is not a file of rows of this version; name another one")


def without_times(row: Row) -> Row:
    """A row without what depends on the machine."""
    return {key: value for key, value in row.items() if key != "seconds"}


def _header(name: str, settings: dict[str, Any]) -> Row:
    header = {
        "schema": SCHEMA,
        "version": VERSION,
        "palpate": __version__,
        "build": build(),
        "name": name,
        "settings": settings,
    }
    as_read: Row = json.loads(json.dumps(header, allow_nan=False))
    return as_read


def _taken_up(file: Path, header: Row) -> dict[int, Row]:
    """The rows on disk, which is made ready for more. A last line that was cut short is cut off."""
    there = file.read_bytes() if file.exists() else b""
    whole = there[: there.rfind(b"\n") + 1]
    if not whole:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(_line(header))
        return {}
    known, rows = read(file)
    if known != header:
        differing = next(key for key in header if known.get(key) != header[key])
        raise ValueError(
            f"file: {str(file)!r} holds other rows ({differing} is {known.get(differing)!r}, "
            f"not {header[differing]!r}); name another one, or remove it"
        )
    if whole != there:
        with file.open("r+b") as opened:
            opened.truncate(len(whole))
    return {row["number"]: row for row in rows}


def _computed(
    task: Callable[..., Row], settings: dict[str, Any], *, numbers: list[int], cluster: str | None
) -> Iterator[tuple[int, Row]]:
    if cluster is None:
        return ((number, task(number, **settings)) for number in numbers)
    from palpate.experiments.cluster import computed_on

    return computed_on(cluster, task, settings, numbers=numbers)


def _written(file: Path, computed: Iterator[tuple[int, Row]]) -> Iterator[tuple[int, Row]]:
    """Each row as it will be read when the campaign is taken up again."""
    with file.open("ab") as opened:
        for number, row in computed:
            line = _line({"number": number, **row})
            opened.write(line)
            opened.flush()
            os.fsync(opened.fileno())
            yield number, json.loads(line)


def _line(row: Row) -> bytes:
    return json.dumps(row, separators=(",", ":"), allow_nan=False).encode() + b"\n"


class Bar:
    """A bar, on `progress` or one of its own; without a terminal, a line for every tenth, unless `quiet`."""

    def __init__(
        self, progress: Progress | None, name: str, *, total: int, done: int = 0, quiet: bool = False
    ) -> None:
        self._quiet = quiet
        self._own = progress is None
        self._progress = progress or _own_progress()
        self._name, self._total, self._done = name, total, done
        self._task = self._progress.add_task(name, total=total, completed=done)

    def __enter__(self) -> Callable[[], None]:
        if self._own:
            self._progress.start()
        return self._advance

    def __exit__(self, *_: object) -> None:
        if self._own:
            self._progress.stop()

    def _advance(self) -> None:
        self._progress.advance(self._task)
        self._done += 1
        if self._quiet or not self._progress.disable:
            return
        if self._done * 10 // self._total != (self._done - 1) * 10 // self._total:
            line = f"{self._name}: {self._done} of {self._total}"
            Console(stderr=True, width=110).print(line, highlight=False)


def _own_progress() -> Progress:
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
