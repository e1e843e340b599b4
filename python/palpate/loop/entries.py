"""Runs as JSON: the `palpate-run` document, version 1, a line for each event (`schemas/run-1.json`).

Lengths are in the unit that it names, angles in radians: what is read back is what was written, bit for bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate._core import Contact, Hypothesis, Miss, Path, PlanReport, Prior, Sensor
from palpate.loop.result import Found
from palpate.loop.route import Array
from palpate.loop.settings import Settings, settings_of
from palpate.model_json import document_of
from palpate.models import model_of
from palpate.plan_json import path_entry
from palpate.probe import AlreadyTouching, Fault, Hit, Reply, Skid, UnexpectedTouch
from palpate.probe.simulated import point_of, sensor_entry

SCHEMA = "palpate-run"
VERSION = 1

SEARCH = (
    "blind",
    "planner",
    "stop",
    "directions",
    "margin",
    "effort",
    "time_limit",
    "features",
    "max_touches",
    "max_hypotheses",
    "until",
    "seed",
)
TOLD_OF_A_PATH = (
    "start",
    "direction",
    "length",
    "margin",
    "score",
    "expected_score",
    "guaranteed",
    "classes",
    "no_contact",
)

Event = dict[str, Any]


def start_event(settings: Settings, position: Array | None, *, simulation: Event | None) -> Event:
    """The first line: all that the run depends on beside the probe's answers, and what answers them."""
    return {
        "event": "start",
        "schema": SCHEMA,
        "version": VERSION,
        "unit": settings.unit,
        "models": [document_of(model, settings.unit) for model in settings.models],
        "sensor": sensor_entry(settings.sensor),
        "workspace": settings.workspace.tolist(),
        "position": None if position is None else position.tolist(),
        "prior": None if settings.prior is None else _prior_entry(settings.prior),
        "contacts": [contact_entry(contact) for contact in settings.contacts],
        "misses": [miss_entry(miss) for miss in settings.misses],
        "settings": {name: getattr(settings, name) for name in SEARCH},
        "simulation": simulation,
    }


def settings_in(event: Event) -> Settings:
    """What `start_event` made an event of."""
    prior = event["prior"]
    return settings_of(
        [model_of(f"models[{k}]", document) for k, document in enumerate(event["models"])],
        Sensor(**event["sensor"]),
        event["workspace"],
        prior=None if prior is None else (Prior.on_plane if "tilt" in prior else Prior)(**prior),
        contacts=[contact_in(entry) for entry in event["contacts"]],
        misses=[Miss(**entry) for entry in event["misses"]],
        unit=event["unit"],
        **event["settings"],
    )


def check_dimension(reply: Reply | None, dimension: int) -> None:
    """That a reply is of the workspace's dimension.

    Raises:
        ValueError: It is of another.
    """
    for point in _points_of(reply):
        if np.shape(point) != (dimension,):
            raise ValueError(
                f"probe: answered with a point of shape {np.shape(point)}, the workspace is of dimension "
                f"{dimension} (got {reply!r}); give points of shape ({dimension},)"
            )


def reply_event(reply: Reply | None) -> Event:
    """What the probe answered; None: a free move that went well.

    Raises:
        ValueError: It is no reply.
    """
    match reply:
        case None:
            return {"event": "reply", "kind": "moved"}
        case Hit() if isinstance(reply.contact, Contact):
            return {"event": "reply", "kind": "hit", "contact": contact_entry(reply.contact)}
        case Miss():
            return {"event": "reply", "kind": "miss", "miss": miss_entry(reply)}
        case Skid() if isinstance(reply.free, Miss):
            return {"event": "reply", "kind": "skid", "free": miss_entry(reply.free)}
        case AlreadyTouching():
            return {"event": "reply", "kind": "already_touching"}
        case UnexpectedTouch():
            return {
                "event": "reply",
                "kind": "unexpected_touch",
                "where": _place("where", reply.where).tolist(),
            }
        case Fault():
            return {"event": "reply", "kind": "fault", "reason": str(reply.reason)}
    raise ValueError(
        f"probe: answered {reply!r}; answer Hit of a Contact, Miss, Skid of a Miss, AlreadyTouching, "
        "UnexpectedTouch or Fault"
    )


def _points_of(reply: Any) -> list[Any]:
    """One point of each part of a reply."""
    match reply:
        case Hit() if isinstance(reply.contact, Contact):
            return [reply.contact.center]
        case Miss():
            return [reply.start]
        case Skid() if isinstance(reply.free, Miss):
            return [reply.free.start]
        case UnexpectedTouch():
            return [reply.where]
    return []


def reply_in(event: Event) -> Reply | None:
    """What `reply_event` made an event of."""
    match event["kind"]:
        case "moved":
            return None
        case "hit":
            return Hit(contact_in(event["contact"]))
        case "miss":
            return Miss(**event["miss"])
        case "skid":
            return Skid(Miss(**event["free"]))
        case "already_touching":
            return AlreadyTouching()
        case "unexpected_touch":
            return UnexpectedTouch(_place("where", event["where"]))
        case "fault":
            return Fault(event["reason"])
    raise ValueError(f"kind: no such reply (got {event['kind']!r}); name the log of another version")


def recognized_event(found: Found) -> Event:
    """What was left, without the detail."""
    return {
        "event": "recognized",
        "complete": found.complete,
        "conflict": found.conflict,
        "hypotheses": [_hypothesis_entry(one) for one in found.hypotheses],
        "refuted": [
            {**_hypothesis_entry(found.recognition.hypotheses[number]), "step": step}
            for number, step in sorted(found.refuted.items())
        ],
    }


def planned_event(path: Path | None, report: PlanReport) -> Event:
    """The next path, or why there is none."""
    return {
        "event": "planned",
        "why": report.why,
        "proved": report.proved,
        "path": None if path is None else path_told(path),
    }


def contact_entry(contact: Contact) -> Event:
    """A contact, as `contact_in` reads it."""
    points = {"normal": contact.normal, "approach": contact.approach, "start": contact.start}
    return {
        "center": contact.center.tolist(),
        "tip_radius": contact.tip_radius,
        "position_error": contact.position_error,
        "normal_error": contact.normal_error,
        **{name: None if point is None else point.tolist() for name, point in points.items()},
    }


def contact_in(entry: Event) -> Contact:
    """The contact of an entry."""
    return Contact.from_tip(**entry)


def miss_entry(miss: Miss) -> Event:
    """A miss; its keys are the arguments of `Miss`."""
    return {
        "start": miss.start.tolist(),
        "end": miss.end.tolist(),
        "tip_radius": miss.tip_radius,
        "path_error": miss.path_error,
    }


def _prior_entry(prior: Prior) -> Event:
    """Its keys are the arguments of `Prior`, or of `Prior.on_plane`."""
    on_plane = {} if prior.normal is None else {"height": prior.height, "tilt": prior.tilt}
    return {
        "world_from_model": prior.world_from_model.tolist(),
        "translation": prior.translation,
        "rotation": prior.rotation,
        **on_plane,
        **({} if prior.normal is None else {"normal": prior.normal.tolist()}),
    }


def _place(name: str, value: Any) -> Array:
    """Of the plane, or of space."""
    return point_of(name, value, 3 if np.shape(value) == (3,) else 2)


def _hypothesis_entry(one: Hypothesis) -> Event:
    return {
        "model": one.model.name,
        "model_number": one.model_number,
        "world_from_model": one.world_from_model.tolist(),
        "marginal": one.marginal,
    }


def path_told(path: Path) -> Event:
    """A planned path, and what it promised."""
    told = path_entry(path)
    return {name: told[name] for name in TOLD_OF_A_PATH}
