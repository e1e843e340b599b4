"""Entries: what CSV and JSON have in common, between a file's text and the evidence it holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn, TypeVar, cast

import numpy as np

from palpate._core import Contact, Miss, Prior

MM_PER_UNIT = {"um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

SCALARS = ("position_error", "normal_error_deg", "tip_radius", "path_error")
PLACES = ("center", "start", "end")  # the other points are directions and have no unit

Point = tuple[float, ...]  # two coordinates in the plane, three in space
Kind = TypeVar("Kind")


@dataclass(frozen=True)
class Defaults:
    """Bounds for entries that have none of their own; lengths in the models' unit."""

    position_error: float | None = None
    normal_error_deg: float | None = None
    tip_radius: float | None = None
    path_error: float | None = None


@dataclass(frozen=True)
class Entry:
    """One contact or miss as a file has it; `where` is the file and its place there, for messages."""

    where: str
    points: dict[str, Point]
    scalars: dict[str, float]

    def scaled(self, factor: float) -> Entry:
        """The same entry with its lengths multiplied by `factor`; directions and angles stay."""
        points = {k: tuple(factor * c for c in p) if k in PLACES else p for k, p in self.points.items()}
        scalars = {k: v if k.endswith("_deg") else v * factor for k, v in self.scalars.items()}
        return replace(self, points=points, scalars=scalars)


@dataclass(frozen=True)
class Lying:
    """What else is known of a part that lies on a plane in space."""

    height: float
    tilt_deg: float
    normal: Point = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class PriorEntry:
    """A prior as a file has it."""

    where: str
    world_from_model: list[list[float]]
    translation: float
    rotation_deg: float
    lying: Lying | None = None

    def scaled(self, factor: float) -> PriorEntry:
        """The same prior with its lengths multiplied by `factor`."""
        *rows, last = self.world_from_model
        pose = [*([*row[:-1], row[-1] * factor] for row in rows), last]
        lying = None if self.lying is None else replace(self.lying, height=self.lying.height * factor)
        return replace(self, world_from_model=pose, translation=self.translation * factor, lying=lying)


@dataclass(frozen=True)
class Sheet:
    """A whole contact file; `unit` is None where the file doesn't name one: then it is the models'."""

    unit: str | None
    contacts: list[Entry] = field(default_factory=list[Entry])
    misses: list[Entry] = field(default_factory=list[Entry])
    prior: PriorEntry | None = None

    def scaled(self, factor: float) -> Sheet:
        """The same sheet with its lengths multiplied by `factor`."""
        return replace(
            self,
            contacts=[entry.scaled(factor) for entry in self.contacts],
            misses=[entry.scaled(factor) for entry in self.misses],
            prior=None if self.prior is None else self.prior.scaled(factor),
        )


def check_dimension(points: Iterable[tuple[str, int]], *, remedy: str) -> None:
    """Refuse evidence of the plane mixed with evidence of space; each is its place and its dimension."""
    first: tuple[str, int] | None = None
    for where, dimension in points:
        first = first or (where, dimension)
        if dimension != first[1]:
            said = f"{dimension} coordinates where {first[0]} has {first[1]}"
            refuse(where, f"the plane is mixed with space (got {said})", remedy)


def refuse(where: str, problem: str, remedy: str) -> NoReturn:
    """Bad input: one line that says where, what, and what to do."""
    raise ValueError(f"{where}: {problem}; {remedy}")


def write_text(path: Path, text: str) -> None:
    """Write a file; where that fails, say what to do."""
    try:
        path.write_text(text, encoding="utf-8")
    except FileNotFoundError:
        refuse(str(path), "its folder is not there", "make the folder first, or name another file")
    except OSError as error:
        refuse(
            str(path), f"can't be written: {error.strerror}", "name a file in a folder that can be written"
        )


def mm_per(unit: str, where: str) -> float:
    """Millimetres in one `unit`."""
    if unit not in MM_PER_UNIT:
        refuse(where, f"unknown unit {unit!r}", f"give one of {', '.join(MM_PER_UNIT)}")
    return MM_PER_UNIT[unit]


def check_degrees(where: str, value: float, most: float) -> None:
    """Refuse an angle that the core would refuse in radians, which nobody wrote."""
    if not 0.0 <= value <= most:
        refuse(where, f"must be an angle in degrees, from 0 to {most:g} (got {value:g})", "give degrees")


def check_defaults(defaults: Defaults) -> None:
    """Refuse bad defaults by their own names, before an entry of a file is blamed for them."""
    for name in ("position_error", "tip_radius", "path_error"):
        value = getattr(defaults, name)
        if value is not None and not 0.0 <= value < math.inf:
            refuse(name, f"must be a finite number, zero or more (got {value:g})", "give it as a length")
    if defaults.normal_error_deg is not None:
        check_degrees("normal_error_deg", defaults.normal_error_deg, 90.0)


def contact_of(entry: Entry, defaults: Defaults) -> Contact:
    """The contact that `entry` describes."""
    normal = entry.points.get("normal")
    position_error = entry.scalars.get("position_error", defaults.position_error)
    normal_error_deg = entry.scalars.get("normal_error_deg", defaults.normal_error_deg)
    tip_radius = entry.scalars.get("tip_radius", defaults.tip_radius)
    if position_error is None:
        refuse(
            f"{entry.where}, position_error",
            "absent",
            "fill it in, or give --position-error for all contacts",
        )
    if normal is not None and normal_error_deg is None:
        problem = "absent, though there is a normal"
        refuse(
            f"{entry.where}, normal_error_deg",
            problem,
            "fill it in, or give --normal-error-deg for all contacts",
        )
    if normal_error_deg is not None:
        check_degrees(f"{entry.where}, normal_error_deg", normal_error_deg, 90.0)
    try:
        return Contact.from_tip(
            entry.points["center"],
            0.0 if tip_radius is None else tip_radius,
            position_error=position_error,
            normal=normal,
            normal_error=None
            if normal is None or normal_error_deg is None
            else math.radians(normal_error_deg),
            approach=entry.points.get("approach"),
            start=entry.points.get("start"),
        )
    except ValueError as error:
        raise ValueError(f"{entry.where}: {error}") from None


def miss_of(entry: Entry, defaults: Defaults) -> Miss:
    """The miss that `entry` describes."""
    # A tip known to within its position error may have left its line by as much, unless it is said otherwise.
    nearest_first = (
        entry.scalars.get("path_error"),
        defaults.path_error,
        entry.scalars.get("position_error"),
        defaults.position_error,
    )
    path_error = next((bound for bound in nearest_first if bound is not None), 0.0)
    tip_radius = entry.scalars.get("tip_radius", defaults.tip_radius)
    try:
        return Miss(
            entry.points["start"],
            entry.points["end"],
            tip_radius=0.0 if tip_radius is None else tip_radius,
            path_error=path_error,
        )
    except ValueError as error:
        raise ValueError(f"{entry.where}: {error}") from None


def prior_of(entry: PriorEntry) -> Prior:
    """The prior that `entry` describes."""
    check_degrees(f"{entry.where}: rotation_deg", entry.rotation_deg, 180.0)
    pose, lying = np.array(entry.world_from_model), entry.lying
    if lying is not None:
        check_degrees(f"{entry.where}: tilt_deg", lying.tilt_deg, 180.0)
    bounds = {"translation": entry.translation, "rotation": math.radians(entry.rotation_deg)}
    try:
        if lying is None:
            return Prior(pose, **bounds)
        on_plane = {"height": lying.height, "tilt": math.radians(lying.tilt_deg)}
        return Prior.on_plane(pose, **bounds, **on_plane, normal=lying.normal)
    except ValueError as error:
        raise ValueError(f"{entry.where}: {error}") from None


def sheet_of(contacts: Sequence[Contact], misses: Sequence[Miss], *, prior: Prior | None, unit: str) -> Sheet:
    """The sheet that, when read in `unit`, gives these contacts, misses and prior."""
    contacts = _all_of("contacts", contacts, Contact)
    misses = _all_of("misses", misses, Miss)
    if not isinstance(prior, Prior | None):
        refuse("prior", f"must be a Prior (got {_brief(prior)})", "give palpate.Prior, or leave it out")
    points = [(f"contacts[{k}]", len(contact.center)) for k, contact in enumerate(contacts)]
    points += [(f"misses[{k}]", len(miss.start)) for k, miss in enumerate(misses)]
    points += [] if prior is None else [("prior", len(prior.world_from_model) - 1)]
    check_dimension(points, remedy="write them into two files")
    return Sheet(
        unit,
        [_entry_of_contact(contact) for contact in contacts],
        [_entry_of_miss(miss) for miss in misses],
        None if prior is None else _entry_of_prior(prior),
    )


def _all_of(name: str, members: Any, kind: type[Kind]) -> list[Kind]:
    """The members of a sequence, all of one class."""
    remedy = f"give a list of palpate.{kind.__name__}"
    if isinstance(members, str) or not isinstance(members, Iterable):
        refuse(name, f"must be a sequence of {kind.__name__} (got {_brief(members)})", remedy)
    listed = list(cast("Iterable[Any]", members))
    for k, member in enumerate(listed):
        if not isinstance(member, kind):
            refuse(f"{name}[{k}]", f"must be a {kind.__name__} (got {_brief(member)})", remedy)
    return listed


def _brief(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else f"{text[:80]}…"


def _entry_of_contact(contact: Contact) -> Entry:
    points = {
        "center": contact.center,
        "normal": contact.normal,
        "approach": contact.approach,
        "start": contact.start,
    }
    scalars = {"position_error": contact.position_error, "tip_radius": contact.tip_radius}
    if contact.normal_error is not None:
        scalars["normal_error_deg"] = shortest_degrees(contact.normal_error)
    return Entry("", {name: _point(p) for name, p in points.items() if p is not None}, scalars)


def _entry_of_miss(miss: Miss) -> Entry:
    points = {"start": _point(miss.start), "end": _point(miss.end)}
    return Entry("", points, {"tip_radius": miss.tip_radius, "path_error": miss.path_error})


def _entry_of_prior(prior: Prior) -> PriorEntry:
    pose = np.asarray(prior.world_from_model, dtype=float).tolist()
    lying = None
    if prior.height is not None and prior.tilt is not None and prior.normal is not None:
        lying = Lying(prior.height, shortest_degrees(prior.tilt), _point(prior.normal))
    return PriorEntry("", pose, prior.translation, shortest_degrees(prior.rotation), lying)


def _point(values: Any) -> Point:
    return tuple(float(value) for value in values)


def shortest_degrees(radians: float) -> float:
    """The shortest decimal in degrees that reads back as `radians`: 4.0, not 3.9999999999999996."""
    degrees = math.degrees(radians)
    candidates = (float(f"{degrees:.{digits}g}") for digits in range(1, 18))
    return next((value for value in candidates if math.radians(value) == radians), degrees)
