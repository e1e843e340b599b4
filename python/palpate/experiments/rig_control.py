"""The rig's control: how far a guarded move presses on at each speed, and steps of each control mode.

Problem `k` of kind `g`: kinds are speeds, then modes of control, each at several gains.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from palpate import Fault, Hit, Model
from palpate.experiments.campaign import Row
from palpate.experiments.experiment import SEEDS, Experiment, Picture
from palpate.experiments.pages import table
from palpate.plots.style import COLORS
from palpate.rig import SIZE, Control, RigProbe, RigSpec
from palpate.rig.admittance import Admittance
from palpate.rig.gauges import Gauges
from palpate.rig.guarded import GuardedMove, Line
from palpate.rig.machine import Machine
from palpate.rig.plant import Plant
from palpate.rig.servo import PositionServo

REPEATS = 20
SPEEDS = (5.0, 10.0, 20.0, 30.0, 40.0, 50.0)  # mm/s; faster ones are more than the beam bears
GAINS = (1.0, 2.0, 4.0)  # times those of the rig
SECONDS = 1.5  # of a step
FACE = 100.0  # mm: x of the face of a block that is touched
BLOCK = Model.polygon([[FACE, 60.0], [FACE + 80.0, 60.0], [FACE + 80.0, 260.0], [FACE, 260.0]], name="block")
NEAR = [[FACE - 60.0, 120.0], [FACE + 60.0, 200.0]]  # a workspace in which slow moves do not drift too far
OFF = 1.0  # mm from its line, to which a guarded move goes back
ALONG = 0.5  # mm along the surface
FAR = 10.0  # mm to a place
SPEED = 20.0  # mm/s
MODES = ("velocity servo", "position servo", "guarded move", "admittance: force", "admittance: along")
WHAT = {
    "velocity servo": "20 mm/s is asked for",
    "position servo": "a place 10 mm away is asked for",
    "guarded move": "1 mm off its line, it goes back to it",
    "admittance: force": "9 N are asked for after it touched",
    "admittance: along": "0.5 mm along the surface, it goes back to its line",
}
SETTLED = 0.05  # of the step
# Kinds: speeds, then modes at gains.
STEPS = tuple((mode, gain) for mode in MODES for gain in (GAINS if mode != "velocity servo" else (1.0,)))


def task(number: int) -> Row:
    """A guarded move into a block, or a step."""
    repeat, kind = divmod(number % SEEDS, len(SPEEDS) + len(STEPS))
    if kind < len(SPEEDS):
        return overshoot(SPEEDS[kind], number)
    mode, gain = STEPS[kind - len(SPEEDS)]
    return step(mode, gain, number) if repeat == 0 else {"kind": "none"}


def overshoot(speed: float, number: int) -> Row:
    """How far the axes went on after the touch, and the force that it took; each time at another phase."""
    random = np.random.default_rng([number, 9])
    spec = RigSpec()
    spec = replace(spec, control=replace(spec.control, guard_speed=speed))
    probe = RigProbe(BLOCK, np.eye(3), spec=spec, workspace=NEAR, seed=number % SEEDS)
    start = FACE - spec.bearing.radius - 10.0 - speed / spec.control.rate_hz * random.uniform()
    reply = probe.touch([start - 10.0, 160.0], [FACE + 60.0, 160.0])
    rows = probe.recording.rows
    first = next(k for k, row in enumerate(rows) if np.isfinite(row.normal).all())
    standing = next(k for k, row in enumerate(rows) if k > first and row.state != "guarded")
    pressed = max(row.base[0] for row in rows[first : standing + 1]) - (FACE - spec.bearing.radius)
    peak = max(float(np.hypot(*row.force)) for row in rows[first : standing + 1])
    return {
        "kind": "overshoot",
        "speed": speed,
        "pressed": float(pressed),
        "peak": peak,
        "reply": type(reply).__name__,
        "error": math.dist(reply.contact.center, [FACE - spec.bearing.radius, 160.0])
        if isinstance(reply, Hit)
        else None,
        "reason": reply.reason if isinstance(reply, Fault) else None,
    }


def step(mode: str, gain: float, number: int) -> Row:
    """What comes of a step at each tick, as a share of it."""
    spec = RigSpec()
    names = ("near_gain", "lateral_gain", "light_gain", "firm_gain", "back_gain")
    control = replace(spec.control, **{name: gain * getattr(spec.control, name) for name in names})
    machine = _machine(spec, seed=number % SEEDS)
    shares = _RESPONSES[mode](machine, control)
    return {"kind": "step", "mode": mode, "gain": gain, "shares": shares}


def _machine(spec: RigSpec, *, seed: int) -> Machine:
    """At rest, with the tip clear of the block."""
    drawn = [np.random.default_rng([seed, 10, k]) for k in range(3)]
    middle = np.array(SIZE[2]) / 2.0
    plant = Plant(BLOCK, np.eye(3), spec, middle=middle, unit_mm=1.0, random=drawn[0])
    gauges = Gauges(spec.beam, spec.electronics, dimension=2, random=drawn[1])
    machine = Machine(plant, gauges, spec, random=drawn[2])
    plant.place(np.array([FACE - spec.bearing.radius - 2.0, 160.0]))
    machine.rest(0.5, "rest")
    return machine


def _velocity(machine: Machine, control: Control) -> list[float]:
    places = [machine.plant.tip[1]]
    for _ in range(machine.ticks(SECONDS)):
        machine.tick(np.array([0.0, SPEED]), "free")
        places.append(machine.plant.tip[1])
    return [float(way) * control.rate_hz / SPEED for way in np.diff(places)]


def _position(machine: Machine, control: Control) -> list[float]:
    servo, begin = PositionServo(control, control.free_speed), machine.plant.encoders
    goal, shares = begin + np.array([0.0, FAR]), [0.0]
    for _ in range(machine.ticks(SECONDS)):
        sensed = machine.tick(servo.velocity(machine.plant.encoders, goal), "free")
        shares.append(float(sensed.base[1] - begin[1]) / FAR)
    return shares


def _guarded(machine: Machine, control: Control) -> list[float]:
    begin, shares = machine.plant.encoders, [0.0]
    line = Line(begin + np.array([-OFF, 0.0]), begin + np.array([-OFF, 100.0]))
    move = GuardedMove(control, line)
    for _ in range(machine.ticks(SECONDS)):
        sensed = machine.tick(move.velocity(machine.plant.encoders), "guarded")
        shares.append(float(begin[0] - sensed.base[0]) / OFF)
    return shares


def _force(machine: Machine, control: Control) -> list[float]:
    sensed = machine.tick(np.array([SPEED, 0.0]), "guarded")
    while sensed.magnitude <= control.guard_force:
        sensed = machine.tick(np.array([SPEED, 0.0]), "guarded")
    line = Line(sensed.base, sensed.base + np.array([10.0, 0.0]))
    press = Admittance(control, line, machine.spec.beam.stiffness)
    shares = [sensed.magnitude / control.force]
    for _ in range(machine.ticks(SECONDS)):
        sensed = machine.tick(press.velocity(sensed.base, sensed.force), "contact")
        shares.append(sensed.magnitude / control.force)
    return shares


def _along(machine: Machine, control: Control) -> list[float]:
    _force(machine, machine.spec.control)
    sensed = machine.rest(machine.tick_seconds, "contact")[-1]
    aside = sensed.base + np.array([0.0, ALONG])
    line = Line(aside, aside + np.array([10.0, 0.0]))
    press, begin, shares = Admittance(control, line, machine.spec.beam.stiffness), machine.plant.tip, [0.0]
    for _ in range(machine.ticks(SECONDS)):
        sensed = machine.tick(press.velocity(sensed.base, sensed.force), "contact")
        shares.append(float(machine.plant.tip[1] - begin[1]) / ALONG)
    return shares


_RESPONSES = dict(zip(MODES, (_velocity, _position, _guarded, _force, _along), strict=True))


def markdown(rows: list[Row]) -> str:
    """Overshoot at each speed, and how steps settle."""
    cells: list[list[str]] = []
    for speed in SPEEDS:
        some = [row for row in rows if row["kind"] == "overshoot" and row["speed"] == speed]
        if not some:
            continue
        faults = sum(row["reply"] == "Fault" for row in some)
        errors = [row["error"] for row in some if row["error"] is not None]
        cells.append(
            [
                f"{speed:g} mm/s",
                str(len(some)),
                f"{max(row['pressed'] for row in some):.2f} mm",
                f"{RigSpec().most_pressed(speed):.2f} mm",
                f"{max(row['peak'] for row in some):.1f} N",
                f"{max(errors):.3f} mm" if errors else "",
                str(faults),
            ]
        )
    reasons = sorted({row["reason"] for row in rows if row.get("reason")})
    steps = [
        [mode, WHAT[mode], f"{gain:g} ×", *_settling(row["shares"])]
        for mode, gain in STEPS
        for row in rows
        if row["kind"] == "step" and (row["mode"], row["gain"]) == (mode, gain)
    ]
    return "\n\n".join(
        [
            "Guarded moves into the face of a block, each from a little farther, so that the touch falls "
            "anywhere between two ticks. *Pressed on*: how far the axes went after the touch, and the most "
            "that they may by the guard force, two ticks and the lag of the servo; the beam bears "
            f"{RigSpec().beam.most_force:g} N. " + (f"Faults: {'; '.join(reasons)}." if reasons else ""),
            table(
                ["speed", "moves", "pressed on", "at most", "force", "error of the place", "faults"], cells
            ),
            "Steps at 60 Hz, with the gains of the rig and with more. Settled: from then on within 5 % of "
            "the step; overshoot beyond it.",
            table(["control", "step", "gains", "settled after", "overshoot"], steps),
        ]
    )


def _settling(shares: list[float]) -> list[str]:
    values, rate = np.array(shares), RigSpec().control.rate_hz
    outside = np.flatnonzero(np.abs(values - 1.0) > SETTLED)
    last = int(outside[-1]) + 1 if len(outside) else 0
    settled = f"{last / rate:.2f} s" if last < len(values) else "not"
    return [settled, f"{max(0.0, 100.0 * (float(values.max()) - 1.0)):.0f} %"]


def pictures(rows: list[Row]) -> list[Picture]:
    """Overshoot against speed, and steps of all modes."""
    import matplotlib as mpl

    from palpate.plots.style import FAINT, RC, new_figure, svg_of

    drawn: list[Picture] = []
    overshoots = [row for row in rows if row["kind"] == "overshoot"]
    with mpl.rc_context(RC):
        figure = new_figure((7.4, 3.8))
        axes = figure.add_subplot()
        fine = np.linspace(0.0, SPEEDS[-1], 50)
        axes.plot(fine, [RigSpec().most_pressed(v) for v in fine], color="#111111", lw=1.2, label="at most")
        speeds, pressed = ([row[name] for row in overshoots] for name in ("speed", "pressed"))
        axes.plot(speeds, pressed, ls="", marker="o", ms=4, mfc="none", color=COLORS[0], label="pressed on")
        yields = RigSpec().beam.deflection(RigSpec().beam.most_force)
        axes.axhline(yields, color=COLORS[1], lw=1.0, ls=(0, (4, 3)), label="the beam bears no more")
        axes.axvline(
            RigSpec().control.guard_speed, color=FAINT, lw=0.8, ls=(0, (1, 2)), label="the rig's speed"
        )
        axes.set_xlabel("speed of the guarded move (mm/s)")
        axes.set_ylabel("after the touch (mm)")
        axes.set_xlim(0.0, SPEEDS[-1] + 2.0)
        axes.set_ylim(bottom=0.0)
        axes.spines[["top", "right"]].set_visible(False)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)
        drawn.append(Picture("rig-overshoot", svg_of(figure), "How far a guarded move presses on."))
        figure = new_figure((8.6, 5.4))
        for place, mode in enumerate(MODES, start=1):
            axes = figure.add_subplot(2, 3, place)
            for k, gain in enumerate(GAINS):
                for row in rows:
                    if row["kind"] == "step" and (row["mode"], row["gain"]) == (mode, gain):
                        times = np.arange(len(row["shares"])) / RigSpec().control.rate_hz
                        axes.plot(times, row["shares"], lw=1.4 if k == 0 else 0.9, color=COLORS[k])
            axes.axhline(1.0, color=FAINT, lw=0.6)
            axes.set_title(mode)
            axes.set_xlabel("s")
            axes.set_ylim(-0.1, 2.0)
            axes.spines[["top", "right"]].set_visible(False)
        handles = [
            mpl.lines.Line2D([], [], color=COLORS[k], lw=1.6, label=f"gains {gain:g} ×")
            for k, gain in enumerate(GAINS)
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(GAINS))
        drawn.append(Picture("rig-steps", svg_of(figure), "Steps of each mode of control at 60 Hz."))
    return drawn


EXPERIMENT = Experiment(
    title="The rig: its control",
    task=task,
    table=markdown,
    groups=len(SPEEDS) + len(STEPS),
    repeats=REPEATS,
    pictures=pictures,
    of_thesis=False,
)
