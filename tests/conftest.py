"""Things that several tests need."""

import numpy as np
import pytest
from numpy.typing import NDArray

import palpate


def pose(angle: float, x: float = 0.0, y: float = 0.0) -> NDArray[np.float64]:
    """Rotation by `angle` radians, then translation, as a homogeneous matrix."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


@pytest.fixture
def wedge() -> palpate.Model:
    """A quadrilateral without symmetry: faces down, right, up-left and left."""
    return palpate.Model.polygon([[0, 0], [60, 0], [60, 25], [0, 40]], name="wedge")


def hypotheses_of(name: str) -> list[palpate.Hypothesis]:
    """What explains the contacts that are bundled with a part, among the thesis's six objects."""
    six = palpate.load_models(list(palpate.part_names())[:6])
    return palpate.recognize(six, palpate.standard_contacts(name)).hypotheses


def usual_sensor(**changes: float | None) -> palpate.Sensor:
    """As DESIGN has it: ±0.5, ±4°, reliable up to 60°."""
    usual = {"position_error": 0.5, "normal_error": np.radians(4), "max_incidence": np.radians(60)}
    return palpate.Sensor(**(usual | changes))
