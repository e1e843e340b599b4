"""The command line: one command a module, and what they share.

Results go to stdout, progress to stderr and only on a terminal. Bad input is one line on stderr and exit
code 2.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

BAD_INPUT = 2
INTERRUPTED = 130  # 128 + SIGINT, as shells have it
BROKEN_PIPE = 141  # 128 + SIGPIPE


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with `arguments`, the process's own by default; returns the exit code."""
    try:
        return _run(arguments)
    except KeyboardInterrupt:
        return INTERRUPTED


def _run(arguments: Sequence[str] | None) -> int:
    # Imported here, so that an interrupt while they load, which takes a while, is heard by `main`.
    from typer.exceptions import Abort, TyperException

    from palpate.cli.app import app
    from palpate.cli.console import PROGRAM, complain

    # None if the process was started with its stdout closed. The type of it doesn't say so.
    if getattr(sys, "stdout", None) is None:
        complain("standard output is closed; leave it open, or send it to a file")
        return BAD_INPUT
    try:
        status = app(args=arguments, prog_name=PROGRAM, standalone_mode=False)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone, as in `palpate ... | head`.
        _write_no_more()
        return BROKEN_PIPE
    except TyperException as error:
        complain(error.format_message())
        return BAD_INPUT
    except OSError as error:
        problem = error.strerror or str(error)
        named = isinstance(error, (FileNotFoundError, NotADirectoryError, IsADirectoryError, PermissionError))
        remedy = "; check its name, its folder, and their permissions" if named else ""
        complain(f"{error.filename}: {problem}{remedy}" if error.filename else problem)
        _write_no_more()
        return BAD_INPUT
    except ValueError as error:
        complain(str(error))
        return BAD_INPUT
    except Abort:
        return INTERRUPTED
    return status if isinstance(status, int) else 0


def _write_no_more() -> None:
    """Python would write what is left when it ends, and complain that it can't."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
