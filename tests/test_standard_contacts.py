"""The contacts bundled with the parts: the thesis's numbers of interpretations come out (table 4.1)."""

from __future__ import annotations

import math

import numpy as np
import pytest

import palpate
from palpate import standard_contacts

TABLE_4_1 = {"robot-hand": 4, "human-hand": 3, "telephone": 2, "boot": 3, "camera": 4, "beer-bottle": 3}


@pytest.mark.parametrize(("part", "count"), TABLE_4_1.items())
def test_the_standard_contacts_leave_the_thesis_s_number_of_interpretations(part: str, count: int) -> None:
    (model,) = palpate.load_models([part])
    contacts = standard_contacts(part)
    assert [contact.position_error for contact in contacts] == [0.5, 0.5]
    assert [contact.normal_error for contact in contacts] == pytest.approx([math.radians(4.0)] * 2)
    found = palpate.recognize([model], contacts)
    assert (found.interpretation_count, found.interpretation_count_exact) == (count, True)
    assert len(found.hypotheses) == count
    assert not any(hypothesis.marginal for hypothesis in found.hypotheses)


@pytest.mark.parametrize("part", palpate.part_names())
def test_standard_contacts_lie_on_their_part(part: str) -> None:
    (model,) = palpate.load_models([part])
    found = palpate.recognize([model], standard_contacts(part))
    assert any(hypothesis.poses.contains(np.eye(3)) for hypothesis in found.hypotheses)
