"""A force-torque probe: wrenches into replies.

A robot moves a slender tip until the force passes a threshold. The place is the arm's, the normal that of
the force on the tip, turned by friction: `normal_error` has the friction angle in it. Where the surface is
surely too oblique, the touch is a skid. `Arm` stands for the robot and its driver; the probe around it is
what you would write.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

import palpate

FRICTION, SENSOR_DEG = 0.15, 2.5
NORMAL_ERROR = math.atan(FRICTION) + math.radians(SENSOR_DEG)
PLACE_ERROR, PATH_ERROR = 1.0, 0.5
STEEPEST = math.radians(50)


class Arm:
    """A simulated robot: where it stopped, and the force on the tip, or None."""

    def __init__(self, part: palpate.Model, world_from_part: np.ndarray) -> None:
        exact = palpate.Sensor(0.0, 0.0, math.radians(89.9))
        self.contact = palpate.SimulatedProbe(part, world_from_part, exact, noise="none")
        self.random = np.random.default_rng(3)

    def until_force(self, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
        """Move until 8 N or the end."""
        reply = self.contact.touch(start, end)
        if not isinstance(reply, palpate.Hit):
            return end, None
        normal = reply.contact.normal
        drag = (end - start) - (end - start) @ normal * normal  # friction pulls the tip back
        drag = drag / max(1e-9, float(np.linalg.norm(drag)))
        force = 8.0 * (normal - FRICTION * drag) + self.random.uniform(-0.1, 0.1, 3)
        return reply.contact.center + self.random.uniform(-0.4, 0.4, 3), force


class ForceTorqueProbe:
    """What the loop asks of a probe, by an arm."""

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.position: np.ndarray | None = None

    def touch(self, start: ArrayLike, end: ArrayLike) -> palpate.Reply:
        """A contact, a miss, or a skid."""
        start, end = np.array(start, dtype=float), np.array(end, dtype=float)
        self.position, force = self.arm.until_force(start, end)
        if force is None:
            return palpate.Miss(start, end, path_error=PATH_ERROR)
        travel = (end - start) / np.linalg.norm(end - start)
        normal = force / np.linalg.norm(force)
        # Steeper than is reliable, whatever the error of the normal: a path promises that it is not.
        if float(-travel @ normal) < math.cos(STEEPEST + NORMAL_ERROR):
            free = max(0.0, float(travel @ (self.position - start)) - PLACE_ERROR)
            return palpate.Skid(palpate.Miss(start, start + free * travel, path_error=PATH_ERROR))
        bounds = {"position_error": PLACE_ERROR, "normal_error": NORMAL_ERROR}
        return palpate.Hit(palpate.Contact(self.position, normal, approach=travel, start=start, **bounds))

    def move(self, points: ArrayLike) -> palpate.UnexpectedTouch | palpate.Fault | None:
        """Free moves."""
        self.position = np.array(points[-1], dtype=float)
        return None


solids = palpate.load_models(["l-bracket", "rib-plate", "hexagon", "flange"])  # or "library/"
turn = math.radians(25)
hidden = np.eye(4)
hidden[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
hidden[:3, 3] = (400, 150, 30)
sensor = palpate.Sensor(PLACE_ERROR, NORMAL_ERROR, STEEPEST, path_error=PATH_ERROR)
probe = ForceTorqueProbe(Arm(solids[1], hidden))
put_down = np.eye(4)
put_down[:3, 3] = (420, 200, 30)
on_table = palpate.Prior.on_plane(
    put_down, translation=150, rotation=math.pi, height=1.0, tilt=math.radians(1)
)
result = palpate.identify(
    solids,
    probe,
    sensor,
    [[250, 50, 32], [650, 400, 200]],  # above the table, with room for the tip
    prior=on_table,
    directions=((0, 0, -1), math.radians(95)),
)
print(result.status, [one.model.name for one in result.hypotheses], f"{result.touches} guarded moves")
assert any(one.model.name == "rib-plate" and one.poses.contains(hidden) for one in result.hypotheses)
