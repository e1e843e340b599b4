"""Bounds that are taken where none are given: those of the thesis's simulations (4.2), but for Ω."""

from __future__ import annotations

import math

from palpate._core import Sensor

POSITION_ERROR = 0.5
"""In the models' unit, for parts of some 100 of them."""
NORMAL_ERROR_DEG = 4.0
MAX_INCIDENCE_DEG = 60.0


def usual_sensor() -> Sensor:
    """A point for a tip."""
    return Sensor(POSITION_ERROR, math.radians(NORMAL_ERROR_DEG), math.radians(MAX_INCIDENCE_DEG))
