"""What the panel says, as HTML; the same in a page that is saved."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from importlib import resources

from palpate._core import AmbiguityNode, Contact, Hypothesis, Outcome
from palpate.cli.documents import components
from palpate.cli.report import decimal
from palpate.plots.style import COLORS, at_most
from palpate.view.picture import MOST_RANGED, SAMPLES, Look, corners_each, ranged, reach
from palpate.view.session import Session, left_words, reply_words
from palpate.view.state import State

MOST_ROWS = 20
MOST_SHIFTED = 4  # hypotheses in space whose bounds are told, beside the chosen one's: they may take seconds
MOST_TOLD = 64  # corners over which it is told how far they shift
MOST_FEATURES = 3

STYLE = resources.files("palpate.view").joinpath("panel.css").read_text(encoding="utf-8")

WHY = {
    "solved": "One hypothesis is left: there is nothing to tell apart.",
    "perfect": "No path can be better: it separates all.",
    "enough": "It is as good as was asked for.",
    "best": "Proved: no usable path has a better score.",
    "inseparable": "Proved: no usable path is certain to tell any two apart.",
    "no_usable_path": "Proved: no path can be used.",
    "time": "The time limit cut the search short.",
    "effort": "The search was cut short: more effort may find a better one.",
    "searched": "The planner looked at some lines only: there may be a better one.",
    "recorded": "As it was planned in the run.",
}
STATUS = {
    "inseparable": "inseparable",
    "no_usable_path": "no usable path",
    "effort": "search cut short",
    "unexpanded": "not planned for",
}
ANSWERS = {
    "contact": "contact",
    "no_contact": "no contact",
    "either": "contact or none",
    "unexpected": "unexpected",
}


def panel(body: str, kind: str) -> str:
    """A piece of the panel, with a name by which it is found."""
    return f'<style>{STYLE}</style><div class="palpate" data-palpate="{kind}">{body}</div>'


def answer(session: Session, state: State, look: Look) -> str:
    """How much is left, and what of it."""
    if state.left is None:
        count = len(state.contacts)
        told = f"{count} contact{'' if count == 1 else 's'}" if count else "No contacts yet"
        how = "Recognize them." if count else "Click on a part where it was touched, or give numbers below."
        laid = "The parts are laid out side by side. " if len(session.models) > 1 else ""
        return f"<p><b>{told}.</b> {laid}{how}</p>"
    left = state.left
    lines = [f"<p><b>{escape(left_words(left).capitalize())}.</b></p>"]
    if state.stale:
        lines.append('<p class="bad">A contact was added since: recognize anew.</p>')
    if left.num_refuted:
        lines.append(
            f"<p>{left.num_refuted} more would explain the contacts, but not what the moves met first.</p>"
        )
    if not left.complete:
        lines.append(f'<p class="bad">The search was cut short ({left.stopped_by}): more may be left.</p>')
    if left.conflict:
        numbers = ", ".join(str(number + 1) for number in left.conflict)
        lines.append(f'<p class="bad">Contacts {numbers} can\'t hold together on any part.</p>')
    return "".join([*lines, _hypothesis_table(session, state, look)])


def evidence(state: State) -> str:
    """Contacts, misses and moves."""
    rows = [
        f"<tr><td>{number}</td><td>{_place(one.center)}, ±{one.position_error:g}</td>"
        f"<td>{_toward(one)}</td></tr>"
        for number, one in enumerate(state.contacts, start=1)
    ]
    head = "<tr><th></th><th>centre</th><th>normal, or approach</th></tr>"
    table = f"<table>{head}{''.join(rows)}</table>" if rows else "<p>No contacts.</p>"
    moves = "".join(
        f"<li>{number}: {escape(reply_words(move.reply))}</li>"
        for number, move in enumerate(state.moves, start=1)
    )
    swept = f"<p>{len(state.misses)} sweeps that touched nothing were given.</p>" if state.misses else ""
    return table + swept + (f"<p>Guarded moves:</p><ul>{moves}</ul>" if moves else "")


def reasons(session: Session, state: State) -> str:
    """Why this path: what each hypothesis can answer, and what each answer leaves."""
    path = state.path
    why = WHY.get(state.why or "", "")
    if path is None:
        text = why or "Nothing is planned: press plan."
        return f"<p>{'' if state.why in (None, 'solved') else '<b>No path.</b> '}{text}</p>"
    count = len(path.members)
    if count == 1:
        sure = "One more touch of the last hypothesis: it makes its poses tighter."
    elif path.guaranteed and path.score <= 1.0:
        sure = f"Certain: one of {count} is left, whatever it meets."
    elif path.guaranteed:
        sure = (
            f"Certain: at most {path.score:.3g} of {count} are left, in the mean; "
            f"expected {path.expected_score:.3g}."
        )
    else:
        sure = f"Nothing is certain: {path.expected_score:.3g} of {count} are expected to be left."
    direction = f"along {_place(path.direction)}"
    if len(path.direction) == 2:
        direction = f"at {math.degrees(math.atan2(path.direction[1], path.direction[0])):.1f}°"
    where = f"From {_place(path.start)} {direction}, up to {path.length:.4g} {escape(session.unit)}."
    shift = (
        f"It tells the same when it is shifted by up to {path.margin:.3g} {escape(session.unit)}."
        if path.margin > 0.0
        else ""
    )
    rows = "".join(
        f"<tr><td>{_part(session, state, one.hypothesis)}</td><td>{_prediction(one)}</td></tr>"
        for one in path.outcomes[:MOST_ROWS]
    )
    more = _more(len(path.outcomes))
    head = f"<tr><th>if it is</th><th>it answers (after, in {escape(session.unit)})</th></tr>"
    told = f"<p><b>{sure}</b> {where} {shift} {why}</p><table>{head}{rows}</table>{more}"
    return told + _leaves(session, state)


def tree_words(session: Session, state: State) -> str:
    """The ambiguity tree as nested lists."""
    tree = state.tree
    if tree is None:
        return "<p>Not grown yet: it says what to do next, whatever the last touch met.</p>"
    told = (
        f"Touches: {tree.expected_touches:.3g} expected, {tree.worst_touches} at worst; "
        f"no tree has fewer than {tree.lower_bound:.3g} expected"
    )
    return f"<p><b>{told}</b></p>{_node(session, state, tree.root)}"


def range_words(session: Session, state: State, look: Look) -> str:
    """What is drawn of the ranges of poses, and what that says."""
    if not state.hypotheses:
        return ""
    shown = ranged(state, look)
    of = (
        f"hypothesis {shown[0] + 1}"
        if look.chosen is not None
        else f"{len(shown)} of {len(state.hypotheses)}"
    )
    lines = ["Parts are drawn at one pose each, that of largest slack; the others lie around it."]
    if look.samples:
        lines.append(
            f"Pale: {SAMPLES} sampled poses each of {of}. Each is valid; there are more, and they may reach "
            "further."
        )
    if look.bounds:
        unproved = [number for number in shown if not state.hypotheses[number].proved]
        if session.dimension == 2:
            lines.append(
                f"Grey, {of}: each corner is in its polygon, whichever pose it is. No pose is outside."
            )
        else:
            lines.append(
                f"Grey, {of}: each of up to {corners_each(len(shown))} corners is in its ball, whichever "
                "pose it is: a bound, and wider than need be."
            )
        if unproved:
            lines.append("Of hypotheses that are not proved no bound is drawn: their pose is a guess.")
    if look.chosen is None and len(state.hypotheses) > MOST_RANGED and (look.samples or look.bounds):
        lines.append(f"Of the first {MOST_RANGED} only; choose one to see its range.")
    return "".join(f"<p>{line}</p>" for line in lines)


def story(states: Sequence[State], shown: int) -> str:
    """What was done, one line each."""
    rows = (
        f'<li class="{"now" if number == shown else ""}">{number}: {escape(state.said)}</li>'
        for number, state in enumerate(states)
    )
    return f"<ul>{''.join(rows)}</ul>"


def sensor_line(session: Session) -> str:
    """Bounds of readings."""
    sensor = session.sensor
    normal = (
        "no normal" if sensor.normal_error is None else f"normal ±{math.degrees(sensor.normal_error):.3g}°"
    )
    tip = f", tip radius {sensor.tip_radius:g}" if sensor.tip_radius else ""
    return f"Readings: ±{sensor.position_error:g} {escape(session.unit)}, {normal}{tip}."


def truth_words(session: Session, state: State) -> str:
    """What answers the simulated touches."""
    truth = state.truth
    if truth is None:
        return "It is not known what lies there: the first touch draws one of the poses that are left by lot."
    if truth.drawn_from is None:
        return f"A {escape(truth.model.name)} answers, as was given."
    return f"A pose of {escape(truth.model.name)}, drawn by lot, answers."


def _hypothesis_table(session: Session, state: State, look: Look) -> str:
    if not state.hypotheses:
        return ""
    rows: list[str] = []
    few = session.dimension == 2 or len(state.hypotheses) <= MOST_SHIFTED
    for number, one in enumerate(state.hypotheses[:MOST_ROWS]):
        pose = " ".join(
            f"{decimal(value, 1.0)}°" if "deg" in name else decimal(value, session.size)
            for name, value in components(one.world_from_model).items()
        )
        turn, shift = _bounds(session, one) if number == look.chosen or few else ("", "")
        rows.append(
            f"<tr><td>{_part(session, state, number)}</td><td>{pose}</td>"
            f'<td class="number">{turn}</td><td class="number">{shift}</td></tr>'
        )
    names = "x y angle" if session.dimension == 2 else "x y z rx ry rz"
    head = f"<tr><th>part</th><th>{names}</th><th>turn ≤</th><th>shift ≤</th></tr>"
    return f"<table>{head}{''.join(rows)}</table>{_more(len(state.hypotheses))}"


def _bounds(session: Session, one: Hypothesis) -> tuple[str, str]:
    """How far its poses turn, and corners shift, at most."""
    if not one.proved:
        return "unknown", "unknown"
    turn = f"{at_most(math.degrees(one.poses.rotation_bound))}°"
    if session.dimension == 3 and len(one.model.vertices) > MOST_TOLD:
        return turn, ""
    return turn, at_most(max(reach(one, *corner) for corner in one.model.vertices.tolist()))


def _more(count: int) -> str:
    return f'<p class="faint">and {count - MOST_ROWS} more</p>' if count > MOST_ROWS else ""


def _part(session: Session, state: State, number: int) -> str:
    one = state.hypotheses[number]
    color = COLORS[one.model_number % len(COLORS)]
    name = escape(session.labels[one.model_number])
    return f'<span class="part" style="background:{color}"></span>{number + 1} {name}'


def _prediction(outcome: Outcome) -> str:
    told = [
        f"{kind} {number}: {low:.4g} to {high:.4g}"
        for (kind, number), (low, high) in (
            (touch.feature, touch.depth) for touch in outcome.touches[:MOST_FEATURES]
        )
    ]
    if len(outcome.touches) > MOST_FEATURES:
        told.append(f"or one of {len(outcome.touches) - MOST_FEATURES} more")
    if outcome.may_miss:
        told.append("nothing" if not told else "or nothing")
    return "<br>".join(told)


def _leaves(session: Session, state: State) -> str:
    path = state.path
    if path is None or len(path.members) == 1:
        return ""
    rows = "".join(
        f"<li>{', '.join(_part(session, state, number) for number in members[:MOST_ROWS])}</li>"
        for members in path.classes[:MOST_ROWS]
    )
    return f"<p>What an answer can leave, at most:</p><ul>{rows}</ul>{_more(len(path.classes))}"


def _node(session: Session, state: State, node: AmbiguityNode) -> str:
    if node.path is None:
        several = len(node.members) > 1
        return f' <span class="bad">{STATUS[node.status]}</span>' if several else ""
    x = ", ".join(f"{value:.4g}" for value in node.path.start)
    rows: list[str] = []
    for branch in node.branches:
        names = ", ".join(_part(session, state, number) for number in branch.members[:MOST_FEATURES])
        if len(branch.members) > MOST_FEATURES:
            names += f" and {len(branch.members) - MOST_FEATURES} more"
        ahead = "recognize anew" if branch.node is None else names + _node(session, state, branch.node)
        rows.append(f"<li>{ANSWERS[branch.answers]}: {ahead}</li>")
    return f'<div class="faint">touch {node.level + 1} from ({x})</div><ul>{"".join(rows)}</ul>'


def _toward(contact: Contact) -> str:
    if contact.normal is not None and contact.normal_error is not None:
        return f"{_place(contact.normal)}, ±{math.degrees(contact.normal_error):.3g}°"
    return "" if contact.approach is None else f"approach {_place(contact.approach)}"


def _place(values: Iterable[float]) -> str:
    return f"({', '.join(f'{value:.4g}' for value in values)})"
