"""The command line: `palpate demo`, `palpate recognize`, `palpate models`.

Results go to stdout, progress to stderr and only on a terminal. Bad input is one line on stderr and exit
code 2.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from typer.exceptions import Abort, TyperException

from palpate.cli.app import app
from palpate.cli.console import PROGRAM, complain

BAD_INPUT = 2
INTERRUPTED = 130  # 128 + SIGINT, as shells have it
BROKEN_PIPE = 141  # 128 + SIGPIPE

__all__ = ["app", "main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with `arguments`, the process's own by default; returns the exit code."""
    try:
        status = app(args=arguments, prog_name=PROGRAM, standalone_mode=False)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone, as in `palpate ... | head`. Python would complain when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except TyperException as error:
        complain(error.format_message())
        return BAD_INPUT
    except OSError as error:
        problem = error.strerror or str(error)
        complain(f"{error.filename}: {problem}" if error.filename else problem)
        return BAD_INPUT
    except ValueError as error:
        complain(str(error))
        return BAD_INPUT
    except (KeyboardInterrupt, Abort):
        return INTERRUPTED
    return status if isinstance(status, int) else 0
