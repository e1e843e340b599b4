"""A session as one HTML page: every moment of it, to be turned about in any browser, without a network."""

from __future__ import annotations

import json
import os
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

from palpate.view import words
from palpate.view.opening import HOST, quiet_server, stop_quietly
from palpate.view.picture import Look, frame_of, shapes_of
from palpate.view.scene import Scene
from palpate.view.session import Session

DATA = 'window.__VISER_EMBED_DATA__="'


def save_page(session: Session, path: str | Path, *, look: Look | None = None) -> None:
    """Write a session to a file.

    Args:
        session: What is shown; all its moments.
        path: The file.
        look: What is to be seen; the places of corners too, if not given.

    Raises:
        ValueError: viser is not installed; a folder, or a file in a folder that is not there.
    """
    path = Path(path)
    check_page_path(path)
    text = page_of(session, look)
    # Whole or not at all.
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        partial.write_text(text, encoding="utf-8")
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def check_page_path(path: Path) -> None:
    """Refuse a page that could not be saved, before the work that leads to it."""
    if path.is_dir():
        raise ValueError(f"{path}: is a folder; give the name of a file in it")
    if path.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"{path}: a page can't be saved as {path.suffix!r}; name it .html")
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}; make it first")


def page_of(session: Session, look: Look | None = None) -> str:
    """The page.

    Raises:
        ValueError: viser is not installed.
    """
    look = Look(bounds=True) if look is None else look
    # One that nobody looks at: its scene is taken from it, moment by moment.
    server = quiet_server(HOST, 0)
    try:
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        scene = Scene(server, dimension=session.dimension, size=session.size)
        pages: list[str] = []
        for state in session.states:
            shapes = shapes_of(session, state, look)
            scene.draw(shapes)
            scene.look_at(*frame_of(shapes))
            pages.append(server.get_scene_serializer().as_html())
    finally:
        stop_quietly(server)
    scenes = [page.partition(DATA)[2].partition('"')[0] for page in pages]
    before, _, rest = pages[0].partition(DATA)
    after = rest.partition('"')[2]
    last = len(scenes) - 1
    page = resources.files("palpate.view").joinpath("page.html").read_text(encoding="utf-8")
    return Template(page).substitute(
        title=escape(f"palpate: {', '.join(session.labels[:6])}{', …' if len(session.labels) > 6 else ''}"),
        last=last,
        moments="\n".join(_moment(session, number, look) for number in range(len(scenes))),
        client=_script([before + DATA, '"' + after]),
        scenes=_script(scenes),
    )


def _moment(session: Session, number: int, look: Look) -> str:
    state = session.states[number]
    parts = [
        (state.said.capitalize(), words.answer(session, state, look)),
        ("What is drawn", words.range_words(session, state, look)),
        ("Why this path", words.reasons(session, state) if state.path is not None or state.why else ""),
        ("Ambiguity tree", words.tree_words(session, state) if state.tree is not None else ""),
        ("Contacts", f"<p>{words.sensor_line(session)}</p>{words.evidence(state)}"),
        ("History", words.story(session.states, number)),
    ]
    body = "".join(f"<h2>{escape(title)}</h2>{words.panel(text, 'moment')}" for title, text in parts if text)
    return f'<section data-moment="{number}">{body}</section>'


def _script(value: Any) -> str:
    """JSON in a script element: what would end it is written otherwise."""
    return json.dumps(value).replace("</", "<\\/").replace("<!--", "<\\!--")
