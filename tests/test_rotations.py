"""Rotations as vectors: there and back, near no turn and near half a turn too."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from palpate.rotations import rotation_of, vector_of

NEAR = [0.0, 1e-300, 1e-12, 1e-8, 1e-4, math.pi / 2, math.pi - 1e-4, math.pi - 1e-8, math.pi - 1e-12, math.pi]
angles = st.sampled_from(NEAR) | st.floats(0.0, math.pi)
axes = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda axis: math.hypot(*axis) > 1e-3)


@given(angles, axes)
def test_a_vector_comes_back(angle, axis):
    vector = angle * np.array(axis) / math.hypot(*axis)
    rotation = rotation_of(vector)
    assert np.allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=1e-14)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert np.allclose(rotation, Rotation.from_rotvec(vector).as_matrix(), rtol=0.0, atol=1e-14)
    back = vector_of(rotation)
    assert np.linalg.norm(back) <= math.pi * (1.0 + 1e-15)
    # Half a turn is the same about the axis and about its opposite.
    other = back if angle < math.pi - 1e-9 or back @ vector > 0.0 else -back
    assert np.allclose(other, vector, rtol=0.0, atol=1e-14)
    assert np.allclose(rotation_of(back), rotation, rtol=0.0, atol=1e-14)


@given(st.integers(0, 2**32 - 1))
def test_any_rotation_is_that_of_its_vector(seed):
    rotation = Rotation.random(random_state=seed)
    assert np.allclose(vector_of(rotation.as_matrix()), rotation.as_rotvec(), rtol=0.0, atol=1e-12)


def test_the_convention_is_that_of_ur_robots():
    # A quarter turn about z takes x to y.
    assert np.allclose(rotation_of((0, 0, math.pi / 2)) @ (1, 0, 0), (0, 1, 0))
    assert np.allclose(vector_of([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), (0, 0, math.pi / 2))
