"""The panel beside the scene: buttons, and what is known in words."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

from palpate.view import words
from palpate.view.picture import Look

if TYPE_CHECKING:
    from palpate.view.server import Viewer

WIDTH = 440  # pixels
ALL = "all"
ACTIONS = ("recognize", "plan", "touch", "undo")
FILE = "palpate.html"


class Panel:
    """Shows what a viewer shows, and hands on what is pressed."""

    def __init__(self, server: Any, viewer: Viewer) -> None:
        """On a viser server."""
        self._viewer = viewer
        self._gui = server.gui
        self._changing = False
        self._gui.configure_theme(show_logo=False, show_share_button=False)
        self._gui.main_panel.dock_right()
        self._gui.main_panel.set_width(WIDTH)
        self._status = self._gui.add_html("")
        self._add_actions()
        self._answer = self._gui.add_html("")
        tabs = self._gui.add_tab_group()
        with tabs.add_tab("path"):
            self._reasons = self._gui.add_html("")
        with tabs.add_tab("tree"):
            self._add_button("grow the ambiguity tree", "growing the tree", viewer.session.grow_tree)
            self._tree = self._gui.add_html("")
        with tabs.add_tab("contacts"):
            self._add_contacts()
        with tabs.add_tab("history"):
            self._add_history()
        with tabs.add_tab("look"):
            self._add_looks()

    @property
    def adds_by_clicks(self) -> bool:
        """Whether a click on a part adds a contact."""
        return bool(self._clicks.value)

    @property
    def look(self) -> Look:
        """What is to be seen."""
        chosen = None if self._chosen.value == ALL else int(self._chosen.value) - 1
        return Look(chosen, self._samples.value, self._bounds.value, self._truth.value)

    def offer(self, count: int) -> None:
        """So many hypotheses to choose from."""
        names = [ALL, *(str(number + 1) for number in range(count))]
        if tuple(names) != tuple(self._chosen.options):
            self._changing = True
            try:
                self._chosen.options = names
                self._chosen.value = ALL
            finally:
                self._changing = False

    def say(self, text: str, *, bad: bool = False) -> None:
        """What is going on; nothing once it is over, though something may still be at work."""
        if self._viewer.over:
            return
        self._status.content = words.panel(
            f'<p class="{"bad" if bad else ""}" role="status">{escape(text)}</p>', "status"
        )

    def tell(self) -> None:
        """All of it anew."""
        viewer, session, state = self._viewer, self._viewer.session, self._viewer.state
        self._changing = True
        try:
            self._answer.content = words.panel(words.answer(session, state, viewer.look), "answer")
            self._reasons.content = words.panel(words.reasons(session, state), "reasons")
            self._tree.content = words.panel(words.tree_words(session, state), "tree")
            self._evidence.content = words.panel(words.evidence(state), "evidence")
            self._story.content = words.panel(words.story(session.states, viewer.shown), "story")
            self._range.content = words.panel(words.range_words(session, state, viewer.look), "range")
            self._answers.content = words.panel(f"<p>{words.truth_words(session, state)}</p>", "truth")
            last = len(session.states) - 1
            self._moment.max = max(1, last)
            self._moment.value = viewer.shown
            self._moment.disabled = last == 0
        finally:
            self._changing = False

    def _add_actions(self) -> None:
        session = self._viewer.session
        doing = {
            "recognize": ("recognizing", session.recognize),
            "plan": ("planning", session.plan),
            "touch": ("touching", session.touch),
            "undo": ("going back", session.undo),
        }
        group = self._gui.add_button_group("next", ACTIONS)
        group.on_click(lambda event: self._viewer.do(*doing[event.target.value]))

    def _add_button(self, name: str, saying: str, action: Any) -> None:
        self._gui.add_button(name).on_click(lambda event: self._viewer.do(saying, action))

    def _add_contacts(self) -> None:
        session = self._viewer.session
        axes = "x, y" if session.dimension == 2 else "x, y, z"
        self._gui.add_html(words.panel(f"<p>{words.sensor_line(session)}</p>", "sensor"))
        self._clicks = self._gui.add_checkbox(
            "by clicks", initial_value=True, hint="A click on a part adds a contact there."
        )
        place = self._gui.add_text("centre", initial_value="", hint=f"Of the tip: {axes}")
        reads = session.sensor.normal_error is not None
        hint = "Outward, of any length; empty: not sensed." if reads else "The way in which the tip came."
        toward = self._gui.add_text("normal" if reads else "approach", initial_value="", hint=hint)

        def add() -> None:
            centre = numbers_of(place.value, session.dimension, "centre")
            way = numbers_of(toward.value, session.dimension, "normal") if toward.value.strip() else None
            session.add_contact(session.contact_of(centre, way if reads else None, None if reads else way))

        self._add_button("add this contact", "adding a contact", add)
        self._evidence = self._gui.add_html("")

    def _add_history(self) -> None:
        self._moment = self._gui.add_slider("moment", min=0, max=1, step=1, initial_value=0)
        self._moment.on_update(lambda event: self._go_to(int(self._moment.value)))
        self._gui.add_button("play").on_click(lambda event: self._viewer.play())
        save = self._gui.add_button(
            "save as a page", hint=f"{FILE}: one file, for any browser, without a network."
        )
        save.on_click(lambda event: self._save(event.client))
        self._story = self._gui.add_html("")

    def _add_looks(self) -> None:
        self._chosen = self._gui.add_dropdown("hypothesis", [ALL], initial_value=ALL)
        self._samples = self._gui.add_checkbox("sampled poses", initial_value=False)
        self._bounds = self._gui.add_checkbox("places of corners", initial_value=False)
        self._range = self._gui.add_html("")
        self._truth = self._gui.add_checkbox("what answers", initial_value=False)
        self._answers = self._gui.add_html("")
        for control in (self._chosen, self._samples, self._bounds, self._truth):
            control.on_update(lambda event: self._look_anew())
        self._gui.add_button("look at all").on_click(lambda event: self._viewer.fit())

    def _go_to(self, number: int) -> None:
        if not self._changing and 0 <= number < len(self._viewer.session.states):
            self._viewer.show(number)

    def _look_anew(self) -> None:
        if not self._changing:
            # Bounds take their time.
            self.say("drawing …")
            self._viewer.show()
            self.say("")

    def _save(self, client: Any) -> None:
        if client is not None:
            client.send_file_download(FILE, self._viewer.page().encode(), save_immediately=True)


def numbers_of(text: str, count: int, name: str) -> list[float]:
    """So many numbers, between commas or blanks.

    Raises:
        ValueError: Others.
    """
    try:
        values = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        values = []
    if len(values) != count:
        raise ValueError(f"{name}: must be {count} numbers (got {text!r}); write them as 1.5, 20")
    return values
