"""viser, which is loaded when a viewer is made, and not before; its servers, without their words."""

from __future__ import annotations

import contextlib
import io
from importlib import import_module
from typing import Any

HOST = "127.0.0.1"
NO_VISER = 'the viewer needs viser, which is not installed; pip install "palpate[view]"'


def load_viser() -> Any:
    """The module.

    Raises:
        ValueError: It is not installed.
    """
    try:
        return import_module("viser")
    except ImportError as error:
        if (error.name or "").partition(".")[0] != "viser":
            raise
        raise ValueError(NO_VISER) from None


def quiet_server(host: str, port: int) -> Any:
    """A viser server that prints nothing.

    Raises:
        ValueError: viser is not installed.
        OSError: The address can't be had.
    """
    viser = load_viser()
    with contextlib.redirect_stdout(io.StringIO()):
        return viser.ViserServer(host=host, port=port, label="palpate", verbose=False)


def stop_quietly(server: Any) -> None:
    """End it without a word."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()
