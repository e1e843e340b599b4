"""Logs that are damaged or none: one line that says where, never a traceback, and no file is lost."""

import copy
import json
import math

import numpy as np
import pytest
from conftest import pose, usual_sensor

import palpate
from palpate.cli import main

AREA = [[-150.0, -150.0], [150.0, 150.0]]
PARTS = palpate.load_models(["boot", "camera"])


def run(**changes):
    probe = palpate.SimulatedProbe(PARTS[0], pose(0.4, 12.0, -7.0), usual_sensor(), seed=1)
    settings = {"seed": 1, "max_touches": 40, "max_hypotheses": 50}
    return palpate.identify(PARTS, probe, usual_sensor(), AREA, **(settings | changes))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of a log."""
    log = tmp_path_factory.mktemp("log") / "run.jsonl"
    assert run(log=log).status == "solved"
    return log.read_bytes()


def events_of(text):
    return [json.loads(line) for line in text.splitlines()]


def lines_of(events):
    return b"".join(json.dumps(event, separators=(",", ":")).encode() + b"\n" for event in events)


@pytest.mark.parametrize("text", [b"precious notes without newline", b"{", b'{"event":"move"', b"\0\0\0"])
def test_a_file_that_is_no_log_is_not_touched(tmp_path, text):
    notes = tmp_path / "notes.txt"
    notes.write_bytes(text)
    beginning = text == b"{"
    if beginning:
        assert run(log=notes, resume=True).status == "solved"
        return
    with pytest.raises(ValueError, match="line 1 is no beginning of an event"):
        run(log=notes, resume=True)
    assert notes.read_bytes() == text


def test_notes_after_a_log_are_not_cut_off(tmp_path, whole):
    log = tmp_path / "run.jsonl"
    log.write_bytes(whole + b"the boot, by the window")
    with pytest.raises(ValueError, match=f"line {whole.count(10) + 1} is no beginning"):
        run(log=log, resume=True)
    assert log.read_bytes() == whole + b"the boot, by the window"


def set_at(event, place, value):
    for name in place[:-1]:
        event = event[name]
    event[place[-1]] = value


DAMAGES = [
    (0, ("settings",), None, r"line 1 .*settings: must be of the type object"),
    (0, ("settings", "hurry"), 1, r"line 1 .*settings.'hurry': is unknown"),
    (0, ("sensor", "colour"), 1, r"line 1 .*sensor.'colour': is unknown"),
    (0, ("models", 0), 5, r"line 1 .*models\[0\]: must be of the type object"),
    (0, ("models", 0), {}, r"line 1 .*models\[0\]: unit"),
    (0, ("sensor", "max_incidence"), 9.0, r"line 1 .*max_incidence"),
    (0, ("workspace",), [[0, 0], [0, 0]], r"line 1 .*workspace"),
    (0, ("settings", "effort"), True, r"line 1 .*settings.effort"),
    (0, ("position",), [0.0], r"line 1 .*position"),
    (0, ("prior",), {"translation": 1}, r"line 1 .*prior"),
    (2, ("contact",), None, r"line 3 .*contact: must be of the type object"),
    (2, ("contact", "center", 0), "here", r"line 3 .*contact.center\[0\]: must be of the type number"),
    (2, ("contact", "normal"), [0, 0], r"line 3 .*normal"),
    (2, ("kind",), "kiss", r"line 3 .*kind"),
    (1, ("event",), "kiss", r"line 2 .*event"),
]


@pytest.mark.parametrize(("line", "place", "value", "message"), DAMAGES)
def test_damage_is_named_with_its_line(tmp_path, whole, line, place, value, message):
    log = tmp_path / "run.jsonl"
    events = events_of(whole)
    assert events[2]["kind"] == "hit"
    set_at(events[line], place, value)
    log.write_bytes(lines_of(events))
    with pytest.raises(ValueError, match=message):
        palpate.replay(log)
    with pytest.raises(ValueError, match=rf"{message}|is not that of the log"):
        run(log=log, resume=True)
    assert log.read_bytes() == lines_of(events)


def test_missing_keys_and_deep_brackets_are_named(tmp_path, whole):
    log = tmp_path / "run.jsonl"
    bare = {"event": "start", "schema": "palpate-run", "version": 1}
    for text, message in (
        (lines_of([bare]), r"line 1 .*unit: is missing"),
        (b"[" * 100_000 + b"\n", "line 1 is no event"),
        (whole.replace(b'"margin":0.001', b'"margin":NaN'), "line 1 .*margin: must be finite"),
    ):
        log.write_bytes(text)
        for read in (lambda: palpate.replay(log), lambda: run(log=log, resume=True)):
            with pytest.raises(ValueError, match=message):
                read()


def test_lines_are_numbered_alike_by_replay_and_resume(tmp_path, whole):
    log = tmp_path / "run.jsonl"
    events = events_of(whole)
    events[1]["end"][0] += 1.0
    log.write_bytes(lines_of(events))
    for read in (lambda: palpate.replay(log), lambda: run(log=log, resume=True)):
        with pytest.raises(ValueError, match="log: line 2 says"):
            read()


def test_nothing_follows_the_end(tmp_path, whole):
    log = tmp_path / "run.jsonl"
    events = events_of(whole)
    for more in (events[-1], events[1], events[0]):
        log.write_bytes(lines_of([*events, more]))
        with pytest.raises(ValueError, match=rf"line {len(events) + 1} "):
            palpate.replay(log)


def test_bad_logs_are_one_line_and_nothing_else(tmp_path, whole, capsys):
    log = tmp_path / "run.jsonl"
    for text in (lines_of([{"event": "start", "schema": "palpate-run", "version": 1}]), b"[" * 5000 + b"\n"):
        log.write_bytes(text)
        for arguments in (["replay", str(log)], ["identify", "boot", "--log", str(log), "--resume"]):
            assert main(arguments) == 2
            out, err = capsys.readouterr()
            assert out == "" and err.count("\n") == 1 and "line 1" in err


# Fuzz

JUNK = (
    None,
    True,
    0,
    -1,
    1.5,
    1e200,
    -1e308,
    1e9,
    "",
    "mm",
    "\ud800",
    [],
    [1],
    {},
    {"a": 1},
    [[0, 0], [1, 1]],
    math.nan,
    10**400,
)


def places_in(node, place=()):
    yield place
    members = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for name, member in members:
        yield from places_in(member, (*place, name))


def damaged(events, random):
    """One or two damages to some lines."""
    events = copy.deepcopy(events)
    for _ in range(int(random.integers(1, 3))):
        k = int(random.integers(len(events))) if random.random() < 0.7 else 0
        kind = random.integers(6)
        places = [place for place in places_in(events[k]) if place]
        if kind <= 2 and places:
            set_at(
                events[k], places[int(random.integers(len(places)))], JUNK[int(random.integers(len(JUNK)))]
            )
        elif kind == 3 and places:
            *parent, name = places[int(random.integers(len(places)))]
            node = events[k]
            for step in parent:
                node = node[step]
            del node[name]
        elif kind == 4:
            events.insert(int(random.integers(len(events))), copy.deepcopy(events[k]))
        elif len(events) > 1:
            del events[k]
    return lines_of(events)


def torn(text, random):
    """Bytes changed, dropped, doubled or put in."""
    text = bytearray(text)
    for _ in range(int(random.integers(1, 4))):
        at = int(random.integers(len(text)))
        kind = random.integers(4)
        if kind == 0:
            text[at] = int(random.integers(256))
        elif kind == 1:
            del text[at : at + int(random.integers(1, 40))]
        elif kind == 2:
            text[at:at] = text[at : at + int(random.integers(1, 200))]
        else:
            text[at:at] = bytes(random.integers(0, 256, 3, dtype=np.uint8))
    return bytes(text)


@pytest.mark.parametrize("seed", range(20))
def test_damaged_logs_are_refused_or_read_but_nothing_else(tmp_path, whole, seed):
    random = np.random.default_rng(seed)
    log = tmp_path / "run.jsonl"
    refused = 0
    for k in range(40):
        text = damaged(events_of(whole), random) if k % 2 else torn(whole, random)
        log.write_bytes(text)
        try:
            palpate.replay(log)
        except ValueError as error:
            refused += 1
            assert str(error)
        if k % 4 < 2:
            try:
                run(log=log, resume=True)
            except ValueError:
                assert log.read_bytes().startswith(text[: text.rfind(b"\n") + 1])
    assert refused > 10
