"""What the rig is built of: every number that its behaviour and its bounds depend on.

Lengths in mm, forces in N, times in s, masses in kg, angles in radians where the name does not say degrees.
What is called a spread or a tolerance bounds an error that is drawn once for a rig, by its seed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any

from palpate.rig.beam import Beam


@dataclass(frozen=True)
class Electronics:
    """Gauges, bridge, amplifier and A/D converter, of each direction one (figure A.5)."""

    gauge_factor: float = 2.0
    excitation: float = 10.0
    """Of the bridge, V."""
    full_scale: float = 32.0
    """Force at which a nominal channel reaches the end of the converter's range, N."""
    range_volts: float = 5.0
    """The converter's, to either side."""
    bits: int = 12
    gain_spread: float = 0.05
    """Of gauges, glue and amplifier together, as a share."""
    axis_spread: float = math.radians(0.5)
    """How far a pair of gauges may be turned from its axis."""
    offset: float = 0.2
    """Of a channel at no force, as a share of the range."""
    noise: float = 1.0
    """Shot noise, standard deviation in counts; 0: none."""
    noise_clip: float = 4.0
    """In standard deviations: no sample is noisier."""
    drift: float = 0.003
    """Fastest that warming shifts a channel, N/s; 0: none."""
    warming: float = 300.0
    """Time constant of warming up, s."""
    creep: float = 0.005
    """Share of a constant force by which the reading creeps in the end; 0: none."""
    creep_time: float = 15.0
    """Time constant of creep, s."""
    burst: int = 8
    """Conversions of a burst; there are `BURSTS` to a tick."""


@dataclass(frozen=True)
class Bearing:
    """The ball bearing on the tip; in space a ball that turns any way."""

    radius: float = 5.0
    mass: float = 0.0033
    friction_torque: float = 0.02
    """Most that it takes to turn, N·mm, about each axis."""
    surface_friction: float = 0.15
    """Coulomb's, between the outer race and the part; the race turns before it slides."""


@dataclass(frozen=True)
class Jig:
    """How the sensor is calibrated: known weights hung from the bearing."""

    weight: float = 9.0
    """N."""
    weight_tolerance: float = 0.0005
    """As a share."""
    direction_tolerance: float = math.radians(0.03)
    """How far from an axis the weight may pull."""
    seconds: float = 1.0
    """For which each weight is read."""
    stiffness_tolerance: float = 0.03
    """Of the tip's true stiffness, arm and gripper included: how far from the beam's own, as a share."""


@dataclass(frozen=True)
class Gantry:
    """Axes with velocity servos."""

    mass: float = 5.0
    """That each axis moves, kg."""
    friction: float = 2.0
    """Coulomb's, of each axis, N."""
    servo_hz: float = 30.0
    """Bandwidth of the velocity servo, critically damped."""
    most_drive: float = 150.0
    """Of a motor, N."""
    overrun: float = 30.0
    """That the tip can go beyond the workspace, to either side: paths may end there."""
    resolution: float = 0.02
    """Step of the encoders."""
    scale_tolerance: float = 1e-4
    """Of an axis, as a share of the way from its middle."""
    square_tolerance: float = 2e-4
    """How far axes are from square, radians."""


@dataclass(frozen=True)
class Control:
    """Rates, gains and limits (A.2)."""

    rate_hz: float = 60.0
    free_speed: float = 100.0
    """mm/s, of free moves."""
    guard_speed: float = 20.0
    """mm/s, of guarded moves."""
    acceleration: float = 500.0
    """mm/s²."""
    near_gain: float = 8.0
    """Of the position servo near its goal, 1/s; farther out the gain falls so that it brakes in time."""
    lateral_gain: float = 6.0
    """That brings the tip back to its line, 1/s."""
    off_line: float = 0.1
    """Farther from its line, as the encoders have it, a guarded move is a fault."""
    guard_force: float = 0.5
    """N: more is a contact."""
    force: float = 9.0
    """N, at which a contact is read."""
    force_band: float = 0.5
    """N about it: there the force is right; the force that is read is within twice that."""
    light_gain: float = 1.0
    """mm/s per N that the force is below the band."""
    firm_gain: float = 2.0
    """mm/s per N within the band."""
    back_gain: float = 3.0
    """mm/s per N above the band."""
    most_pressing: float = 8.0
    """mm/s, while in contact."""
    on_line: float = 0.03
    """The tip is back where it touched first, across its line."""
    settle: float = 8.0
    """s: a contact that takes longer, reading and all, does not settle."""
    quiet: float = 0.1
    """s, at rest before anything is read."""
    reading: float = 0.25
    """s, over which samples are averaged."""
    rock: float = 0.3
    """mm to either side: rolled so far, only a corner that sticks in turns the force against the motion."""
    rock_turn_deg: float = 0.25
    """By how much it may seem to, elsewhere."""
    back_off: float = 2.0
    """mm, from the contact, to take the zero."""
    back_speed: float = 20.0
    """mm/s, at which it does."""
    clear: float = 0.18
    """mm, to several sides: a tip that takes its zero must be able to go there without a change of force."""
    clear_within: float = 4.0
    """s, in which it does."""
    zero_within: float = 1.0
    """s: the zero is taken so soon after the reading."""
    rock_within: float = 1.5
    """s, for each direction along the surface: so soon before the reading the tip is rocked."""


@dataclass(frozen=True)
class RigSpec:
    """A rig. `RigSpec()` is the thesis's, its beam recomputed."""

    beam: Beam = field(default_factory=Beam)
    electronics: Electronics = field(default_factory=Electronics)
    bearing: Bearing = field(default_factory=Bearing)
    jig: Jig = field(default_factory=Jig)
    gantry: Gantry = field(default_factory=Gantry)
    control: Control = field(default_factory=Control)
    stem_radius: float = 2.5
    """Of the rod that stands for the beam where it might touch; half its side."""

    @property
    def moving_mass(self) -> float:
        """Of the tip on its spring, kg."""
        return self.beam.tip_mass + self.bearing.mass

    def most_pressed(self, speed: float) -> float:
        """How far a guarded move may press on, mm: two ticks, the servo's lag, the guard force."""
        lag = 2.0 / (2.0 * math.pi * self.gantry.servo_hz)
        stiffness = self.beam.stiffness * (1.0 - self.jig.stiffness_tolerance)
        return speed * (2.0 / self.control.rate_hz + lag) + self.control.guard_force / stiffness


def without_errors(spec: RigSpec, *names: str) -> RigSpec:
    """The same rig without some errors of its force sensor: `"drift"`, `"creep"`, `"noise"`.

    Its bounds are those of a rig that is known to be without.

    Raises:
        ValueError: Another name.
    """
    for name in names:
        if name not in ("drift", "creep", "noise"):
            raise ValueError(f'names: unknown (got {name!r}); give some of "drift", "creep" and "noise"')
    own = spec.electronics
    drift, creep, noise = (
        0.0 if name in names else value
        for name, value in (("drift", own.drift), ("creep", own.creep), ("noise", own.noise))
    )
    return replace(spec, electronics=replace(own, drift=drift, creep=creep, noise=noise))


BURSTS = 4
"""Of conversions, in a tick."""

_MAY_BE_ZERO = {
    "gain_spread",
    "axis_spread",
    "offset",
    "noise",
    "drift",
    "creep",
    "friction_torque",
    "surface_friction",
    "weight_tolerance",
    "direction_tolerance",
    "stiffness_tolerance",
    "friction",
    "scale_tolerance",
    "square_tolerance",
    "overrun",
}
_LESS_THAN_HALF = {"gain_spread", "axis_spread", "offset", "creep", "stiffness_tolerance"}


def check(spec: Any) -> None:
    """Refuse numbers that no rig has.

    Raises:
        ValueError: Naming the number.
    """
    if not isinstance(spec, RigSpec):
        raise ValueError(f"spec: must be a RigSpec (got {spec!r}); give palpate.rig.RigSpec")
    for group in fields(spec):
        part = getattr(spec, group.name)
        numbers = {group.name: part} if isinstance(part, int | float) else vars(part)
        for name, value in numbers.items():
            where = name if part is value else f"{group.name}.{name}"
            _check_number(where, name, value)
    if not spec.beam.gauge_at < spec.beam.length:
        raise ValueError(
            f"spec.beam.gauge_at: must be less than the length (got {spec.beam.gauge_at:g} of "
            f"{spec.beam.length:g}); put the gauges on the beam"
        )
    control = spec.control
    if not control.force + 2.0 * control.force_band < spec.beam.most_force:
        raise ValueError(
            f"spec.control.force: must stay below what the beam bears, {spec.beam.most_force:g} N "
            f"(got {control.force:g}); press less"
        )
    stiffest = spec.beam.stiffness * (1.0 + spec.jig.stiffness_tolerance)
    if not spec.most_pressed(control.guard_speed) * stiffest < spec.beam.most_force:
        raise ValueError(
            "spec.control.guard_speed: must be so slow that the beam bears a touch, "
            f"{spec.beam.most_force:g} N (got {control.guard_speed:g} mm/s); move slower"
        )
    electronics = spec.electronics
    most_read = electronics.full_scale * (1.0 - electronics.offset) / (1.0 + electronics.gain_spread)
    if not most_read > spec.beam.most_force:
        raise ValueError(
            "spec.electronics.full_scale: must hold what the beam bears, offset and gain spread beside it, "
            f"{spec.beam.most_force:g} N (got {electronics.full_scale:g}, which leaves {most_read:.3g}); "
            "give more"
        )
    if not spec.bearing.radius > spec.stem_radius:
        raise ValueError(
            f"spec.bearing.radius: must be larger than the stem's, {spec.stem_radius:g} mm, which touches "
            f"first otherwise (got {spec.bearing.radius:g}); give a larger bearing"
        )


def _check_number(where: str, name: str, value: Any) -> None:
    number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    least = "zero or more" if name in _MAY_BE_ZERO else "above zero"
    if not number or value < 0.0 or (value == 0.0 and name not in _MAY_BE_ZERO):
        raise ValueError(f"spec.{where}: must be a number, {least} (got {value!r}); give another one")
    if name in _LESS_THAN_HALF and value >= 0.5:
        raise ValueError(f"spec.{where}: must be less than a half (got {value!r}); give a share")
