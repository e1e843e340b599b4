"""The viewer in a browser: hypotheses, contacts, paths, and what each answer would tell.

    session = Session(models, sensor, contacts=contacts)
    session.recognize()
    session.plan()
    save_page(session, "found.html")     # one file, for any browser, without a network
    serve(session)                       # a page to work in, until Ctrl-C

`Session` is what is known and what was done; it needs no viewer. `serve` and `save_page` need viser:
`pip install "palpate[view]"`.
"""

from palpate.view.export import save_page
from palpate.view.opening import NO_VISER
from palpate.view.server import Viewer, serve
from palpate.view.session import Session
from palpate.view.state import Left, Move, Placement, State, Truth

__all__ = [
    "NO_VISER",
    "Left",
    "Move",
    "Placement",
    "Session",
    "State",
    "Truth",
    "Viewer",
    "save_page",
    "serve",
]
