"""viser, which is loaded when a viewer is made, and not before; its servers, without their words."""

from __future__ import annotations

import contextlib
import io
import socket
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
        ValueError: viser is not installed; an address at which this machine can't listen.
    """
    viser = load_viser()
    _check_host(host)
    with contextlib.redirect_stdout(io.StringIO()):
        return viser.ViserServer(host=host, port=port, label="palpate", verbose=False)


def _check_host(host: str) -> None:
    """Refuse what viser would try for ever."""
    try:
        family, *_, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, socket.SOCK_STREAM) as tried:
            tried.bind(address)
    except OSError as error:
        raise ValueError(
            f"host: can't listen at {host!r} ({error.strerror or error}); give an address of this machine, "
            "or 0.0.0.0 for all of them"
        ) from None


def stop_quietly(server: Any) -> None:
    """End it without a word."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()
