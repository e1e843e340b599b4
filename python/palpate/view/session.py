"""A session: what is known, what is done next, and the way back. It draws nothing and needs no viewer.

Whether a pose is valid, what a path tells, what a touch meets: all of that is asked of `palpate`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from palpate._core import Contact, Miss, Model, Prior, Sensor, plan_report, plan_tree, recognize
from palpate.loop.dimension import DIMENSIONS
from palpate.loop.reading import read_log, settings_of_log
from palpate.loop.refuted import refuted, without_way
from palpate.loop.replay import replay
from palpate.loop.result import hypotheses_words
from palpate.loop.wander import as_swept, wandering
from palpate.planner_names import Planner
from palpate.probe import AlreadyTouching, Hit, Noise, SimulatedProbe, Skid
from palpate.view import recorded
from palpate.view.pick import nearest_face_point
from palpate.view.state import Left, Move, Placement, State, Truth

EFFORT = 100_000  # as in the loop: a look that takes seconds
APART = 1.1  # middles of parts that are laid out, in sizes of the largest


class Session:
    """Contacts, what explains them, the next path, simulated touches; each step can be undone.

    `states` is the history: the first is how it began, the last is what is known now. Every action adds one.
    Planning is that of the closed loop: a sensor without a path error may leave its line by its position
    error.
    """

    def __init__(
        self,
        models: Sequence[Model],
        sensor: Sensor,
        *,
        contacts: Sequence[Contact] = (),
        misses: Sequence[Miss] = (),
        prior: Prior | None = None,
        features: Sequence[str] | None = None,
        max_hypotheses: int = 1000,
        planner: Planner = "auto",
        stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
        workspace: ArrayLike | None = None,
        directions: tuple[ArrayLike, float] | None = None,
        effort: int = EFFORT,
        time_limit: float | None = None,
        seed: int = 0,
        truth: tuple[Model, ArrayLike] | None = None,
        noise: Noise = "uniform",
        unit: str = "mm",
        labels: Sequence[str] | None = None,
    ) -> None:
        """A session in which nothing is recognized yet.

        Args:
            models: The parts that it may be, all of the plane or all of space.
            sensor: Bounds of readings: of contacts that are added, and of simulated touches.
            contacts: What was touched before.
            misses: What was swept before.
            prior: As for `palpate.recognize`; `features` and `max_hypotheses` likewise.
            features: Kinds of features.
            max_hypotheses: At most so many are kept.
            planner: As for `palpate.plan`; `stop`, `workspace`, `directions`, `effort` and `seed` likewise.
            stop: When a path is good enough.
            workspace: Where paths begin.
            directions: In which they may go.
            effort: How much is searched for a path.
            time_limit: Seconds for each recognition, each path, each tree.
            seed: For poses and errors that are drawn.
            truth: The part and the pose, shape `(d + 1, d + 1)`, that answer simulated touches. None: a
                pose that is drawn from the hypotheses when the first one is made.
            noise: Errors of simulated touches, as for `palpate.SimulatedProbe`.
            unit: Of the models, for what is said.
            labels: What to call the models; else they have their own names.

        Raises:
            ValueError: No models, the plane mixed with space, something else than models and contacts.
        """
        self.models = list(models)
        if not self.models or not all(isinstance(model, Model) for model in self.models):
            raise ValueError(f"models: must be parts, at least one (got {models!r}); give palpate.Model")
        self.dimension = self.models[0].dimension
        for model in self.models:
            if model.dimension != self.dimension:
                raise ValueError(
                    "models: must be all of the plane or all of space (got both); view them apart"
                )
        if not isinstance(sensor, Sensor):
            raise ValueError(f"sensor: must be a Sensor (got {sensor!r}); give palpate.Sensor")
        if sensor.stem is not None and self.dimension == 2:
            raise ValueError(f"stem: is of space only (got {sensor.stem!r}); leave it out in the plane")
        for number, contact in enumerate(contacts):
            self._check(f"contacts[{number}]", contact, Contact)
        for number, miss in enumerate(misses):
            self._check(f"misses[{number}]", miss, Miss)
        if prior is not None:
            self._check("prior", prior, Prior)
        self.sensor = sensor
        self.unit = unit
        self.labels = [model.name for model in self.models] if labels is None else list(labels)
        self.prior = prior
        self.size = max(model.size for model in self.models)
        self.workspace = None if workspace is None else np.sort(np.asarray(workspace, dtype=float), axis=0)
        self._recognized: dict[str, Any] = {
            "features": None if features is None else tuple(features),
            "prior": prior,
            "max_hypotheses": max_hypotheses,
            "time_limit": time_limit,
        }
        self._planned: dict[str, Any] = {
            "planner": planner,
            "stop": stop,
            "workspace": workspace,
            "directions": directions,
            "effort": effort,
            "time_limit": time_limit,
            "seed": seed,
            "features": None if features is None else tuple(features),
        }
        self._seed = seed
        self._noise: Noise = noise
        given = None
        if truth is not None:
            # Asked once here, so that what is no pose is refused before a viewer is open.
            SimulatedProbe(truth[0], truth[1], _without_stem(sensor), seed=seed, noise=noise)
            given = Truth(truth[0], np.array(truth[1], dtype=float), None)
        said = f"{len(contacts)} contacts, {len(misses)} misses" if contacts or misses else "nothing touched"
        self.states = [State(said, tuple(contacts), tuple(misses), truth=given)]

    @classmethod
    def of_log(cls, log: str | FilePath) -> Session:
        """A recorded run: a state for each of its guarded moves. It can go on from the last.

        Args:
            log: A log of `palpate.identify`.

        Raises:
            ValueError: No file, no log, one of another version, or one that was changed.
        """
        settings = settings_of_log(FilePath(log), read_log(FilePath(log)))
        session = cls(
            settings.models,
            settings.sensor,
            contacts=settings.contacts,
            misses=settings.known,
            prior=settings.prior,
            max_hypotheses=settings.max_hypotheses,
            unit=settings.unit,
            **settings.searched,
            **settings.placed,
            effort=settings.effort,
            seed=settings.seed,
        )
        # Features of the loop are about paths; its recognition takes all that the tip can meet.
        session._planned["features"] = settings.features
        session.states = recorded.states_of(replay(log), session.states[0])
        return session

    @property
    def state(self) -> State:
        """What is known now."""
        return self.states[-1]

    @property
    def moved(self) -> Sensor:
        """The sensor as paths are planned for it: with a path error."""
        return wandering(self.sensor)

    def contact_of(
        self, point: ArrayLike, normal: ArrayLike | None = None, approach: ArrayLike | None = None
    ) -> Contact:
        """A contact with the bounds of the sensor.

        Args:
            point: Centre of the tip, shape `(d,)`, world frame.
            normal: Outward, shape `(d,)`, of any length; None: not sensed.
            approach: Direction of travel, shape `(d,)`; None: not known.

        Raises:
            ValueError: As `palpate.Contact.from_tip`; a normal, of a sensor that reads none.
        """
        if normal is not None and self.sensor.normal_error is None:
            raise ValueError(
                f"normal: the sensor reads none (got {normal!r}); leave it out and give the approach"
            )
        return Contact.from_tip(
            point,
            self.sensor.tip_radius,
            position_error=self.sensor.position_error,
            normal=normal,
            normal_error=None if normal is None else self.sensor.normal_error,
            approach=approach,
        )

    def contact_on(self, placement: Placement, origin: ArrayLike, direction: ArrayLike) -> Contact:
        """The contact where a ray meets a part as it is drawn: what was clicked.

        Args:
            placement: One of `placements`.
            origin: Where the ray begins, shape `(3,)`; in the plane above it, at z = 0.
            direction: Its direction, shape `(3,)`.

        Raises:
            ValueError: The ray passes by, or meets what can't be touched.
        """
        origin, direction = np.asarray(origin, dtype=float), np.asarray(direction, dtype=float)
        model, pose = placement.model, placement.world_from_model
        if self.dimension == 2:
            point, normal = nearest_face_point(model, pose, origin=origin, direction=direction)
        else:
            met = model.first_contact(pose, origin, direction)
            if met is None:
                raise ValueError("click: passes by the part; click on it")
            if not met.touchable:
                raise ValueError(
                    f"click: {' '.join(map(str, met.feature))} can't be touched; click elsewhere"
                )
            point, normal = met.center, met.normal
        center = point + self.sensor.tip_radius * normal
        reads = self.sensor.normal_error is not None
        return self.contact_of(center, normal if reads else None, None if reads else -normal)

    def placements(self, state: State) -> list[Placement]:
        """The parts as they are drawn: all hypotheses, or all models side by side."""
        if state.hypotheses:
            return [
                Placement(one.model, one.model_number, one.world_from_model, number)
                for number, one in enumerate(state.hypotheses)
            ]
        return self._laid_out()

    def add_contact(self, contact: Contact) -> State:
        """What was touched by other means; it is recognized when that is asked for."""
        self._check("contact", contact, Contact)
        number = len(self.state.contacts) + 1
        truth = self.state.truth
        return self._then(
            f"contact {number} added",
            contacts=(*self.state.contacts, contact),
            stale=self.state.left is not None,
            # One that was drawn explained the contacts before; who knows whether it explains this one.
            truth=truth if truth is not None and truth.drawn_from is None else None,
            **NOTHING_PLANNED,
        )

    def recognize(self) -> State:
        """Every part and pose that explains all contacts, misses and moves.

        Raises:
            ValueError: As `palpate.recognize`; no contact.
        """
        left = self._explaining(self.state)
        return self._then(f"recognized: {left_words(left)}", left=left, stale=False, **NOTHING_PLANNED)

    def plan(self) -> State:
        """The path that tells the hypotheses apart best.

        Raises:
            ValueError: As `palpate.plan`; nothing recognized, or not all of the evidence.
        """
        hypotheses = self._to_tell_apart()
        tried = [(move.start, move.end - move.start) for move in self.state.moves]
        report = plan_report(hypotheses, self.moved, tried=tried, **self._planned)
        return self._then(
            "planned: " + ("no path" if report.path is None else path_words(report.path)),
            path=report.path,
            why=report.why,
            proved=report.proved,
            bound=report.bound,
        )

    def grow_tree(self) -> State:
        """The whole ambiguity tree: the next path, whatever the last one met.

        Raises:
            ValueError: As for `plan`.
        """
        tree = plan_tree(self._to_tell_apart(), self.moved, **self._planned)
        return self._then(f"ambiguity tree: touches expected: {tree.expected_touches:.3g}", tree=tree)

    def touch(self) -> State:
        """A simulated guarded move along the path, and recognition anew with what it met.

        Raises:
            ValueError: Nothing is planned.
        """
        path, state = self.state.path, self.state
        if path is None:
            raise ValueError("path: there is none to touch along; plan one first")
        truth = state.truth or self._drawn()
        probe = SimulatedProbe(
            truth.model,
            truth.world_from_model,
            _without_stem(self.sensor),
            seed=self._seed,
            noise=self._noise,
        )
        for move in state.moves:
            probe.made(move.start, move.end)
        reply = probe.touch(path.start, path.end)
        contacts = (*state.contacts, reply.contact) if isinstance(reply, Hit) else state.contacts
        moves = (*state.moves, Move(path.start, path.end, reply))
        after = replace(state, contacts=contacts, moves=moves, truth=truth)
        left = self._explaining(after)
        return self._then(
            f"{reply_words(reply)}: {left_words(left)}",
            contacts=contacts,
            moves=moves,
            truth=truth,
            left=left,
            stale=False,
            **NOTHING_PLANNED,
        )

    def undo(self) -> State:
        """Back to the state before.

        Raises:
            ValueError: There is none.
        """
        if len(self.states) == 1:
            raise ValueError("undo: nothing was done yet; there is no state before")
        self.states.pop()
        return self.state

    def _check(self, name: str, one: Any, kind: type[Contact | Miss | Prior]) -> None:
        """Refuse what is of another kind or dimension: it could be neither recognized nor drawn."""
        if not isinstance(one, kind):
            raise ValueError(f"{name}: must be a {kind.__name__} (got {one!r}); give palpate.{kind.__name__}")
        if isinstance(one, Contact):
            dimension = len(one.center)
        else:
            dimension = len(one.start) if isinstance(one, Miss) else len(one.world_from_model) - 1
        if dimension != self.dimension:
            raise ValueError(
                f"{name}: is of dimension {dimension}, the models of dimension {self.dimension} "
                f"(got {one!r}); don't mix the plane and space"
            )

    def _then(self, said: str, **changes: Any) -> State:
        self.states.append(replace(self.state, said=said, **changes))
        return self.state

    def _to_tell_apart(self) -> list[Any]:
        if self.state.left is None or self.state.stale:
            raise ValueError("hypotheses: not all contacts are recognized; recognize first")
        if not self.state.hypotheses:
            raise ValueError("hypotheses: none is left; undo, or mend the contacts")
        return self.state.hypotheses

    def _explaining(self, state: State) -> Left:
        contacts, misses = self._evidence(state)
        found = recognize(self.models, contacts, misses=misses, **self._recognized)
        moves = [(move.start, move.end, move.reply) for move in state.moves]
        # It takes long to make many poses ready for moves, even for none.
        wrong = refuted(found.hypotheses, moves, self.sensor) if moves else {}
        kept = [one for number, one in enumerate(found.hypotheses) if number not in wrong]
        return Left(kept, found.complete, found.stopped_by, found.conflict, len(wrong))

    def _evidence(self, state: State) -> tuple[list[Contact], list[Miss]]:
        """As the loop gives it to recognition: in space without what its moves swept, which refutes only."""
        ways = DIMENSIONS[self.dimension].recognizes_ways
        moved = [move.reply.contact for move in state.moves if isinstance(move.reply, Hit)]
        contacts = [
            contact if ways or not any(contact is one for one in moved) else without_way(contact)
            for contact in state.contacts
        ]
        swept: list[Miss] = []
        for move in state.moves if ways else ():
            if isinstance(move.reply, Miss):
                swept.append(as_swept(move.reply, self.sensor))
            elif isinstance(move.reply, Skid):
                swept.append(as_swept(move.reply.free, self.sensor))
        return contacts, [*state.misses, *swept]

    def _drawn(self) -> Truth:
        """A part and a pose that explain all evidence: the hypothesis by lot, then the pose."""
        hypotheses = self.state.hypotheses
        number = int(np.random.default_rng([self._seed, 2]).integers(len(hypotheses)))
        chosen = hypotheses[number]
        return Truth(chosen.model, chosen.poses.sample(1, seed=self._seed)[0], number)

    def _laid_out(self) -> list[Placement]:
        """In rows, each model in a square of its own; one alone is where its file has it."""
        if len(self.models) == 1:
            return [Placement(self.models[0], 0, np.eye(self.dimension + 1), None)]
        columns = math.ceil(math.sqrt(1.3 * len(self.models)))
        placed: list[Placement] = []
        for number, model in enumerate(self.models):
            low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
            pose = np.eye(self.dimension + 1)
            pose[:-1, -1] = -(low + high) / 2
            row, column = divmod(number, columns)
            pose[:2, -1] += np.array([column, -row]) * APART * self.size
            placed.append(Placement(model, number, pose, None))
        return placed


NOTHING_PLANNED: dict[str, Any] = {"path": None, "why": None, "proved": False, "bound": 1.0, "tree": None}


def left_words(left: Left) -> str:
    """How many are left."""
    if not left.hypotheses:
        return "nothing explains all of it" if left.complete else "nothing found yet"
    return f"{hypotheses_words(len(left.hypotheses))} left" + ("" if left.complete else ", maybe more")


def path_words(path: Any) -> str:
    """A path in short."""
    if len(path.members) == 1:
        return "one more touch"
    sure = "certain" if path.guaranteed else "not certain"
    return f"a path, {sure} to tell; score {path.score:.3g} of {len(path.members)}"


def reply_words(reply: Any) -> str:
    """What a move met."""
    if isinstance(reply, Hit):
        return f"touched at ({', '.join(f'{value:.4g}' for value in reply.contact.center)})"
    if isinstance(reply, Miss):
        return "touched nothing"
    if isinstance(reply, Skid):
        return "skidded"
    if isinstance(reply, AlreadyTouching):
        return "touched already at the start"
    return "the probe can't go on"


def _without_stem(sensor: Sensor) -> Sensor:
    """Simulated touches have none."""
    return Sensor(
        sensor.position_error,
        sensor.normal_error,
        sensor.max_incidence,
        sensor.tip_radius,
        sensor.path_error,
    )
