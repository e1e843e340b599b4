"""The physical rig: gantry, beam, bearing and part, in MuJoCo.

Inside everything is in metres, newtons and seconds; outside lengths are mm. The plant knows no sensor and
no computer: it takes velocities of the axes, and tells what the encoders count and how the beam is bent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate._core import Model
from palpate.rig.extra import library
from palpate.rig.gauges import turned
from palpate.rig.pieces import planar_pieces, solid_pieces
from palpate.rig.specification import BURSTS, RigSpec

Array: TypeAlias = NDArray[np.float64]

STEP_HZ = 1920.0
"""Steps of the physics per second, at least."""
PART_HALF_HEIGHT = 20.0  # mm, of prisms over planar parts, above and below the tip's centre
ARMATURE = 1e-7  # kg m², of the bearing's race
M = 1e-3  # metres in a millimetre

# As stiff and as little soft as the engine has it: the tip sinks in by less than a micrometre.
HARD = {"solimp": [0.9999, 0.9999, 0.001, 0.5, 2.0]}


@dataclass(frozen=True)
class Touching:
    """A place where the part touches the tip or the stem: the physics' own truth."""

    normal: Array
    """Out of the part, shape `(d,)`."""
    force: float
    """Along the normal, N."""
    on_stem: bool


class Plant:
    """A part that lies fixed in the workspace of a gantry with a sensor."""

    def __init__(
        self,
        model: Model,
        world_from_model: Array,
        spec: RigSpec,
        *,
        middle: Array,
        unit_mm: float,
        random: np.random.Generator,
    ) -> None:
        """A plant whose tolerances are drawn from `random`; `middle` of its axes in mm, shape `(d,)`."""
        self.dimension = d = model.dimension
        self._mujoco = library("mujoco")
        self._middle = middle
        gantry = spec.gantry
        self._scale = 1.0 + gantry.scale_tolerance * random.uniform(-1.0, 1.0, d)
        self._axes = _axes(d, gantry.square_tolerance, random)
        spread = 1.0 + spec.jig.stiffness_tolerance * random.uniform(-1.0, 1.0, d)
        self._stiffness = spec.beam.stiffness / M * spread
        self.steps = BURSTS * math.ceil(STEP_HZ / spec.control.rate_hz / BURSTS)
        self._resolution = gantry.resolution
        corners = _placed(model, world_from_model, unit_mm)
        self._model = self._compiled(corners, spec)
        self._state = self._mujoco.MjData(self._model)
        self._ball = self._model.geom("ball").id
        self._stem = self._model.geom("stem").id
        self._tip = self._model.body("tip").id
        self._stem_touched = False

    def _compiled(self, pieces: list[Array], spec: RigSpec) -> Any:
        mujoco, d, gantry = self._mujoco, self.dimension, spec.gantry
        made = mujoco.MjSpec()
        option = made.option
        option.timestep = 1.0 / (spec.control.rate_hz * self.steps)
        option.gravity = [0.0, 0.0, 0.0]  # weights are constant: they go with the zero
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.tolerance = 1e-14  # with the usual one a steady contact opens now and then for a step
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        hard = {**HARD, "solref": [2.0 * option.timestep, 1.0]}
        friction = [spec.bearing.surface_friction, 0.0, 0.0]
        for number, corners in enumerate(pieces):
            mesh = made.add_mesh(name=f"piece-{number}")
            mesh.uservert = (M * corners).ravel()
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            made.worldbody.add_geom(
                name=f"piece-{number}",
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=f"piece-{number}",
                contype=1,
                conaffinity=2,
                friction=friction,
                **hard,
            )
        body = made.worldbody
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        omega = 2.0 * math.pi * gantry.servo_hz
        for k in range(d):
            # Each axis moves all of the mass; those after the first need none of their own.
            body = body.add_body(
                name=f"axis-{k}", mass=gantry.mass if k == d - 1 else 1e-6, inertia=[1e-6] * 3
            )
            body.explicitinertial = True
            body.pos = M * np.array([*self._middle, 0.0][:3]) if k == 0 else np.zeros(3)
            body.add_joint(
                name=f"axis-{k}",
                type=slide,
                axis=self._axes[k],
                frictionloss=gantry.friction,
                solref_friction=hard["solref"],
                solimp_friction=HARD["solimp"],
            )
            servo = made.add_actuator(name=f"axis-{k}", target=f"axis-{k}")
            servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
            stiffness, damping = gantry.mass * omega**2, 2.0 * gantry.mass * omega
            servo.set_to_intvelocity(
                kp=stiffness, kv=damping, dampratio=-1.0, timeconst=-1.0, inheritrange=0.0
            )
            servo.forcelimited = True
            servo.forcerange = [-gantry.most_drive, gantry.most_drive]
            servo.actlimited = False
        tip_mass = spec.beam.tip_mass
        tip = body.add_body(name="tip", mass=tip_mass, inertia=[1e-8] * 3)
        tip.explicitinertial = True
        for k in range(d):
            damping = 2.0 * spec.beam.damping * math.sqrt(self._stiffness[k] * spec.moving_mass)
            tip.add_joint(
                name=f"bend-{k}",
                type=slide,
                axis=np.eye(3)[k],
                stiffness=float(self._stiffness[k]),
                damping=damping,
            )
        tip.add_geom(
            name="stem",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[0.0, 0.0, 0.0, 0.0, 0.0, M * spec.beam.length],
            size=[M * spec.stem_radius, 0.0, 0.0],
            mass=0.0,
            contype=2,
            conaffinity=1,
            friction=friction,
            **hard,
        )
        race = tip.add_body(name="race")
        race.add_joint(
            name="race",
            type=mujoco.mjtJoint.mjJNT_HINGE if d == 2 else mujoco.mjtJoint.mjJNT_BALL,
            axis=[0.0, 0.0, 1.0],
            frictionloss=M * spec.bearing.friction_torque,
            armature=ARMATURE,
            solref_friction=hard["solref"],
            solimp_friction=HARD["solimp"],
        )
        race.add_geom(
            name="ball",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[M * spec.bearing.radius, 0.0, 0.0],
            mass=spec.bearing.mass,
            contype=2,
            conaffinity=1,
            friction=friction,
            **hard,
        )
        return made.compile()

    @property
    def encoders(self) -> Array:
        """Where the axes are by their encoders, as a place of the tip that is not bent, shape `(d,)`, mm."""
        joints = self._state.qpos[: self.dimension] / M / self._scale
        return np.asarray(self._middle + self._resolution * np.rint(joints / self._resolution))

    @property
    def tip(self) -> Array:
        """Where the centre of the tip truly is, shape `(d,)`, mm."""
        return np.asarray(self._state.xpos[self._tip][: self.dimension] / M)

    @property
    def touching(self) -> list[Touching]:
        """All places where the part touches."""
        found: list[Touching] = []
        force = np.zeros(6)
        for k in range(self._state.ncon):
            contact = self._state.contact[k]
            self._mujoco.mj_contactForce(self._model, self._state, k, force)
            mine = {self._ball, self._stem} & {contact.geom1, contact.geom2}
            sign = 1.0 if contact.geom2 in mine else -1.0
            normal = sign * contact.frame[: self.dimension]
            found.append(Touching(np.array(normal), float(force[0]), self._stem in mine))
        return found

    @property
    def normal(self) -> Array:
        """Of the place on the tip that bears most, shape `(d,)`; NaN if nothing touches it."""
        places = [place for place in self.touching if not place.on_stem] if self._state.ncon else []
        if not places:
            return np.full(self.dimension, np.nan)
        return max(places, key=lambda place: place.force).normal

    @property
    def stem_touches(self) -> bool:
        """Whether the stem's own contact was closed in the last tick: it is wired as a switch."""
        return self._stem_touched

    def _stem_is_touching(self) -> bool:
        contacts = self._state.contact
        return bool(self._state.ncon) and bool(
            (contacts.geom1 == self._stem).any() or (contacts.geom2 == self._stem).any()
        )

    def place(self, encoders: Array) -> None:
        """Put the gantry, at rest and not bent, where its encoders say so."""
        self._mujoco.mj_resetData(self._model, self._state)
        joints = (encoders - self._middle) * self._scale * M
        self._state.qpos[: self.dimension] = joints
        self._state.act[:] = joints
        self._mujoco.mj_forward(self._model, self._state)

    def tick(self, velocity: Array) -> Array:
        """Let the servos follow a velocity, mm/s, for a tick; forces on the tip at each burst, N."""
        d, state = self.dimension, self._state
        state.ctrl[:] = M * velocity
        forces = np.empty((BURSTS, d))
        bend = slice(d, 2 * d)
        self._stem_touched = False
        for k in range(BURSTS):
            self._mujoco.mj_step(self._model, state, nstep=self.steps // BURSTS)
            forces[k] = self._stiffness * state.qpos[bend]
            self._stem_touched |= self._stem_is_touching()
        return forces


def _axes(dimension: int, tolerance: float, random: np.random.Generator) -> Array:
    """Directions of the axes, shape `(d, 3)`: each turned by up to the tolerance."""
    axes = np.eye(3)[:dimension]
    for row in axes:
        row[:dimension] = turned(row[:dimension].copy(), tolerance * random.uniform(), random)
    return axes


def _placed(model: Model, world_from_model: Array, unit_mm: float) -> list[Array]:
    """Corners of the convex pieces where the part lies, mm."""
    if model.dimension == 3:
        pieces = solid_pieces(model)
        pose = world_from_model
    else:
        half = PART_HALF_HEIGHT / unit_mm
        pieces = planar_pieces(model, low=-half, high=half)
        pose = np.eye(4)
        pose[:2, :2], pose[:2, 3] = world_from_model[:2, :2], world_from_model[:2, 2]
    return [unit_mm * (piece @ pose[:3, :3].T + pose[:3, 3]) for piece in pieces]
