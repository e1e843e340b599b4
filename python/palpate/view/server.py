"""The page to work in: a session drawn by viser, with a panel beside it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from palpate.view.export import page_of
from palpate.view.opening import HOST, quiet_server, stop_quietly
from palpate.view.panel import Panel
from palpate.view.picture import Look, frame_of, shapes_of
from palpate.view.scene import Scene
from palpate.view.session import Session
from palpate.view.state import State

PORT = 8080
PAUSE_S = 0.9  # between moments that are played


class Viewer:
    """A session in a browser. Whatever is pressed is done to `session`; everyone who looks sees the same."""

    def __init__(self, session: Session, *, host: str = HOST, port: int = PORT) -> None:
        """Open it.

        Args:
            session: What is shown; it is the viewer's from here on.
            host: The address to listen at: of this machine alone, unless told otherwise.
            port: The port; the next free one if it is taken, any if it is 0.

        Raises:
            ValueError: viser is not installed; an address at which this machine can't listen.
        """
        self.session = session
        self.shown = len(session.states) - 1
        self.look = Look()
        self.over = False
        self._server = quiet_server(host, port)
        self._host = host
        self._doing = threading.Lock()
        self._drawing = threading.RLock()
        self._scene = Scene(self._server, dimension=session.dimension, size=session.size)
        self._panel = Panel(self._server, self)
        self.show()

    @property
    def url(self) -> str:
        """Where it is."""
        host = "localhost" if self._host in ("0.0.0.0", "::") else self._host
        return f"http://{host}:{self._server.get_port()}"

    @property
    def busy(self) -> bool:
        """Whether something is being done."""
        return self._doing.locked()

    @property
    def state(self) -> State:
        """The one that is shown."""
        states = self.session.states
        return states[min(self.shown, len(states) - 1)]

    def stop(self) -> None:
        """End it."""
        self.over = True
        stop_quietly(self._server)

    def do(self, saying: str, action: Callable[[], object]) -> None:
        """Something that takes its time, on the last state; one at a time. What is refused is said."""
        if not self._doing.acquire(blocking=False):
            self._panel.say("Still at work: wait until it is done.", bad=True)
            return
        try:
            self._panel.say(f"{saying} …")
            began = time.perf_counter()
            action()
            self.shown = len(self.session.states) - 1
            self.show()
            self._panel.say(f"{self.session.state.said} ({time.perf_counter() - began:.2g} s)")
        except ValueError as error:
            self._panel.say(str(error), bad=True)
        finally:
            self._doing.release()

    def clicked(self, model_number: int, event: Any) -> None:
        """A part was clicked: there it was touched."""

        def add() -> None:
            own = [one for one in self.session.placements(self.state) if one.model_number == model_number]
            placement = own[event.instance_index or 0]
            self.session.add_contact(
                self.session.contact_on(placement, event.ray_origin, event.ray_direction)
            )

        if not self._panel.adds_by_clicks:
            return
        if self.shown != len(self.session.states) - 1:
            self._panel.say("This is an earlier moment: go to the last one to add contacts.", bad=True)
            return
        self.do("adding a contact", add)

    def show(self, number: int | None = None) -> None:
        """A moment, by its place in the history; None: the one that is shown, anew."""
        with self._drawing:
            if self.over:
                return
            if number is not None:
                self.shown = number
            # Someone else may have gone back meanwhile.
            self.shown = min(self.shown, len(self.session.states) - 1)
            self._panel.offer(len(self.state.hypotheses))
            self.look = self._panel.look
            shapes = shapes_of(self.session, self.state, self.look)
            self._scene.draw(shapes, self.clicked)
            self._scene.look_at(*frame_of(shapes))
            self._panel.tell()

    def fit(self) -> None:
        """Everyone looks at all that is drawn."""
        with self._drawing:
            self._scene.look_at(*frame_of(shapes_of(self.session, self.state, self.look)))
            self._scene.look_again()

    def play(self) -> None:
        """From the first moment to the last."""
        for number in range(len(self.session.states)):
            self.show(number)
            time.sleep(PAUSE_S)

    def page(self) -> str:
        """All moments as one HTML page, looked at as now."""
        return page_of(self.session, self.look)


def serve(
    session: Session,
    *,
    host: str = HOST,
    port: int = PORT,
    told: Callable[[Viewer], None] = lambda viewer: print(viewer.url, flush=True),
) -> Viewer:
    """Show a session until an interrupt (Ctrl-C).

    Args:
        session: What is shown.
        host: As for `Viewer`.
        port: As for `Viewer`.
        told: Called once it is open.

    Returns:
        The viewer, which has ended.

    Raises:
        ValueError: As `Viewer`.
    """
    viewer = Viewer(session, host=host, port=port)
    try:
        told(viewer)
        threading.Event().wait()
    except KeyboardInterrupt:
        pass
    finally:
        viewer.stop()
    return viewer
