"""A probe of your own: whoever stands at a machine tool.

The loop asks for guarded moves; each is printed as the blocks that make it, and the answer is what the
control shows: where the ball stopped, or nothing if it went all the way. With `--by-hand` the example asks
you. Without it a simulated part answers, so that it runs by itself.
"""

import math
import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

import palpate

RADIUS, ERROR = 3.0, 0.031  # of the ball; what the centre may be off by, all told


class OperatorProbe:
    """Three names make a probe: position, touch and move."""

    def __init__(self, ask: Callable[[np.ndarray, np.ndarray], str]) -> None:
        self.ask = ask
        self.position: np.ndarray | None = None  # not known before the first move

    def touch(self, start: ArrayLike, end: ArrayLike) -> palpate.Reply:
        """One guarded move; the centre of the ball is what the control shows."""
        start, end = np.array(start, dtype=float), np.array(end, dtype=float)
        print(f"G0 X{start[0]:.3f} Y{start[1]:.3f}\nG38.2 X{end[0]:.3f} Y{end[1]:.3f} F60")
        answer = self.ask(start, end).replace(",", " ").split()
        if not answer:
            self.position = end
            return palpate.Miss(start, end, tip_radius=RADIUS, path_error=ERROR)
        self.position = np.array([float(value) for value in answer])
        contact = palpate.Contact.from_tip(
            self.position, RADIUS, position_error=ERROR, approach=end - start, start=start
        )
        return palpate.Hit(contact)

    def move(self, points: ArrayLike) -> palpate.UnexpectedTouch | palpate.Fault | None:
        """Free moves on the border of the workspace."""
        for x, y in np.asarray(points):
            print(f"G0 X{x:.3f} Y{y:.3f}")
        self.position = np.array(points[-1], dtype=float)
        return None


part = palpate.Model.polygon([(0, 0), (80, 0), (80, 20), (20, 20), (20, 60), (0, 60)], name="my-part")
sensor = palpate.Sensor(ERROR, None, math.radians(60), tip_radius=RADIUS, path_error=ERROR)
turn = math.radians(7)
hidden = np.array(
    [[math.cos(turn), -math.sin(turn), 212.4], [math.sin(turn), math.cos(turn), 118.7], [0, 0, 1]]
)
# A trigger stops at any incidence.
trigger = palpate.Sensor(ERROR, None, math.radians(89.9), tip_radius=RADIUS, path_error=ERROR)
simulated = palpate.SimulatedProbe(part, hidden, trigger, seed=4)


def simulated_answer(start: np.ndarray, end: np.ndarray) -> str:
    """What the control would show."""
    reply = simulated.touch(start, end)
    return "{:.4f} {:.4f}".format(*reply.contact.center) if isinstance(reply, palpate.Hit) else ""


by_hand = "--by-hand" in sys.argv
probe = OperatorProbe(
    lambda start, end: input("stopped at X Y, or nothing: ") if by_hand else simulated_answer(start, end)
)
assert isinstance(probe, palpate.Probe)
near = palpate.Prior([[1, 0, 205], [0, 1, 115], [0, 0, 1]], translation=15, rotation=math.radians(15))
workspace = [[150, 60], [340, 240]]
result = palpate.identify([part], probe, sensor, workspace, prior=near, until=(0.5, math.radians(0.3)))
print(f"{result.status}: {result.reason}")
for found in result.hypotheses:
    world_from_part = found.world_from_model
    (x, y), angle = world_from_part[:2, 2], math.atan2(world_from_part[1, 0], world_from_part[0, 0])
    print(f"G10 L2 P1 X{x:.3f} Y{y:.3f} R{math.degrees(angle):.3f}")
assert by_hand or result.hypotheses[0].poses.contains(hidden)
