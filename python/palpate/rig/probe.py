"""A probe of the rig: `palpate.identify` moves it as it would move the hardware."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._core import Contact, Miss, Model, Sensor
from palpate.contacts.entry import mm_per
from palpate.loop.route import workspace_of
from palpate.loop.wander import path_error_of
from palpate.probe.protocol import AlreadyTouching, Fault, Hit, Reply, Skid, UnexpectedTouch
from palpate.probe.simulated import point_of, sensor_entry, truth_entry
from palpate.rig.bounds import MAX_INCIDENCE, SIZE, Bounds, bounds_of, rig_sensor
from palpate.rig.gauges import Gauges
from palpate.rig.guarded import Line
from palpate.rig.machine import Machine, RigFault
from palpate.rig.outer import Met, OuterLoop, Reading
from palpate.rig.plant import Plant
from palpate.rig.recording import Recording, Segment
from palpate.rig.specification import RigSpec, check

Array: TypeAlias = NDArray[np.float64]


class RigProbe:
    """The thesis's manipulator and force sensor, simulated (appendix A, 4.3). Implements `palpate.Probe`.

    The part lies fixed in the workspace. Contacts, normals and ways come from gauges and encoders
    alone; their bounds are derived from the specification (`bounds`). After a contact or a skid the tip backs
    off a little, the way it came. After a fault the rig moves no more.

    The same seed and the same moves give the same replies, bit for bit. A rig that is made anew, as where a
    run is resumed, is one that was switched on anew: the next move finds it where it begins.
    """

    def __init__(
        self,
        model: Model,
        world_from_model: ArrayLike,
        sensor: Sensor | None = None,
        *,
        spec: RigSpec | None = None,
        workspace: ArrayLike | None = None,
        unit: str = "mm",
        seed: int = 0,
    ) -> None:
        """A rig and the part that it touches.

        Args:
            model: The part; closed.
            world_from_model: Its pose, a rigid motion, shape `(d + 1, d + 1)`.
            sensor: Bounds that replies claim, no smaller than the derived ones, in `unit`; None: those,
                `rig_sensor`. Its largest incidence is the rig's, its tip radius that of the bearing.
            spec: What the rig is built of, in mm, N and s; the thesis's if not given.
            workspace: Two opposite corners, shape `(2, d)`, in `unit`; the axes go a little beyond.
                290 × 320 (× 200) mm from the origin if not given.
            unit: Of the model and of all places.
            seed: Chooses what tolerances leave open, and all noise.

        Raises:
            ValueError: Another shape, no rigid motion, an open part, a bound that is too small, an unknown
                unit, a library that is missing.
        """
        if not isinstance(model, Model):
            raise ValueError(f"model: must be a Model (got {model!r}); give palpate.Model")
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise ValueError(f"seed: must be a whole number, zero or more (got {seed!r}); give another one")
        spec = RigSpec() if spec is None else spec
        check(spec)
        d = model.dimension
        model.distance(world_from_model, np.zeros(d))  # refuses what is no pose
        self._mm = mm_per(unit, "unit")
        if workspace is None:
            corners = np.array([np.zeros(d), SIZE[d]])
        else:
            corners = workspace_of(workspace, d) * self._mm
        self._workspace = corners
        self._model, self._spec, self._seed = model, spec, seed
        self._world_from_model = np.array(world_from_model, dtype=float)
        incidence = MAX_INCIDENCE if sensor is None else sensor.max_incidence
        size = tuple(float(side) for side in np.ptp(corners, axis=0))
        self._bounds = bounds_of(spec, dimension=d, size=size, max_incidence=incidence)
        derived = rig_sensor(spec, dimension=d, size=size, max_incidence=incidence, unit=unit)
        self._sensor = derived if sensor is None else _claimed(sensor, derived)
        # As the loop takes it: a sensor that states none may leave its line by its position error.
        self._path_error = path_error_of(self._sensor)
        drawn = [np.random.default_rng([seed, 2, k]) for k in range(3)]
        plant = Plant(
            model,
            self._world_from_model,
            spec,
            middle=corners.mean(axis=0),
            unit_mm=self._mm,
            random=drawn[0],
        )
        gauges = Gauges(spec.beam, spec.electronics, dimension=d, random=drawn[1])
        self._machine = Machine(plant, gauges, spec, random=drawn[2])
        self._outer = OuterLoop(self._machine, self._bounds)
        self._position: Array | None = None
        self._broken: str | None = None
        self.overshoots: list[float] = []
        """Largest force of each guarded move that touched, until the tip stood, N."""

    @property
    def sensor(self) -> Sensor:
        """What its replies claim, in the unit of the model; for `palpate.identify`."""
        return self._sensor

    @property
    def spec(self) -> RigSpec:
        """What it is built of."""
        return self._spec

    @property
    def bounds(self) -> Bounds:
        """The derived bounds, source by source, in mm, N and radians."""
        return self._bounds

    @property
    def recording(self) -> Recording:
        """Force, position and state at every tick so far, in mm, N and s."""
        return self._machine.recording

    @property
    def plant(self) -> Plant:
        """The physics, which knows the truth."""
        return self._machine.plant

    @property
    def clock(self) -> float:
        """Simulated seconds since it was switched on."""
        return self._machine.time

    @property
    def simulation(self) -> dict[str, Any]:
        """All that the answers depend on beside the moves, as JSON."""
        return {
            **truth_entry(self._model, self._world_from_model),
            "rig": asdict(self._spec),
            "sensor": sensor_entry(self._sensor),
            "workspace": (self._workspace / self._mm).tolist(),
            "seed": self._seed,
        }

    @property
    def position(self) -> Array | None:
        """Where the tip's centre is sensed to be, shape `(d,)`; None before the first move."""
        return None if self._position is None else self._position / self._mm

    def touch(self, start: ArrayLike, end: ArrayLike) -> Reply:
        """Make one straight guarded move; see `Probe.touch`.

        Raises:
            ValueError: Another shape, a number that is not finite, a move of no length or out of reach.
        """
        begin, finish = self._place_of("start", start), self._place_of("end", end)
        if np.array_equal(begin, finish):
            raise ValueError(
                f"end: must differ from start (got {np.asarray(end).tolist()} for both); "
                "give a move with a length"
            )
        began = self._machine.time
        reply = self._guarded_reply(lambda: self._touched(Line(begin, finish)))
        name = type(reply).__name__
        self.recording.segments.append(Segment("touch", began, self._machine.time, name))
        return reply

    def move(self, points: ArrayLike) -> UnexpectedTouch | Fault | None:
        """Move freely from place to place; see `Probe.move`.

        Raises:
            ValueError: Another shape, a number that is not finite, a place out of reach.
        """
        given = np.array(points, dtype=float)
        if given.ndim != 2:
            raise ValueError(f"points: must be places, shape (n, {self._model.dimension}) (got {points!r})")
        places = [self._place_of(f"points[{k}]", point) for k, point in enumerate(given)]
        began = self._machine.time
        reply = self._guarded_reply(lambda: self._moved(places))
        name = type(reply).__name__.removesuffix("Type")
        self.recording.segments.append(Segment("move", began, self._machine.time, name))
        return reply

    def _guarded_reply(self, work: Any) -> Any:
        """What the work answers, or the fault that it ran into; after one, nothing is done any more."""
        if self._broken is not None:
            return Fault(self._broken)
        try:
            return work()
        except RigFault as fault:
            self._broken = f"{fault}; the rig stopped"
            return Fault(str(fault))

    def _moved(self, places: list[Array]) -> UnexpectedTouch | None:
        for place in places:
            if self._position is None:
                self._machine.plant.place(place)
                self._position = place
            touched = self._outer.go(place, speed=self._spec.control.free_speed, state="free")
            self._position = self._machine.plant.encoders
            if touched is not None:
                return UnexpectedTouch(self._position / self._mm)
        return None

    def _touched(self, line: Line) -> Reply:
        if self._position is None:
            self._machine.plant.place(line.start)
            self._position = line.start
        met = self._moved([line.start])
        if met is not None:
            return met
        if self._outer.zero() is None:
            return AlreadyTouching()
        touched = self._outer.guarded(line)
        if touched is None:
            self._position = line.end
            return self._free(line, line.length)
        self.overshoots.append(touched.most_force)
        reading = self._outer.read(touched)
        self._position = self._machine.plant.encoders
        return self._skid(line, touched.free) if reading is None else self._read(line, touched, reading)

    def _read(self, line: Line, met: Met, reading: Reading) -> Reply:
        sensor = self._sensor
        steepest = math.cos(min(math.pi, sensor.max_incidence + self._bounds.normal_error))
        if -float(line.direction @ reading.normal) < steepest:
            return self._skid(line, min(met.free, line.depth(reading.center)))
        has_normal = sensor.normal_error is not None and not reading.corner
        return Hit(
            Contact.from_tip(
                reading.center / self._mm,
                sensor.tip_radius,
                position_error=sensor.position_error,
                normal=reading.normal if has_normal else None,
                normal_error=sensor.normal_error if has_normal else None,
                approach=line.direction,
                start=line.start / self._mm if self._path_error <= sensor.position_error else None,
            )
        )

    def _skid(self, line: Line, depth: float) -> Skid:
        return Skid(self._free(line, max(0.0, depth - self._sensor.position_error * self._mm)))

    def _free(self, line: Line, length: float) -> Miss:
        sensor = self._sensor
        return Miss(
            line.start / self._mm,
            line.at(length) / self._mm,
            tip_radius=sensor.tip_radius,
            path_error=self._path_error,
        )

    def _place_of(self, argument: str, value: ArrayLike) -> Array:
        place = point_of(argument, value, self._model.dimension) * self._mm
        overrun = self._spec.gantry.overrun
        low, high = self._workspace[0] - overrun, self._workspace[1] + overrun
        if (place < low).any() or (place > high).any():
            raise ValueError(
                f"{argument}: is out of reach (got {np.asarray(value).tolist()}); the gantry goes from "
                f"{(low / self._mm).tolist()} to {(high / self._mm).tolist()}: give another place"
            )
        return place


def _claimed(sensor: Sensor, least: Sensor) -> Sensor:
    """The sensor that is asked for, if the rig is as good.

    Raises:
        ValueError: A bound smaller than the derived one; another tip.
    """
    own = (
        ("position_error", sensor.position_error, least.position_error),
        ("path_error", path_error_of(sensor), least.path_error),
    )
    for name, asked, bound in own:
        if asked < bound:
            raise ValueError(
                f"sensor: its {name} must hold for the rig, at least {bound:.4g} (got {asked:g}); "
                "give more, or a better spec"
            )
    normal = sensor.normal_error
    if normal is not None and least.normal_error is not None and normal < least.normal_error:
        raise ValueError(
            "sensor: its normal_error must hold for the rig, at least "
            f"{math.degrees(least.normal_error):.4g}° (got {math.degrees(normal):g}°); "
            "give more, or a better spec"
        )
    if not math.isclose(sensor.tip_radius, least.tip_radius, rel_tol=1e-9):
        raise ValueError(
            f"sensor: its tip_radius must be that of the bearing, {least.tip_radius:g} "
            f"(got {sensor.tip_radius:g}); give that, or another spec"
        )
    return sensor
