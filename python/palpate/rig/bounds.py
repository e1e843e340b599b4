"""The bounds of the rig's readings, derived from its specification (`docs/rig.md`, with proofs).

Every source is taken at its worst but shot noise, whose averages are bounded with the probability `RARELY`
to be passed. Nothing here is measured or fitted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from palpate._core import Sensor
from palpate.contacts.entry import mm_per
from palpate.rig.gauges import count_force
from palpate.rig.servo import THERE, seconds_for
from palpate.rig.specification import BURSTS, RigSpec, check

RARELY = 1e-9
"""Probability that the average of one channel's samples passes its bound."""
MAX_INCIDENCE = math.radians(60)
"""Ω unless another is asked for."""
RESTLESS = 0.1
"""N: by how much ticks of a reading may differ beyond their noise; a tip that moves more is not at rest."""


@dataclass(frozen=True)
class Bounds:
    """What each source may contribute. Forces in N, lengths in mm, angles in radians."""

    forces: dict[str, float]
    """That the sensed force may be off by, beside its share, and that no normal force has."""
    gain: float
    """Share of the force by which the calibrated gains may be off, direction included."""
    least_force: float
    """Least force between the tip and the part when it is read."""
    corner: float
    """By how much a second contact in a corner that sticks in may turn the force, unnoticed."""
    repeat: float
    """By how much the directions of two readings of one force may differ."""
    still: float
    """N, by which two averages of a tip that is clear may differ, apart from what they do with time."""
    creeping: float
    """N/s, at which the force that is sensed of a tip may change of itself."""
    geometry: float
    """By which the axes may be off, wherever they are."""
    rest: dict[str, float]
    """That the sensed centre may be off the place where the tip rests, beside the axes."""
    slide: dict[str, float]
    """That the tip may rest from where it touched first, across its line."""
    path: dict[str, float]
    """That the tip may leave the line of a guarded move."""
    max_incidence: float
    """Ω, for which `position_error` holds."""

    @property
    def planar_normal_error(self) -> float:
        """Of a contact at a single place, radians."""
        aside = sum(self.forces.values()) / self.least_force
        return math.asin(min(1.0, self.gain)) + math.asin(min(1.0, aside))

    @property
    def normal_error(self) -> float:
        """Of any contact whose normal is given, radians."""
        return min(math.pi / 2, self.planar_normal_error + self.corner + self.repeat)

    @property
    def position_error(self) -> float:
        """Of the tip's centre, mm: both where it rests and where it touched first are within."""
        steepest = self.max_incidence + 2.0 * self.normal_error
        if steepest >= math.pi / 2:
            return math.inf
        near = sum(self.rest.values()) + sum(self.slide.values())
        return self.geometry + near / math.cos(steepest)

    @property
    def path_error(self) -> float:
        """Of a guarded move, mm."""
        return sum(self.path.values())


def bounds_of(
    spec: RigSpec, *, dimension: int, size: tuple[float, ...], max_incidence: float = MAX_INCIDENCE
) -> Bounds:
    """The bounds of a rig whose workspace has a size of `size` mm along each axis."""
    check(spec)
    control, bearing, beam = spec.control, spec.bearing, spec.beam
    root = math.sqrt(dimension)
    most_read = control.force + 2.0 * control.force_band
    stiffness = beam.stiffness * (1.0 - spec.jig.stiffness_tolerance)
    noise = root * _average(spec, control.reading)
    drift = root * spec.electronics.drift
    creep = 2.0 * spec.electronics.creep * most_read / spec.electronics.creep_time
    # As fast as it was pressed the tip may swing, until it was left alone for a while.
    swing = spec.moving_mass * _swing(spec) * control.most_pressing * 1e-3
    inertia = swing * math.exp(-spec.beam.damping * _swing(spec, -1.0) * control.quiet)
    rolling = bearing.friction_torque * (1.0 if dimension == 2 else root) / bearing.radius
    forces = {
        "noise and rounding of the reading": noise,
        "noise and rounding of the zero": noise,
        "drift between the two": drift * control.zero_within,
        "creep between the two": creep * control.zero_within,
        "bearing friction": rolling,
        "inertia of the tip": inertia,
    }
    gain = _gain(spec, dimension)
    least = (control.force - 2.0 * control.force_band) / (1.0 + gain) - sum(forces.values())
    # Readings of a rock are as far apart as the first from the zero; the bearing may hold either way.
    apart = 2.0 * noise + (drift + creep) * control.rock_within * (dimension - 1) + 2.0 * (rolling + inertia)
    if not least > max(sum(forces.values()), apart):
        raise ValueError(
            f"spec: its errors, {sum(forces.values()):.3g} N, are too large for the force of "
            f"{control.force:g} N; press harder, or give smaller errors"
        )
    still = noise + root * _average(spec, control.quiet) + 2.0 * (rolling + inertia)
    encoder = root * spec.gantry.resolution / 2.0
    # What touches, however lightly, is pressed by moving to one of the sides (B8).
    way = control.clear - THERE - 2.0 * encoder
    pressed = (1.0 - gain) * stiffness * way / dimension
    if not pressed > 2.0 * (still + (drift + creep) * control.clear_within):
        raise ValueError(
            "spec.control.clear: must be enough to tell a touch from what drifts "
            f"(got {control.clear:g} mm); give more"
        )
    geometry = _geometry(spec, size)
    most = most_read / stiffness
    off = (most_read * gain + sum(forces.values())) / stiffness
    guard = _guard_deflection(spec, dimension, stiffness, size=size)
    return Bounds(
        forces=forces,
        gain=gain,
        least_force=least,
        corner=math.radians(control.rock_turn_deg) * (1.0 if dimension == 2 else math.sqrt(2.0)),
        repeat=math.asin(apart / least) * (1.0 if dimension == 2 else math.sqrt(2.0)),
        still=still,
        creeping=drift + creep,
        geometry=geometry,
        rest={
            "steps of the encoders": encoder,
            "stiffness of the tip": most * spec.jig.stiffness_tolerance,
            "error of the force": off,
        },
        slide={
            "tip is back on its line": control.on_line,
            "steps of the encoders before it touched": encoder,
            "bending below the guard force": guard,
        },
        path={
            "line kept by the encoders": control.off_line,
            "steps of the encoders": encoder,
            "scales and squareness of the axes": geometry,
            "bending below the guard force": guard,
            "between two ticks": _grazed(spec),
            "short of its end": THERE,
        },
        max_incidence=max_incidence,
    )


def rig_sensor(
    spec: RigSpec | None = None,
    *,
    dimension: int = 2,
    size: tuple[float, ...] | None = None,
    max_incidence: float = MAX_INCIDENCE,
    unit: str = "mm",
) -> Sensor:
    """The rig as a `palpate.Sensor`: its derived bounds.

    Args:
        spec: The rig; the thesis's if not given.
        dimension: 2 or 3.
        size: Of the workspace along each axis, mm; 290 × 320 (× 200) if not given.
        max_incidence: Ω, radians: steeper touches are skids.
        unit: Of the sensor's lengths.

    Raises:
        ValueError: A number that no rig has; errors that leave no bound.
    """
    spec = RigSpec() if spec is None else spec
    size = SIZE[dimension] if size is None else size
    bounds = bounds_of(spec, dimension=dimension, size=size, max_incidence=max_incidence)
    if not math.isfinite(bounds.position_error):
        raise ValueError(
            f"max_incidence: leaves the place of a contact unbounded (got {math.degrees(max_incidence):g}°); "
            "give a smaller one"
        )
    mm = mm_per(unit, "unit")
    rod = ((0.0, 0.0, 1.0), spec.stem_radius / mm, spec.beam.length / mm)
    return Sensor(
        bounds.position_error / mm,
        bounds.normal_error,
        max_incidence,
        spec.bearing.radius / mm,
        bounds.path_error / mm,
        stem=None if dimension == 2 else rod,
    )


FROM_ABOVE = ((0.0, 0.0, -1.0), math.radians(57))
"""Directions of guarded moves in space, for `palpate.identify`: the stem comes from above."""
SIZE: dict[int, tuple[float, ...]] = {2: (290.0, 320.0), 3: (290.0, 320.0, 200.0)}
"""Of the workspace, mm (thesis 4.3; its height is ours)."""


def _average(spec: RigSpec, seconds: float) -> float:
    """Bound of an average over a window, in N of one channel (B1)."""
    electronics = spec.electronics
    number = max(1, round(seconds * spec.control.rate_hz)) * BURSTS * electronics.burst
    sigma = electronics.noise
    factor = math.sqrt(2.0 * math.log(2.0 / RARELY) / number)
    plain = 0.5 + min(factor * sigma, electronics.noise_clip * sigma)
    # Noise of half a count or more dithers: rounding errors average out too.
    clipped = math.erfc(electronics.noise_clip / math.sqrt(2.0))
    dithered = factor * (sigma + 0.5) + math.exp(-2.0 * (math.pi * sigma) ** 2) / math.pi + clipped
    counts = min(plain, dithered) if sigma >= 0.5 else plain
    return counts * _newtons_per_count(spec)


def quiet_counts(spec: RigSpec) -> float:
    """By how much counts of a tip at rest may differ from tick to tick."""
    noise = 2.0 * _average(spec, 1.0 / spec.control.rate_hz) / _newtons_per_count(spec)
    return noise + RESTLESS / count_force(spec.electronics)


def _newtons_per_count(spec: RigSpec) -> float:
    """Most that a count may stand for: norm of the inverse sensitivity (B2)."""
    electronics = spec.electronics
    turned = 1.0 - math.sqrt(3.0) * 2.0 * math.sin(electronics.axis_spread / 2.0)
    return count_force(electronics) / ((1.0 - electronics.gain_spread) * turned)


def _gain(spec: RigSpec, dimension: int) -> float:
    """Share by which calibrated gains may be off (B3)."""
    jig, root = spec.jig, math.sqrt(dimension)
    column = (
        math.hypot(
            jig.weight_tolerance, 2.0 * math.sin(jig.direction_tolerance / 2.0) * (1.0 + jig.weight_tolerance)
        )
        + root * _average(spec, jig.seconds) / jig.weight
        + root * spec.electronics.drift * jig.seconds / (2.0 * jig.weight)
        + _crept(spec, jig.seconds) * (1.0 + jig.weight_tolerance)
    )
    whole = root * column
    if whole >= 0.5:
        raise ValueError(f"spec.jig: leaves gains unknown by {whole:.2g}; give smaller tolerances")
    return whole / (1.0 - whole)


def _crept(spec: RigSpec, seconds: float) -> float:
    """Share of a force that has crept after so long."""
    electronics = spec.electronics
    return electronics.creep * (1.0 - math.exp(-seconds / electronics.creep_time))


def _swing(spec: RigSpec, side: float = 1.0) -> float:
    """Of the tip on its spring, radians per second: the most, or the least."""
    stiffness = spec.beam.stiffness * (1.0 + side * spec.jig.stiffness_tolerance)
    return math.sqrt(stiffness * 1e3 / spec.moving_mass)


def _geometry(spec: RigSpec, size: tuple[float, ...]) -> float:
    """Of the axes, wherever they are (B6)."""
    gantry, half = spec.gantry, [way / 2.0 + spec.gantry.overrun for way in size]
    return math.hypot(
        *(
            (gantry.scale_tolerance + gantry.square_tolerance**2) * own
            + gantry.square_tolerance * (sum(half) - own)
            for own in half
        )
    )


def _guard_deflection(spec: RigSpec, dimension: int, stiffness: float, *, size: tuple[float, ...]) -> float:
    """How far the tip may be bent aside without a contact being noticed, mm (B7)."""
    control, root = spec.control, math.sqrt(dimension)
    # The zero is as old as the longest move, and what the last contact left creeps back.
    longest = math.hypot(*(side + 2.0 * spec.gantry.overrun for side in size))
    seconds = control.reading + seconds_for(control, longest, control.guard_speed)
    late = root * (2.0 * _average(spec, 1.0 / control.rate_hz) + spec.electronics.drift * seconds)
    late += spec.electronics.creep * (control.force + 2.0 * control.force_band)
    if not late < control.guard_force:
        raise ValueError(
            "spec.control.guard_speed: is so slow that drift may pass for a touch "
            f"(got {control.guard_speed:g} mm/s for up to {longest:.4g} mm); move faster, or not so far"
        )
    return (control.guard_force * (1.0 + _gain(spec, dimension)) + late) / stiffness


def _grazed(spec: RigSpec) -> float:
    """How deep a disc passes a point between two ticks (B7)."""
    way = spec.control.guard_speed / spec.control.rate_hz
    return way * way / (4.0 * spec.bearing.radius)
