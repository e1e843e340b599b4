"""The thesis's hardware in a physics engine: gantry, force sensor and control (appendix A, 4.3).

`RigProbe` is a probe for `palpate.identify`; `rig_sensor` are its bounds, derived from a `RigSpec`. It needs
the extra `palpate[sim]`. Inside, lengths are mm, forces N, times s.
"""

from palpate.rig.bounds import FROM_ABOVE, SIZE, Bounds, bounds_of, rig_sensor
from palpate.rig.phases import Phases, phases_of
from palpate.rig.probe import RigProbe
from palpate.rig.recording import Recording
from palpate.rig.specification import Bearing, Control, Electronics, Gantry, Jig, RigSpec, without_errors

__all__ = [
    "FROM_ABOVE",
    "SIZE",
    "Bearing",
    "Bounds",
    "Control",
    "Electronics",
    "Gantry",
    "Jig",
    "Phases",
    "Recording",
    "RigProbe",
    "RigSpec",
    "bounds_of",
    "phases_of",
    "rig_sensor",
    "without_errors",
]
