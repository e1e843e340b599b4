"""Long work in chunks: over processes, each result on disk at once, taken up again where it was stopped."""

from __future__ import annotations

import json
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

Result = dict[str, Any]


@dataclass(frozen=True)
class Work:
    """Chunks `0..count`, what each yields, and what tells this work from any other."""

    title: str
    chunk: Callable[[int], Result]
    count: int
    header: Result


def results_of(work: Work, folder: Path, *, workers: int) -> list[Result]:
    """The results of all chunks, in their order; those in `folder` already are not computed again.

    Raises:
        ValueError: If the folder has the results of other work.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _claim(folder / "work.json", work.header)
    path = folder / "chunks.jsonl"
    known = _read(path)
    missing = [number for number in range(work.count) if number not in known]
    if missing:
        with path.open("a", encoding="utf-8") as file:
            for number, result in _compute(work, missing, workers=workers):
                line = json.dumps({"chunk": number, **result}, separators=(",", ":"))
                file.write(line + "\n")
                file.flush()
                os.fsync(file.fileno())
                # As it will be read when the work is taken up again.
                known[number] = json.loads(line)
    return [known[number] for number in range(work.count)]


def _claim(path: Path, header: Result) -> None:
    if path.exists():
        there = json.loads(path.read_text(encoding="utf-8"))
        if there != header:
            problem = f"out: {str(path.parent)!r} holds other results, of {there}"
            raise ValueError(f"{problem}: name another folder, or remove it")
    else:
        path.write_text(json.dumps(header, indent=1) + "\n", encoding="utf-8")


def _read(path: Path) -> dict[int, Result]:
    """The results on disk. A last line that was cut short is cut off."""
    if not path.exists():
        return {}
    text = path.read_bytes()
    whole = text[: text.rfind(b"\n") + 1]
    if whole != text:
        with path.open("r+b") as file:
            file.truncate(len(whole))
    lines = [json.loads(line) for line in whole.splitlines()]
    return {line.pop("chunk"): line for line in lines}


def _compute(work: Work, numbers: list[int], *, workers: int) -> Iterator[tuple[int, Result]]:
    with _progress() as progress:
        task = progress.add_task(work.title, total=work.count, completed=work.count - len(numbers))
        for number, result in _spread(work.chunk, numbers, workers):
            yield number, result
            _advance(progress, task)


def _spread(chunk: Callable[[int], Result], numbers: list[int], workers: int) -> Iterator[tuple[int, Result]]:
    # One thread each: the processes are what is parallel.
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    if workers == 1:
        for number in numbers:
            yield number, chunk(number)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_end_with_parent) as pool:
        futures: dict[Future[Result], int] = {pool.submit(chunk, number): number for number in numbers}
        try:
            for future in as_completed(futures):
                yield futures.pop(future), future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _end_with_parent() -> None:
    """A worker does not outlive the process that started it, however that ends."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _progress() -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not Console(stderr=True).is_terminal,
    )


def _advance(progress: Progress, task: TaskID) -> None:
    """One chunk further. Where there is no terminal, a line for every tenth."""
    progress.advance(task)
    state = progress.tasks[0]
    total, done = int(state.total or 0), int(state.completed)
    if progress.disable and done * 10 // total != (done - 1) * 10 // total:
        Console(stderr=True, width=110).print(
            f"{state.description}: {done} of {total} chunks", highlight=False
        )
