"""Libraries of the extra `palpate[sim]`, imported when they are needed."""

from __future__ import annotations

import importlib
from typing import Any


def library(name: str) -> Any:
    """The module of this name.

    Raises:
        ValueError: It is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ValueError(
            f"the rig needs {name}, which is not installed; install it with: pip install 'palpate[sim]'"
        ) from None
