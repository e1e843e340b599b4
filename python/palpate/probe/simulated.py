"""A probe that touches a model at a pose, with errors within bounds."""

from __future__ import annotations

import hashlib
import json
import math
from collections import Counter
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike

from palpate._core import Contact, FirstContact, Miss, Model, Prior, Sensor
from palpate.model_json import document_of
from palpate.probe.errors import ERRORS, Array, Noise, PlanarErrors, random_rotation
from palpate.probe.protocol import AlreadyTouching, Fault, Hit, Reply, Skid, UnexpectedTouch
from palpate.rotations import rotation_of

MOST_TURNS = 1000  # are tried for one that leaves room


class SimulatedProbe:
    """A round tip, moved against the true part at its true pose (thesis 4.1, 4.3): a disc, in space a ball.

    The touch itself is exact; on it come the errors of the sensor. The tip moves parallel to its line, off
    it by up to `path_error`, in space to any side. It presses on by up to `overtravel` before it is read.
    The sensed centre is then off by so much more that the whole error stays within `position_error`, the
    sensed normal within `normal_error`. Free moves are exact. Touches on untouchable faces are skids, as
    those beyond the largest reliable incidence are.

    Same seed and same move, same reply, whatever was done before; a move that is made again has other
    errors. A touch sets the tip down at its start, wherever it was. Implements `Probe`.
    """

    def __init__(
        self,
        model: Model,
        world_from_model: ArrayLike,
        sensor: Sensor,
        *,
        seed: int = 0,
        noise: Noise = "uniform",
        overtravel: float = 0.0,
        believed: Sensor | None = None,
        position: ArrayLike | None = None,
    ) -> None:
        """A probe and the part that it touches.

        Args:
            model: The true part; it is touched as it is drawn, whatever its slacks are.
            world_from_model: Its pose, a rigid motion, shape `(d + 1, d + 1)`.
            sensor: Bounds of the errors that are made, tip radius and largest reliable incidence.
            seed: Chooses the errors.
            noise: `"uniform"`: errors uniform within the bounds: of the centre in the disc or ball, of the
                normal in the arc or cone. `"bounds"`: every error as large as it may be, its sign or its
                direction at random. `"none"`: no errors.
            overtravel: How far the tip may press on in its direction of travel before it is read: a
                one-sided error, at most `position_error`, of which it is a part.
            believed: Bounds that replies claim; those of `sensor` if not given. Smaller ones make a probe
                whose readings lie outside of their stated bounds.
            position: Where the tip is at first, shape `(d,)`; None: not known.

        Raises:
            ValueError: Another shape, no rigid motion, an unknown noise, a negative seed, an overtravel that
                does not fit into the position error, numbers that are not finite.
        """
        _check(model, sensor, believed, seed=seed, noise=noise)
        model.distance(world_from_model, np.zeros(model.dimension))  # refuses what is no pose
        if not (math.isfinite(overtravel) and 0.0 <= overtravel <= sensor.position_error):
            raise ValueError(
                f"overtravel: must be from zero to the position error, {sensor.position_error:g} "
                f"(got {overtravel!r}); give less, or a sensor with a larger position error"
            )
        self._model = model
        self._world_from_model = np.array(world_from_model, dtype=float)
        self._sensor = sensor
        self._believed = sensor if believed is None else believed
        self._noise: Noise = noise
        self._overtravel = float(overtravel)
        self._seed = seed
        self._times: Counter[bytes] = Counter()
        self._position = None if position is None else self._point_of("position", position)
        self._came_from: Array | None = None

    @property
    def simulation(self) -> dict[str, Any]:
        """All that the answers depend on beside the moves, as JSON."""
        return {
            **truth_entry(self._model, self._world_from_model),
            "sensor": sensor_entry(self._sensor),
            "believed": sensor_entry(self._believed),
            "noise": self._noise,
            "overtravel": self._overtravel,
            "seed": self._seed,
        }

    @property
    def position(self) -> Array | None:
        """Where the tip's centre is sensed to be, shape `(d,)`; None before the first move, unless given."""
        return None if self._position is None else self._position.copy()

    def touch(self, start: ArrayLike, end: ArrayLike) -> Reply:
        """Make one straight guarded move; see `Probe.touch`.

        Raises:
            ValueError: Another shape, a number that is not finite, a move of no length.
        """
        start, end = self._point_of("start", start), self._point_of("end", end)
        way = end - start
        length = float(np.hypot.reduce(way))
        if not length > 0.0:
            raise ValueError(
                f"end: must differ from start (got {end.tolist()} for both); give a move with a length"
            )
        direction = way / length
        errors = self._errors_of(start, end)
        begin = start + errors.across(direction, self._sensor.path_error)
        self._position, self._came_from = start, start
        if self._distance(begin) <= self._sensor.tip_radius:
            return AlreadyTouching()
        met = self._first_contact(begin, direction)
        if met is None or met.depth > length:
            self._position = end
            return self._free(start, end)
        center = self._sensed_center(met, direction, errors)
        self._position = center
        if not met.touchable or -direction @ met.normal < math.cos(self._sensor.max_incidence):
            short = float(direction @ (center - start)) - self._believed.position_error
            return Skid(self._free(start, start + max(0.0, short) * direction))
        normal = errors.turned(met.normal, self._sensor.normal_error or 0.0)
        return Hit(self._contact(start, direction, center, normal=normal))

    def made(self, start: ArrayLike, end: ArrayLike) -> None:
        """The guarded move was made before, by a run that is taken up: made again, it has other errors."""
        self._errors_of(self._point_of("start", start), self._point_of("end", end))

    def move(self, points: ArrayLike) -> UnexpectedTouch | Fault | None:
        """Move freely; see `Probe.move`. The way back to the start of the last guarded move is free.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """
        for k, point in enumerate(np.asarray(points, dtype=float)):
            point = self._point_of(f"points[{k}]", point)
            back = self._came_from is not None and np.array_equal(point, self._came_from)
            if self._position is not None and not back:
                where = self._obstacle(self._position, point)
                if where is not None:
                    self._position, self._came_from = where, None
                    return UnexpectedTouch(where)
            self._position, self._came_from = point, None
        return None

    def _obstacle(self, start: Array, end: Array) -> Array | None:
        """Where a free move touches."""
        if self._distance(start) < self._sensor.tip_radius:
            return start
        way = end - start
        length = float(np.hypot.reduce(way))
        if length == 0.0:
            return None
        met = self._first_contact(start, way / length)
        return met.center.copy() if met is not None and met.depth <= length else None

    def _point_of(self, argument: str, value: ArrayLike) -> Array:
        return point_of(argument, value, self._model.dimension)

    def _errors_of(self, start: Array, end: Array) -> PlanarErrors:
        """Chosen by the move itself, so that a run that is taken up again meets the same errors."""
        move = np.concatenate([start, end]) + 0.0  # no negative zeros
        self._times[move.tobytes()] += 1
        words = np.frombuffer(move.astype("<f8").tobytes(), dtype="<u4")
        random = np.random.default_rng([self._seed, self._times[move.tobytes()], *words.tolist()])
        return ERRORS[self._model.dimension](random, self._noise)

    def _distance(self, point: Array) -> float:
        return self._model.distance(self._world_from_model, point)

    def _first_contact(self, start: Array, direction: Array) -> FirstContact | None:
        return self._model.first_contact(self._world_from_model, start, direction, self._sensor.tip_radius)

    def _free(self, start: Array, end: Array) -> Miss:
        believed = self._believed
        return Miss(start, end, tip_radius=believed.tip_radius, path_error=believed.path_error)

    def _sensed_center(self, met: FirstContact, direction: Array, errors: PlanarErrors) -> Array:
        pressed = self._overtravel * (abs(errors.signed(1.0)) if self._overtravel else 0.0)
        error = errors.anywhere(self._sensor.position_error - self._overtravel)
        return np.asarray(met.center + pressed * direction + error)

    def _contact(self, start: Array, direction: Array, center: Array, *, normal: Array) -> Contact:
        believed = self._believed
        return Contact.from_tip(
            center,
            believed.tip_radius,
            position_error=believed.position_error,
            normal=None if believed.normal_error is None else normal,
            normal_error=believed.normal_error,
            approach=direction,
            start=start if believed.path_error <= believed.position_error else None,
        )


def _check(model: Any, sensor: Any, believed: Any, *, seed: Any, noise: Any) -> None:
    if not isinstance(model, Model):
        raise ValueError(f"model: must be a Model (got {model!r}); give palpate.Model")
    for name, value in (("sensor", sensor), ("believed", believed)):
        if not isinstance(value, Sensor) and not (name == "believed" and value is None):
            raise ValueError(f"{name}: must be a Sensor (got {value!r}); give palpate.Sensor")
        if value is not None and value.stem is not None:
            raise ValueError(
                f"{name}: its stem is not simulated (got {value!r}); give one without, stem=None"
            )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise ValueError(f"seed: must be a whole number, zero or more (got {seed!r}); give another one")
    if noise not in get_args(Noise):
        raise ValueError(f'noise: unknown (got {noise!r}); give "uniform", "bounds" or "none"')


def random_pose(
    model: Model,
    workspace: Array,
    *,
    room: float,
    random: np.random.Generator,
    prior: Prior | None = None,
) -> Array:
    """A pose at which the part lies within the workspace, `room` away from its border.

    Uniform in its turn, of those that leave room, and then in its place; with a prior, one of its poses.

    Raises:
        ValueError: None of many random turns leaves room.
    """
    d = model.dimension
    for _ in range(MOST_TURNS):
        if prior is not None:
            pose = pose_within(prior, random)
            placed = model.vertices @ pose[:d, :d].T + pose[:d, d]
            if (placed >= workspace[0] + room).all() and (placed <= workspace[1] - room).all():
                return pose
            continue
        rotation = random_rotation(d, random)
        turned = model.vertices @ rotation.T
        low, high = workspace[0] + room - turned.min(axis=0), workspace[1] - room - turned.max(axis=0)
        if (low <= high).all():
            pose = np.eye(d + 1)
            pose[:d, :d], pose[:d, d] = rotation, random.uniform(low, high)
            return pose
    raise ValueError(
        f"workspace: {model.name!r} has no room in it (got none of {MOST_TURNS} random "
        f"{'rotations' if prior is None else 'poses of the prior'}); give a larger one"
    )


def truth_entry(model: Model, world_from_model: Array) -> dict[str, Any]:
    """The part and its pose as JSON."""
    drawn = json.dumps(document_of(model, "mm"), sort_keys=True)  # lengths are as they are
    return {
        "truth": model.name,
        "truth_sha256": hashlib.sha256(drawn.encode()).hexdigest(),
        "world_from_model": world_from_model.tolist(),
    }


def pose_within(prior: Prior, random: np.random.Generator) -> Array:
    """One of a prior's poses: each bounded amount uniform within its bound, axes to any side."""
    pose = prior.world_from_model.copy()
    d = len(pose) - 1
    if prior.normal is None:
        shift = random.uniform(-prior.translation, prior.translation, d)
        turn = _turned_up_to(prior.rotation, random, d)
    else:
        normal = prior.normal
        aside = [np.cross(normal, axis) for axis in np.eye(3)]
        right = max(aside, key=lambda side: float(np.hypot.reduce(side)))
        right = right / np.hypot.reduce(right)
        up = np.cross(normal, right)
        around, tilted = random.uniform(-math.pi, math.pi, 2)
        way = prior.translation * math.sqrt(random.uniform())
        height = random.uniform(-1.0, 1.0) * (prior.height or 0.0)
        shift = way * (math.cos(around) * right + math.sin(around) * up) + height * normal
        axis = math.cos(tilted) * right + math.sin(tilted) * up
        tilt = rotation_of(random.uniform() * (prior.tilt or 0.0) * axis)
        turn = rotation_of(random.uniform(-prior.rotation, prior.rotation) * normal) @ tilt
    pose[:d, :d] = turn @ pose[:d, :d]
    pose[:d, d] += shift
    return pose


def _turned_up_to(angle: float, random: np.random.Generator, dimension: int) -> Array:
    if dimension == 2:
        turn = random.uniform(-angle, angle)
        return np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    axis = random.normal(size=3)
    return rotation_of(random.uniform() * angle * axis / np.hypot.reduce(axis))


def sensor_entry(sensor: Sensor) -> dict[str, Any]:
    """As JSON; the keys are the arguments of `Sensor`. A sensor without a stem has no key for it."""
    return {
        "position_error": sensor.position_error,
        "normal_error": sensor.normal_error,
        "max_incidence": sensor.max_incidence,
        "tip_radius": sensor.tip_radius,
        "path_error": sensor.path_error,
        **stem_entry(sensor),
    }


def stem_entry(sensor: Sensor) -> dict[str, Any]:
    """The stem alone, if there is one."""
    if sensor.stem is None:
        return {}
    direction, radius, length = sensor.stem
    return {"stem": [direction.tolist(), radius, length]}


def point_of(argument: str, value: ArrayLike, dimension: int = 2) -> Array:
    """A point of the plane, or of space, or a line that names the argument."""
    try:
        point = np.array(value, dtype=float)
    except (TypeError, ValueError):
        point = np.array([])
    if point.shape != (dimension,):
        where, example = {2: ("the plane", "(x, y)"), 3: ("space", "(x, y, z)")}[dimension]
        raise ValueError(
            f"{argument}: must be a point of {where}, shape ({dimension},) (got {value!r}); give {example}"
        )
    if not np.isfinite(point).all():
        raise ValueError(f"{argument}: must be finite (got {value!r}); give finite numbers")
    return point
