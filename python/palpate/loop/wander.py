"""How far the tip may leave its line where nobody says so (`docs/theory.md`, T15).

A path error of zero is what `Sensor` and `Miss` have if none is given, and no tip keeps to its line exactly.
Taken at its word it would refute the truth. So the loop takes zero as not stated, and the position error
stands for it: a tip that is known to within that may have left its line by as much. So do files of contacts.
"""

from __future__ import annotations

from palpate._core import Miss, Sensor


def path_error_of(sensor: Sensor, position_error: float = 0.0) -> float:
    """That of the sensor, if it states one, else its position error, or that of a contact if it is larger."""
    return sensor.path_error or max(sensor.position_error, position_error)


def wandering(sensor: Sensor) -> Sensor:
    """The sensor with the path error that its guarded moves are judged, and planned, with."""
    return Sensor(
        sensor.position_error,
        sensor.normal_error,
        sensor.max_incidence,
        sensor.tip_radius,
        path_error_of(sensor),
        stem=sensor.stem,
    )


def as_swept(miss: Miss, sensor: Sensor) -> Miss:
    """The miss as evidence: one that states no path error has that of the sensor's guarded moves."""
    path_error = miss.path_error or path_error_of(sensor)
    return Miss(miss.start, miss.end, tip_radius=miss.tip_radius, path_error=path_error)
