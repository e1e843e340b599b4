"""The simulated probe in space against numpy: where it touches, how large its errors are, what it answers."""

import math

import numpy as np
import pytest
from brackets import POSE, bracket, cube, prism, turned
from conftest import usual_sensor
from marching import PlacedSolid, lines

import palpate
from palpate.cli import main
from palpate.probe import random_pose
from palpate.probe.simulated import pose_within
from palpate.rotations import vector_of

PARTS = palpate.load_models(list(palpate.solid_part_names()))
RADII = (0.0, 4.0)


def box(width, depth, height):
    outline = [[0, 0], [width, 0], [width, depth], [0, depth]]
    return palpate.Model.mesh(*prism(outline, [(0, 1, 2), (0, 2, 3)], height), name="box")


def wall():
    """Whose face x = 0 is met along x at y, z within 500 of zero."""
    model = box(100, 1000, 1000)
    return model, turned(0, 0, 0, (0, -500, -500))


@pytest.mark.parametrize("radius", RADII)
def test_first_contact_is_where_a_march_ends(radius):
    met_by_march = checked = 0
    kinds = set()
    for k, model in enumerate([*PARTS, bracket()]):
        pose = turned(k, 0.3 * k, 1.0, (10.0 * k, -5.0, 3.0))
        placed = PlacedSolid(model, pose)
        starts, directions = lines(placed, model, count=120, seed=k)
        last = np.full(len(starts), 3.0 * model.size)
        # Not before a ball that is a little larger stops, not after one that is a little smaller does.
        first = placed.marched(starts, directions, radius=radius + 1e-6, last=last)
        for start, direction, depth in zip(starts, directions, first, strict=True):
            met = model.first_contact(pose, start, 3.0 * direction, radius)
            if math.isnan(depth) or (met is None) != (depth >= 3.0 * model.size):
                continue  # it grazes, which is counted below
            checked += 1
            if met is None:
                continue
            met_by_march += 1
            kinds.add(met.feature[0])
            incidence = -direction @ met.normal
            assert incidence > -1e-9 and np.linalg.norm(met.normal) == pytest.approx(1.0, abs=1e-12)
            assert -1e-9 <= met.depth - depth <= 1e-5 / max(incidence, 1e-4)
            np.testing.assert_allclose(met.center, start + met.depth * direction, atol=1e-9)
            assert placed.distances(met.center[None])[0] == pytest.approx(radius, abs=1e-9)
            assert placed.distances((met.center - radius * met.normal)[None])[0] == pytest.approx(0, abs=1e-9)
    assert checked >= 598 and met_by_march > 350
    assert kinds == ({"face", "edge", "vertex"} if radius else {"face"})


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_errors_are_within_their_bounds(radius, noise):
    """A probe that reads without errors, but leaves its lines alike, tells what is true; numpy checks it."""
    bounds = {"max_incidence": math.radians(60), "tip_radius": radius, "path_error": 0.3}
    kinds = {"Hit": 0, "Skid": 0, "Miss": 0}
    for k, model in enumerate(PARTS):
        pose = turned(0.7, k, -k, (20, 30, k))
        placed = PlacedSolid(model, pose)
        probe = palpate.SimulatedProbe(
            model, pose, palpate.Sensor(0.5, math.radians(4), **bounds), seed=5, noise=noise
        )
        still = palpate.SimulatedProbe(model, pose, palpate.Sensor(0.0, 0.0, **bounds), seed=5, noise=noise)
        starts, directions = lines(placed, model, count=250, seed=3 + k)
        touched = []
        for start, direction in zip(starts, directions, strict=True):
            end = start + 2.5 * model.size * direction
            reply, true = probe.touch(start, end), still.touch(start, end)
            kinds[type(reply).__name__] += 1
            assert type(reply) is type(true)
            if isinstance(reply, palpate.Miss):
                assert np.array_equal(probe.position, end)
                assert np.array_equal(reply.start, start) and np.array_equal(reply.end, end)
                assert (reply.tip_radius, reply.path_error) == (radius, 0.3)
            if not isinstance(reply, palpate.Hit):
                continue
            contact = reply.contact
            assert (contact.tip_radius, contact.position_error) == (radius, 0.5)
            assert np.array_equal(contact.start, start) and np.allclose(contact.approach, direction)
            assert np.array_equal(probe.position, contact.center)
            off = math.dist(contact.center, true.contact.center)
            turn = _angle(contact.normal, true.contact.normal)
            assert off <= 0.5 + 1e-9 and turn <= math.radians(4) + 1e-7
            if noise == "bounds":
                assert off == pytest.approx(0.5) and turn == pytest.approx(math.radians(4), abs=1e-7)
            touched.append((start, direction, true.contact.center, true.contact.normal))
        # The true tip went along a line beside the one that was asked for, and touched where it stopped.
        starts, directions, centers, normals = map(np.array, zip(*touched, strict=True))
        ways = centers - starts
        depths = np.einsum("ni,ni->n", ways, directions)
        asides = ways - depths[:, None] * directions
        away = np.linalg.norm(asides, axis=1)
        assert away.max() <= 0.3 + 1e-9
        assert away.min() >= 0.3 - 1e-9 if noise == "bounds" else away.min() < 0.1
        np.testing.assert_allclose(placed.distances(centers), radius, atol=1e-9)
        np.testing.assert_allclose(placed.distances(centers - radius * normals), 0.0, atol=1e-9)
        gone = placed.marched(starts + asides, directions, radius=radius - 1e-6, last=depths)
        np.testing.assert_array_equal(gone, depths, err_msg="it was touched before")
    assert kinds["Hit"] > 500 and kinds["Skid"] > 100 and kinds["Miss"] > 100


def _angle(a, b):
    return 2.0 * math.asin(min(1.0, 0.5 * float(np.linalg.norm(a - b))))


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_errors_fill_the_ball_the_cone_and_the_disc(noise):
    """Against a wall, where the true place is known exactly."""
    model, pose = wall()
    sensor = usual_sensor(path_error=0.4)
    probe = palpate.SimulatedProbe(model, pose, sensor, noise=noise)
    still = palpate.SimulatedProbe(model, pose, usual_sensor(position_error=0.0, path_error=0.4), noise=noise)
    offsets, normals, asides = [], [], []
    for y in np.linspace(-400, 400, 50):
        for z in np.linspace(-400, 400, 40):
            contact, true = (one.touch((-50, y, z), (50, y, z)).contact for one in (probe, still))
            assert true.center[0] == pytest.approx(0.0, abs=1e-12)
            offsets.append(contact.center - true.center)
            asides.append((true.center - (0.0, y, z))[1:])
            normals.append(contact.normal)
    radii, away = (np.linalg.norm(np.array(one), axis=1) for one in (offsets, asides))
    turns = np.arccos(np.clip(-np.array(normals)[:, 0], -1.0, 1.0))
    assert radii.max() <= 0.5 + 1e-12 and turns.max() <= math.radians(4) + 1e-9 and away.max() <= 0.4 + 1e-12
    # To all sides alike: no mean, and as much along each axis.
    for drawn, size in ((offsets, 3), (asides, 2), (np.array(normals)[:, 1:], 2)):
        drawn = np.array(drawn)
        assert drawn.shape == (2000, size)
        spread = np.sqrt((drawn**2).mean(axis=0))
        assert np.abs(drawn.mean(axis=0)).max() < 0.1 * spread.min()
        assert spread.max() < 1.08 * spread.min()
    # Uniform: half of them within the middle half of the volume or area. At the bounds: all on the rim.
    for value, bound, power in ((radii, 0.5, 3), (away, 0.4, 2), (turns, math.radians(4), 2)):
        share = np.mean(value < bound * 0.5 ** (1.0 / power))
        assert share == pytest.approx(0.5 if noise == "uniform" else 0.0, abs=0.04)


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_overtravel_is_one_sided_and_within_the_position_error(noise):
    model, pose = wall()
    probe = palpate.SimulatedProbe(model, pose, usual_sensor(), noise=noise, overtravel=0.4)
    offsets = np.array([probe.touch((-50, y, 7), (50, y, 7)).contact.center - (0, y, 7) for y in range(400)])
    assert np.linalg.norm(offsets, axis=1).max() <= 0.5 + 1e-12
    assert offsets[:, 0].min() >= -0.1 - 1e-12 and np.abs(offsets[:, 1:]).max() <= 0.1 + 1e-12
    assert offsets[:, 0].mean() > 0.15


def test_the_tip_stays_parallel_to_its_line():
    """A thin pin, passed at less than the path error: it is met on some of the lines that lead past it."""
    pin = box(1, 1, 1)
    probe = palpate.SimulatedProbe(pin, np.eye(4), usual_sensor(path_error=1.0))
    replies = [probe.touch((-20 - k * 1e-3, 1.5, 0.5), (20, 1.5, 0.5)) for k in range(400)]
    kinds = [type(reply).__name__ for reply in replies]
    # Met if it is off by 0.5 or more towards the pin, and by no more than 0.5 to either side of it.
    y, z = np.meshgrid(np.linspace(-1, 1, 1001), np.linspace(-1, 1, 1001))
    share = np.mean(((y <= -0.5) & (np.abs(z) <= 0.5))[y * y + z * z <= 1.0])
    assert kinds.count("Hit") == pytest.approx(400 * share, abs=35) and kinds.count("Skid") == 0
    # With more path error than position error, the contact says of no way that it was free.
    assert all(r.contact.start is None for r in replies if isinstance(r, palpate.Hit))


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
@pytest.mark.parametrize("radius", RADII)
def test_whatever_is_answered_leaves_the_truth(noise, radius):
    """The exact predicate of the core, not the probe's own, says that each reply fits the true pose."""
    sensor = palpate.Sensor(0.5, math.radians(4), math.radians(60), radius, 0.4)
    model = bracket()
    probe = palpate.SimulatedProbe(model, POSE, sensor, seed=8, noise=noise, overtravel=0.2)
    contacts, misses = [], []
    for start, direction in zip(*lines(PlacedSolid(model, POSE), model, count=60, seed=9), strict=True):
        reply = probe.touch(start, start + 2.5 * model.size * direction)
        if isinstance(reply, palpate.Hit):
            contacts.append(reply.contact)
        else:
            misses.append(reply.free if isinstance(reply, palpate.Skid) else reply)
    prior = palpate.Prior(POSE, translation=3.0, rotation=0.1)
    found = palpate.recognize([model], contacts, misses=misses, prior=prior)
    assert any(one.poses.contains(POSE) for one in found.hypotheses)
    assert len(misses) > 5 and len(contacts) > 20


def test_skids_end_short_of_the_sensed_place():
    probe = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(), noise="bounds")
    steep, gentle = ([math.cos(math.radians(a)), 0.0, math.sin(math.radians(a))] for a in (25, 35))
    for k in range(50):
        start = np.array([-30.0 + 0.2 * k, 10.0, -15.0])
        reply = probe.touch(start, start + 100 * np.array(steep))
        assert isinstance(reply, palpate.Skid)
        true = 15.0 / steep[2]
        swept = math.dist(reply.free.start, reply.free.end)
        assert true - 1.0 - 1e-9 <= swept <= true + 1e-9
    assert isinstance(
        probe.touch((-10.0, 10.0, -15.0), (-10.0, 10.0, -15.0) + 100 * np.array(gentle)), palpate.Hit
    )
    still = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(), noise="none")
    reply = still.touch((10, 10, -0.1), (20, 10, 4.9))
    assert isinstance(reply, palpate.Skid) and np.array_equal(reply.free.start, reply.free.end)


def test_what_cant_be_touched_skids():
    part = cube(untouchable=range(2))  # its floor
    probe = palpate.SimulatedProbe(part, np.eye(4), usual_sensor())
    assert isinstance(probe.touch((15, 10, -50), (15, 10, 50)), palpate.Skid)
    assert isinstance(probe.touch((15, 10, 80), (15, 10, 20)), palpate.Hit)
    loose = palpate.Model.facets([[[0, 0, 0], [100, 0, 0], [100, 100, 0], [0, 100, 0]]])  # outward is up
    probe = palpate.SimulatedProbe(loose, np.eye(4), usual_sensor(tip_radius=2.0))
    assert isinstance(probe.touch((50, 40, -50), (50, 40, 50)), palpate.Skid)
    assert isinstance(probe.touch((50, 40, 50), (50, 40, -50)), palpate.Hit)
    assert isinstance(probe.touch((-1, 40, 50), (-1, 40, -50)), palpate.Skid), "where it ends"


def test_a_ball_rests_on_edges_and_corners():
    probe = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(tip_radius=5.0), noise="none")
    over_edge = probe.touch((-3, 12, 60), (-3, 12, 0)).contact
    assert np.allclose(over_edge.center, (-3, 12, 34)) and np.allclose(over_edge.normal, (-0.6, 0, 0.8))
    over_corner = probe.touch((-3, 30, 60), (-3, 30, 0)).contact
    assert np.allclose(over_corner.center, over_edge.center + np.array([0, 18, 0]))
    beyond = probe.touch((-2, 32, 60), (-2, 32, 0)).contact
    assert np.allclose(beyond.normal, np.array([-2, 2, math.sqrt(17)]) / 5)


def test_already_touching_and_unexpected_touches():
    probe = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(tip_radius=5.0))
    assert isinstance(probe.touch((-3, 15, 15), (50, 15, 15)), palpate.AlreadyTouching)
    assert isinstance(probe.touch((15, 15, 15), (200, 15, 15)), palpate.AlreadyTouching)
    assert isinstance(probe.touch((-30, 15, 15), (50, 15, 15)), palpate.Hit)
    assert probe.move([(-30, 15, 15), (-30, -30, 15), (60, -30, 70)]) is None
    assert np.array_equal(probe.position, (60, -30, 70))
    unexpected = probe.move([(60, 15, 20), (-30, 15, 20)])
    assert unexpected == palpate.UnexpectedTouch(np.array([35.0, 15.0, 20.0]))
    assert np.allclose(probe.position, (35, 15, 20))


def test_no_normals():
    probe = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(normal_error=None))
    contact = probe.touch((-30, 15, 15), (50, 15, 15)).contact
    assert contact.normal is None and contact.normal_error is None
    assert np.allclose(contact.approach, (1, 0, 0))


def test_same_seed_and_move_same_reply_whatever_came_before():
    def probe(seed):
        return palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor(path_error=0.2), seed=seed)

    moves = [((-30, y, 14), (50, y, 14)) for y in (5, 12, 20)]
    a, b = probe(1), probe(1)
    replies = [a.touch(*move) for move in moves]
    assert [b.touch(*move) for move in reversed(moves)] == replies[::-1]
    assert a.touch(*moves[0]) != replies[0]
    assert probe(2).touch(*moves[0]) != replies[0]
    taken_up = probe(1)
    taken_up.made(*moves[0])
    assert taken_up.touch(*moves[0]) != replies[0] and a.simulation == b.simulation


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"world_from_model": np.eye(3)}, "world_from_model"),
        ({"world_from_model": 2.0 * np.eye(4)}, "world_from_model"),
        ({"overtravel": math.nan}, "overtravel"),
        ({"position": (1, 2)}, r"position.*space, shape \(3,\)"),
    ],
)
def test_bad_input(change, message):
    given = {"model": cube(), "world_from_model": np.eye(4), "sensor": usual_sensor(), **change}
    with pytest.raises(ValueError, match=message):
        palpate.SimulatedProbe(**given)


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        ((0, 0), (1, 1, 1), "start.*space"),
        ((0, 0, 0), (math.inf, 1, 1), "end"),
        ((0, 0, 0), (0, 0, 0), "end"),
    ],
)
def test_bad_moves(start, end, message):
    probe = palpate.SimulatedProbe(cube(), np.eye(4), usual_sensor())
    with pytest.raises(ValueError, match=message):
        probe.touch(start, end)
    with pytest.raises(ValueError, match=r"points\[0\]"):
        probe.move([(0, 0)])


def test_random_poses_lie_in_the_workspace_and_leave_room():
    model = bracket()
    random, corners = np.random.default_rng(0), np.array([[-60.0, -20.0, 0.0], [60.0, 100.0, 150.0]])
    axes = []
    for _ in range(1000):
        pose = random_pose(model, corners, room=3.0, random=random)
        placed = model.vertices @ pose[:3, :3].T + pose[:3, 3]
        assert (placed >= corners[0] + 3.0 - 1e-9).all() and (placed <= corners[1] - 3.0 + 1e-9).all()
        assert model.distance(pose, (0, 0, 0)) is not None  # a rigid motion
        axes.append(pose[:3, 2])
    # All of them fit, so that every direction is as likely.
    assert np.abs(np.mean(axes, axis=0)).max() < 0.06
    assert np.allclose(np.mean(np.square(axes), axis=0), 1 / 3, atol=0.04)
    with pytest.raises(ValueError, match="workspace: 'bracket' has no room in it"):
        random_pose(model, np.array([[0.0] * 3, [30.0] * 3]), room=0.0, random=random)


def test_random_poses_of_a_prior_are_within_its_bounds_and_reach_them():
    random = np.random.default_rng(4)
    middle = turned(0.3, -0.5, 1.1, (4, 5, 6))
    prior = palpate.Prior(middle, translation=3.0, rotation=0.4)
    normal = np.array([1.0, 2.0, 2.0]) / 3.0
    lying = palpate.Prior.on_plane(middle, translation=5.0, rotation=0.6, height=0.5, tilt=0.1, normal=normal)
    shifts, angles, along, heights, tilts = [], [], [], [], []
    for _ in range(2000):
        pose = pose_within(prior, random)
        shifts.append(np.abs(pose[:3, 3] - middle[:3, 3]).max())
        angles.append(np.linalg.norm(vector_of(pose[:3, :3] @ middle[:3, :3].T)))
        pose = pose_within(lying, random)
        shift, turn = pose[:3, 3] - middle[:3, 3], pose[:3, :3] @ middle[:3, :3].T
        heights.append(abs(float(shift @ normal)))
        along.append(np.linalg.norm(shift - (shift @ normal) * normal))
        tilts.append(math.acos(min(1.0, float(turn @ normal @ normal))))
    for found, most in zip((shifts, angles, along, heights, tilts), (3.0, 0.4, 5.0, 0.5, 0.1), strict=True):
        assert 0.97 * most < max(found) <= most + 1e-9
    flat = palpate.Prior(np.eye(3), translation=2.0, rotation=0.3)
    turns = [math.atan2(pose[1, 0], pose[0, 0]) for pose in (pose_within(flat, random) for _ in range(500))]
    assert 0.28 < max(turns) <= 0.3 and -0.3 <= min(turns) < -0.28


def test_a_random_truth_lies_as_the_prior_has_it(capsys):
    flags = ["--prior-pose", "0,0,0,0,0,0", "--prior-translation", "10", "--prior-rotation-deg", "15"]
    for seed in range(3):
        assert main(["identify", "l-bracket", *flags, "--seed", str(seed)]) == 0
        assert "solved" in capsys.readouterr().out
