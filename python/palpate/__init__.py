"""Recognize and localize a known part by touch, with guarantees.

    models = palpate.load_models(["boot", "parts/"])
    contacts = [palpate.Contact((12.0, 3.5), (0.0, -1.0), position_error=0.5, normal_error=0.07)]
    found = palpate.recognize(models, contacts)

`palpate.plots` draws models and answers; it is imported when first used.
"""

from typing import TYPE_CHECKING, Any

from ._core import AmbiguityBranch as AmbiguityBranch
from ._core import AmbiguityNode as AmbiguityNode
from ._core import AmbiguityTree as AmbiguityTree
from ._core import Contact as Contact
from ._core import FirstContact as FirstContact
from ._core import Hypothesis as Hypothesis
from ._core import Interpretation as Interpretation
from ._core import Interpretations as Interpretations
from ._core import Lines as Lines
from ._core import Miss as Miss
from ._core import Model as Model
from ._core import Outcome as Outcome
from ._core import Overlap as Overlap
from ._core import Path as Path
from ._core import PlanReport as PlanReport
from ._core import PoseSet as PoseSet
from ._core import Prior as Prior
from ._core import ProjectionSpace as ProjectionSpace
from ._core import Recognition as Recognition
from ._core import Sensor as Sensor
from ._core import Sheaf as Sheaf
from ._core import ThesisPose as ThesisPose
from ._core import Touch as Touch
from ._core import __version__ as __version__
from ._core import judge as judge
from ._core import linearization_error as linearization_error
from ._core import plan as plan
from ._core import plan_report as plan_report
from ._core import plan_tree as plan_tree
from ._core import predicted_hit_rate as predicted_hit_rate
from ._core import projection_space as projection_space
from ._core import recognize as recognize
from ._core import refuting_moves as refuting_moves
from ._core import verification_path as verification_path
from ._core import verification_report as verification_report
from .contacts import Evidence as Evidence
from .contacts import read_contacts as read_contacts
from .contacts import write_contacts as write_contacts
from .loop import Found as Found
from .loop import Result as Result
from .loop import Step as Step
from .loop import identify as identify
from .loop import perimeter_route as perimeter_route
from .loop import random_contacts as random_contacts
from .loop import replay as replay
from .models import bundled_parts as bundled_parts
from .models import bundled_solids as bundled_solids
from .models import load_models as load_models
from .models import save_model as save_model
from .parts import part_names as part_names
from .parts import solid_part_names as solid_part_names
from .parts import standard_contacts as standard_contacts
from .probe import AlreadyTouching as AlreadyTouching
from .probe import Fault as Fault
from .probe import Hit as Hit
from .probe import Probe as Probe
from .probe import Reply as Reply
from .probe import SimulatedProbe as SimulatedProbe
from .probe import Skid as Skid
from .probe import UnexpectedTouch as UnexpectedTouch

if TYPE_CHECKING:
    from . import plots as plots


def __getattr__(name: str) -> Any:
    """`plots` loads matplotlib, which takes longer than most recognitions."""
    if name == "plots":
        from importlib import import_module

        return import_module("palpate.plots")
    raise AttributeError(f"module 'palpate' has no attribute {name!r}")
