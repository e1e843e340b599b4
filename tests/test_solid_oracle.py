"""The oracle of space: by hand on a cube, and against brute force and trimesh."""

import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from palpate.experiments import solid_oracle
from palpate.experiments.random_solids import prism, random_solid
from palpate.experiments.solid_oracle import Slack, gaps, valid
from palpate.experiments.solid_problems import Bounds, draw_contacts
from palpate.experiments.solid_sweeps import (
    NUM_POINTS,
    between_segments,
    keep_off,
    least_distances,
    segments_to_triangles,
    to_triangles,
)
from palpate.experiments.solids import Solid, winding

IDENTITY = np.eye(4)[None]
# Of a normal of length 2 that is turned by 0.2 over an edge.
UP, SIDE = 2.0 * math.cos(0.2), 2.0 * math.sin(0.2)


@dataclass(frozen=True)
class Touch:
    center: tuple
    normal: tuple | None = None
    normal_error: float | None = None
    position_error: float = 0.1
    tip_radius: float = 0.0
    approach: tuple | None = None
    start: tuple | None = None


@dataclass(frozen=True)
class Miss:
    start: tuple
    end: tuple
    tip_radius: float = 0.0
    path_error: float = 0.0


@dataclass(frozen=True)
class Prior:
    world_from_model: np.ndarray
    translation: float
    rotation: float


def cube() -> Solid:
    """From 0 to 10 along each axis."""
    return prism("cube", np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]), 10.0)


def bracket() -> Solid:
    """An L along z: its inner edge is reflex, at x = y = 4."""
    outline = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [4.0, 4.0], [4.0, 10.0], [0.0, 10.0]])
    return prism("bracket", outline, 10.0)


def gap(solid, touch, kinds=solid_oracle.ALL_KINDS):
    return float(gaps(solid, IDENTITY, touch, kinds=kinds)[0])


def test_a_cube_has_six_faces_twelve_edges_and_eight_vertices():
    solid = cube()
    assert (solid.num_faces, len(solid.edges.starts), len(solid.cones)) == (6, 12, 8)
    assert solid.watertight
    assert solid.volume == pytest.approx(1000.0)
    assert all(len(cone.rays) == 3 for cone in solid.cones)


def test_nothing_reflex_can_be_touched():
    solid = bracket()
    assert (solid.num_faces, len(solid.edges.starts), len(solid.cones)) == (8, 17, 10)


def test_the_bottom_of_a_pit_is_no_vertex():
    solid = cube()
    flat = (solid.vertices[solid.triangles][:, :, 2] == 10.0).all(axis=1)
    rim = [4, 5, 6, 7]
    pit = [[rim[k], rim[(k + 1) % 4], 8] for k in range(4)]
    dug = Solid(
        "pit", np.vstack([solid.vertices, [5.0, 5.0, 6.0]]), np.concatenate([solid.triangles[~flat], pit])
    )
    assert dug.watertight
    assert (dug.num_faces, len(dug.edges.starts), len(dug.cones)) == (9, 12, 8)
    assert not any((cone.point == [5.0, 5.0, 6.0]).all() for cone in dug.cones)


@pytest.mark.parametrize(
    ("touch", "expected"),
    [
        (Touch((5.0, 5.0, 10.3)), 0.3),
        (Touch((5.0, 5.0, 9.8), (0.0, 0.0, 1.0), 0.1), 0.2),
        (Touch((5.0, 5.0, 10.0), (1.0, 0.0, 0.0), 0.1), 5.0),
        (Touch((5.0, 5.0, 12.5), tip_radius=2.0), 0.5),
        # Over the edge x = z = 10: the tip's centre on the cylinder, then with normals that the edge has or
        # has not.
        (Touch((10.0 + math.sqrt(2.0), 5.0, 10.0 + math.sqrt(2.0)), tip_radius=2.0), 0.0),
        (Touch((10.0 + math.sqrt(8.0), 5.0, 10.0 + math.sqrt(8.0)), tip_radius=2.0), 2.0),
        (Touch((12.0, 5.0, 10.0), (0.0, 0.0, 1.0), 0.2, tip_radius=2.0), math.hypot(2.0 - SIDE, UP)),
        (Touch((10.0, 5.0, 12.0), (-1.0, 0.0, 0.0), 0.2, tip_radius=2.0), math.hypot(10.0 + UP, 2.0 - SIDE)),
        # Over the vertex (10, 10, 10), along its diagonal, and short of the end of an edge.
        (Touch((10.0 + math.sqrt(4.0 / 3.0),) * 3, tip_radius=2.0), 0.0),
        (Touch((13.0, 13.0, 13.0), tip_radius=2.0), math.sqrt(27.0) - 2.0),
        # No normal of the cube is within 0.1 of this one but on the vertex: at the point of the sphere there.
        (Touch((10.0,) * 3, (math.sqrt(1.0 / 3.0),) * 3, 0.1, tip_radius=2.0), 2.0),
        (Touch((5.0, 5.0, 10.0), approach=(0.0, 0.0, 1.0)), 5.0),
        (Touch((5.0, 5.0, 10.0), approach=(0.0, 0.0, -1.0)), 0.0),
    ],
)
def test_gaps_of_a_cube(touch, expected):
    assert gap(cube(), touch) == pytest.approx(expected, abs=1e-9)


def test_a_tip_over_an_edge_is_bounded_by_the_reading():
    """At (10, ·, 10) with normals at most 0.1 from 45°: the nearest to the x axis is 35° or so up."""
    half = 0.25 * math.pi
    touch = Touch((12.0, 5.0, 10.0), (math.sqrt(0.5), 0.0, math.sqrt(0.5)), 0.1, tip_radius=2.0)
    at = 10.0 + 2.0 * math.cos(half - 0.1), 10.0 + 2.0 * math.sin(half - 0.1)
    assert gap(cube(), touch) == pytest.approx(math.hypot(at[0] - 12.0, at[1] - 10.0), abs=1e-9)


def test_kinds_are_as_told():
    touch = Touch((10.0 + math.sqrt(2.0), 5.0, 10.0 + math.sqrt(2.0)), tip_radius=2.0)
    assert gap(cube(), touch, ("face",)) > 0.5
    assert gap(cube(), touch, ("vertex",)) > 4.0
    assert gap(cube(), touch, ("edge",)) == pytest.approx(0.0, abs=1e-9)


def test_validity_is_up_to_the_bounds():
    touch = Touch((5.0, 5.0, 10.1), (0.0, 0.0, 1.0), 0.1)
    turned = IDENTITY.copy()
    turned[0, :3, :3] = [[1, 0, 0], [0, math.cos(0.2), -math.sin(0.2)], [0, math.sin(0.2), math.cos(0.2)]]
    assert valid(cube(), IDENTITY, [touch], Slack(1e-9, 1e-9))[0]
    assert not valid(cube(), IDENTITY, [touch], Slack(-1e-3, 0.0))[0]
    assert not valid(cube(), turned, [touch], Slack(5.0, 0.0))[0]
    assert valid(cube(), turned, [touch], Slack(5.0, 0.11))[0]


@pytest.mark.parametrize("moved", [1e-4, 1e-2])
def test_corners_that_are_off_turn_normals_by_no_more_than_is_granted(moved):
    """With corners moved, gaps are within those that such moves explain; narrow triangles turn far."""
    random = np.random.default_rng(5)
    told = []
    for _ in range(60):
        outline = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 0.05], [4.0, 7.0], [0.0, 8.0]])
        solid = prism("wedge", outline, float(random.uniform(0.02, 10.0)))
        off = random.normal(size=solid.vertices.shape)
        off *= moved / np.linalg.norm(off, axis=1, keepdims=True)
        other = Solid("moved", solid.vertices + off, solid.triangles)
        for radius in (0.0, 2.0):
            place = solid.places(random, 1)
            normal = place.normals[0] + random.normal(scale=0.05, size=3)
            touch = Touch(
                tuple(place.points[0] + radius * place.normals[0]),
                tuple(normal / np.linalg.norm(normal)),
                float(random.uniform(0.02, 0.1)),
                tip_radius=radius,
            )
            least, most, true = (
                float(gaps(one, IDENTITY, touch, Slack(corners=corners), kinds=("face",))[0])
                for one, corners in ((solid, moved), (solid, -moved), (other, 0.0))
            )
            assert least - moved <= true <= most + moved
            told.append(math.isfinite(true) and not math.isfinite(most))
    assert any(told) or moved < 1e-3


def test_a_prior_is_a_box_and_a_cone():
    prior = Prior(np.eye(4), 1.0, 0.1)
    moved, far = IDENTITY.copy(), IDENTITY.copy()
    moved[0, :3, 3] = 1.0
    far[0, 0, 3] = 1.1
    assert valid(cube(), moved, [], prior=prior)[0]
    assert not valid(cube(), far, [], prior=prior)[0]
    turn = math.cos(0.11), math.sin(0.11)
    moved[0, :2, :2] = [[turn[0], -turn[1]], [turn[1], turn[0]]]
    assert not valid(cube(), moved, [], prior=prior)[0]


@pytest.mark.parametrize(
    ("start", "end", "low", "high"),
    [
        ((0.0, 5.0, 12.0), (10.0, 5.0, 12.0), 2.0, 2.0),
        ((13.0, -5.0, 14.0), (13.0, 15.0, 14.0), 5.0, 5.0),
        ((5.0, 5.0, 20.0), (5.0, 5.0, 10.5), 0.5, 0.5),
        ((5.0, 5.0, 20.0), (5.0, 5.0, 7.0), -3.1, -3.0),
        ((5.0, 5.0, -5.0), (5.0, 5.0, 15.0), -5.1, -5.0),
        ((4.0, 5.0, 5.0), (6.0, 5.0, 5.0), -5.1, -5.0),
    ],
)
def test_sweeps_of_a_cube(start, end, low, high):
    bounds = least_distances(cube(), np.array(start), np.array(end))
    assert low - 1e-9 <= bounds[0] <= bounds[1]
    assert bounds[1] == pytest.approx(high, abs=1e-9)


def test_sweeps_keep_off_by_as_much_as_they_are_away():
    """Triangles that are left out, and points whose side is known from a neighbour's, change no answer."""
    random = np.random.default_rng(17)
    passed = set()
    for _ in range(16):
        solid = random_solid(random)
        starts, ends = 70.0 * random.normal(size=(2, 6, 3))
        bounds = np.array([brute_force(solid, *two) for two in zip(starts, ends, strict=True)])
        for least in (5.0, 0.0, -0.01, -2.0, -30.0):
            for cautious in (True, False):
                held = keep_off(solid, starts, ends, least=least, cautious=cautious)
                assert (held == (bounds[:, 0 if cautious else 1] >= least)).all()
                passed |= {(least, bool(one)) for one in held}
        for start, end, bound in zip(starts, ends, bounds, strict=True):
            assert least_distances(solid, start, end) == pytest.approx(bound, abs=1e-9)
    assert len(passed) == 10


def brute_force(solid, start, end):
    """The bounds of `least_distances`, of all points and all triangles."""
    points = np.linspace(start, end, NUM_POINTS)
    corners = np.repeat(solid.corners[None], NUM_POINTS, axis=0).reshape(-1, 3, 3)
    distances = to_triangles(np.repeat(points, len(solid.corners), axis=0), corners)
    inside = winding(solid, points) > 0.5
    depth = np.where(inside, distances.reshape(NUM_POINTS, -1).min(axis=1), 0.0).max()
    ends = np.broadcast_to(start, (len(solid.corners), 3)), np.broadcast_to(end, (len(solid.corners), 3))
    apart = segments_to_triangles(*ends, solid.corners).min()
    if apart > 0.0 and not inside[0]:
        return apart, apart
    return -depth - 0.5 * np.linalg.norm(end - start) / (NUM_POINTS - 1), -depth


def test_what_is_left_out_for_its_distance_is_farther():
    """With a bound of what matters, gaps within it are the same, and no other is."""
    random = np.random.default_rng(19)
    within = 0
    for _ in range(8):
        solid = random_solid(random)
        bounds = Bounds(2.0, 0.1, tip_radius=4.0)
        for touch in draw_contacts(random, solid, np.eye(4), bounds=bounds, count=6):
            poses = np.broadcast_to(np.eye(4), (12, 4, 4)).copy()
            poses[:, :3, 3] = 3.0 * random.normal(size=(12, 3))
            whole = gaps(solid, poses, touch, kinds=solid_oracle.ALL_KINDS)
            for most in (0.1, 1.0, 5.0):
                some = gaps(solid, poses, touch, kinds=solid_oracle.ALL_KINDS, most=most)
                near = whole <= most
                assert (some[near] == whole[near]).all() and (some[~near] > most).all()
                within += int(near.sum())
    assert within > 200


def test_misses_exclude_poses():
    miss = Miss((0.0, 5.0, 12.0), (10.0, 5.0, 12.0), tip_radius=2.5, path_error=0.4)
    assert not valid(cube(), IDENTITY, [], misses=[miss])[0]
    lower = IDENTITY.copy()
    lower[0, 2, 3] = -0.2
    assert valid(cube(), lower, [], misses=[miss])[0]


def test_the_free_part_of_a_move_excludes_poses():
    touch = Touch((5.0, 5.0, 0.0), start=(5.0, 5.0, 20.0))
    assert not valid(cube(), IDENTITY, [touch])[0]
    assert valid(cube(), IDENTITY, [Touch((5.0, 5.0, 10.0), start=(5.0, 5.0, 20.0))])[0]


def test_segments_are_as_near_as_their_nearest_points():
    random = np.random.default_rng(3)
    share = np.linspace(0.0, 1.0, 101)
    for _ in range(50):
        a, b, c, d = random.normal(size=(4, 3))
        mine = a + share[:, None] * (b - a)
        other = c + share[:, None] * (d - c)
        brute = np.linalg.norm(mine[:, None] - other, axis=2).min()
        exact = between_segments(a[None], b[None], c[None], d[None])[0]
        assert exact <= brute + 1e-12
        assert brute <= exact + 0.01 * (np.linalg.norm(b - a) + np.linalg.norm(d - c))


def random_hull(random):
    trimesh = pytest.importorskip("trimesh")
    hull = trimesh.convex.convex_hull(random.normal(size=(14, 3)) * 20.0)
    return Solid("hull", np.array(hull.vertices), np.array(hull.faces, dtype=np.int64)), hull


def test_distances_agree_with_trimesh():
    trimesh = pytest.importorskip("trimesh")
    random = np.random.default_rng(5)
    for _ in range(5):
        solid, hull = random_hull(random)
        points = random.normal(size=(40, 3)) * 30.0
        _, theirs, _ = trimesh.proximity.closest_point_naive(hull, points)
        for point, distance in zip(points, theirs, strict=True):
            many = np.broadcast_to(point, (len(solid.corners), 3))
            assert to_triangles(many, solid.corners).min() == pytest.approx(distance, abs=1e-9)
        inside = winding(solid, points)
        planes = np.einsum("tni,ti->tn", points - solid.corners[:, :1], solid.normals)
        assert inside == pytest.approx((planes < 0.0).all(axis=0).astype(float), abs=1e-9)


def test_a_ball_on_a_convex_part_is_a_radius_away():
    """All features together are the surface at the tip's radius: outside, the gap is `|distance − r|`."""
    trimesh = pytest.importorskip("trimesh")
    random = np.random.default_rng(7)
    for _ in range(4):
        solid, hull = random_hull(random)
        points = random.normal(size=(60, 3)) * 40.0
        points = points[winding(solid, points) < 0.5]
        _, distances, _ = trimesh.proximity.closest_point_naive(hull, points)
        for point, distance in zip(points, distances, strict=True):
            radius = float(random.uniform(0.5, 6.0))
            touch = Touch(tuple(point), tip_radius=radius)
            assert gap(solid, touch) == pytest.approx(abs(distance - radius), abs=1e-7)


def test_gaps_with_bounded_normals_agree_with_dense_sampling():
    """Of thousands of normals of a vertex's cone none is nearer than the gap says."""
    random = np.random.default_rng(11)
    solid, _ = random_hull(random)
    normals = random.normal(size=(200_000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tried = 0
    for cone in solid.cones:
        own = normals[(normals @ cone.leaving.T <= 0.0).all(axis=1)]
        axis = own[random.integers(len(own))] + 0.2 * random.normal(size=3)
        axis /= np.linalg.norm(axis)
        away = -(own[random.integers(len(own))] + 0.3 * random.normal(size=3))
        agree = (own @ axis >= math.cos(0.25)) & (-(own @ away) >= 0.0)
        radius = 5.0
        center = cone.point + radius * own[random.integers(len(own))] + random.normal(size=3)
        touch = Touch(
            tuple(center), tuple(axis), 0.25, tip_radius=radius, approach=tuple(away / np.linalg.norm(away))
        )
        exact = solid_oracle._vertex_gaps(
            cone,
            center[None],
            [(axis[None], 0.25), (-np.array(touch.approach)[None], 0.5 * math.pi)],
            radius=radius,
        )[0]
        if agree.any():
            tried += 1
            brute = np.linalg.norm(center - cone.point - radius * own[agree], axis=1).min()
            assert exact <= brute + 1e-9
            assert brute <= exact + 0.15 * radius
            if agree.sum() > 50:
                assert gap(solid, touch, ("vertex",)) <= exact + 1e-12
    assert tried >= 5


def test_edges_with_bounded_normals_agree_with_dense_sampling():
    random = np.random.default_rng(13)
    solid, _ = random_hull(random)
    edges = solid.edges
    places, normals = [], []
    for start, end, first, second in zip(
        edges.starts, edges.ends, edges.first_normals, edges.second_normals, strict=True
    ):
        along, around = random.random((2, 4000, 1))
        width = math.acos(np.clip(first @ second, -1.0, 1.0))
        arc = np.sin((1.0 - around) * width) * first + np.sin(around * width) * second
        places.append(start + along * (end - start))
        normals.append(arc / math.sin(width))
    places, normals = np.concatenate(places), np.concatenate(normals)
    for _ in range(20):
        pick = random.integers(len(places))
        axis = normals[pick] + 0.1 * random.normal(size=3)
        axis /= np.linalg.norm(axis)
        center = places[pick] + 3.0 * normals[pick] + random.normal(size=3)
        agree = normals @ axis >= math.cos(0.2)
        touch = Touch(tuple(center), tuple(axis), 0.2, tip_radius=3.0)
        exact = gap(solid, touch, ("edge",))
        brute = np.linalg.norm(center - places[agree] - 3.0 * normals[agree], axis=1).min()
        assert exact <= brute + 1e-9
        assert brute <= exact + 0.5


def test_a_normal_that_is_off_moves_the_centre_of_a_ball_by_its_chord():
    contacts = [SimpleNamespace(tip_radius=radius) for radius in (0.0, 5.0)]
    normal, turn = np.array([0.0, 0.0, 1.0]), 0.02
    turned = np.array([math.sin(turn), 0.0, math.cos(turn)])
    moved = 5.0 * float(np.linalg.norm(turned - normal))
    assert solid_oracle.missed_by_centers((0.25, turn), contacts) == pytest.approx(0.25 + moved)
    assert solid_oracle.missed_by_centers((0.25, turn), contacts[:1]) == 0.25
    assert solid_oracle.missed_by_centers((0.25, turn), []) == 0.25
