"""What a prior allows of symmetric solids."""

import numpy as np
from brackets import prism

import palpate
from palpate.probe.simulated import pose_within
from palpate.rotations import vector_of


def test_the_pose_of_largest_slack_is_within_the_prior():
    """A prism of 16 sides looks the same turned by 22.5°: an image of a pose may be outside of the prior."""
    angles = 2.0 * np.pi * np.arange(16) / 16
    outline = 100.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    fan = [(0, k, k + 1) for k in range(1, 15)]
    model = palpate.Model.mesh(*prism(outline, fan, 60.0), name="prism")
    prior = palpate.Prior(np.eye(4), translation=5.0, rotation=0.26)
    random = np.random.default_rng(2)
    checked = 0
    for _ in range(40):
        pose = pose_within(prior, random)
        middle = pose[:3, :3] @ model.vertices.mean(axis=0) + pose[:3, 3]
        contacts = []
        for _ in range(6):
            way = random.normal(size=3)
            way /= np.linalg.norm(way)
            met = model.first_contact(pose, middle - 500.0 * way, way, 0.0)
            if met.feature[0] == "face":
                contacts.append(palpate.Contact(met.center, position_error=1.0, approach=way))
        found = palpate.recognize([model], contacts, prior=prior, effort=20_000)
        for one in (one for one in found.hypotheses if one.proved):
            checked += 1
            assert np.linalg.norm(vector_of(one.world_from_model[:3, :3])) <= prior.rotation + 1e-5
            assert np.abs(one.world_from_model[:3, 3]).max() <= prior.translation + 1e-3
    assert checked > 30
