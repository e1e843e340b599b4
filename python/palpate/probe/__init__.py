"""Probes: what the loop asks of one, and one that is simulated.

`Probe` is all that real equipment must implement; `SimulatedProbe` touches a model at a pose. Points have
the d coordinates of the models; lengths are in the models' unit, angles in radians, everything in the world
frame.
"""

from palpate.probe.errors import Noise
from palpate.probe.protocol import AlreadyTouching, Fault, Hit, Probe, Reply, Skid, UnexpectedTouch
from palpate.probe.simulated import SimulatedProbe, random_pose

__all__ = [
    "AlreadyTouching",
    "Fault",
    "Hit",
    "Noise",
    "Probe",
    "Reply",
    "SimulatedProbe",
    "Skid",
    "UnexpectedTouch",
    "random_pose",
]
