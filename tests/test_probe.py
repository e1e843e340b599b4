"""The simulated probe against shapely: where it touches, how large its errors are, what it answers."""

import math

import numpy as np
import pytest
from casting import Placed
from conftest import pose, usual_sensor

import palpate
from palpate.probe import random_pose

PARTS = palpate.load_models(list(palpate.part_names()))
RADII = (0.0, 3.0)
CLEAR = 1e-6  # a line so near to grazing a corner is left out: shapely's arcs are chords


def lines(model, world_from_model, count, seed):
    """Random lines from a circle around the part, most of which meet it."""
    random = np.random.default_rng(seed)
    middle = world_from_model[:2, :2] @ model.vertices.mean(axis=0) + world_from_model[:2, 2]
    for _ in range(count):
        out, way = random.uniform(-math.pi, math.pi, size=2)
        start = middle + 1.2 * model.size * np.array([math.cos(out), math.sin(out)])
        aim = middle + 0.5 * model.size * random.uniform() * np.array([math.cos(way), math.sin(way)])
        direction = (aim - start) / math.dist(aim, start)
        yield start, direction


def stable(placed, start, direction, met):
    """Whether nearby lines meet the same place: else chords for arcs may tell something else."""
    left = np.array([-direction[1], direction[0]])
    for shift in (-1e-3, 1e-3):
        other = placed.first(start + shift * left, direction)
        if (other is None) != (met is None) or (met and abs(other[0] - met[0]) > 0.05):
            return False
    return True


@pytest.mark.parametrize("radius", RADII)
def test_first_contact_is_that_of_shapely(radius):
    checked = 0
    for k, model in enumerate(PARTS):
        world_from_model = pose(0.3 + k, 10.0 * k, -5.0)
        placed = Placed(model, world_from_model, radius)
        for start, direction in lines(model, world_from_model, 120, seed=k):
            expected = placed.first(start, direction)
            met = model.first_contact(world_from_model, start, 3.0 * direction, radius)
            if not stable(placed, start, direction, expected):
                continue
            checked += 1
            assert (met is None) == (expected is None)
            if met is not None:
                depth, feature, normal, _ = expected
                assert met.depth == pytest.approx(depth, abs=1e-3)
                assert np.allclose(met.center, start + met.depth * direction)
                assert met.feature == feature and met.touchable
                assert np.allclose(met.normal, normal, atol=2e-3)
    assert checked > 800


def test_distance_is_that_of_shapely():
    from shapely import Point

    random = np.random.default_rng(1)
    signs = set()
    for model in PARTS:
        world_from_model = pose(1.0, 3.0, 4.0)
        part = Placed(model, world_from_model, 0.0).grown
        for point in random.uniform(-150, 150, size=(60, 2)):
            away = part.exterior.distance(Point(point))
            expected = -away if part.contains(Point(point)) else away
            signs.add(expected > 0)
            assert model.distance(world_from_model, point) == pytest.approx(expected, abs=1e-9)
    assert signs == {True, False}


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("noise", ["uniform", "bounds", "none"])
def test_errors_are_within_their_bounds_and_reach_them(radius, noise):
    sensor = palpate.Sensor(0.5, math.radians(4), math.radians(60), radius, 0.3)
    model, world_from_model = PARTS[1], pose(0.7, 20.0, 30.0)
    placed = Placed(model, world_from_model, radius)
    probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=5, noise=noise)
    errors, turns, kinds = [], [], set()
    for start, direction in lines(model, world_from_model, 120, seed=3):
        end = start + 2.5 * model.size * direction
        reply = probe.touch(start, end)
        kinds.add(type(reply).__name__)
        if isinstance(reply, palpate.Miss):
            assert np.array_equal(reply.start, start) and np.array_equal(reply.end, end)
            assert (reply.tip_radius, reply.path_error) == (radius, 0.3)
        if not isinstance(reply, palpate.Hit):
            continue
        contact = reply.contact
        assert (contact.tip_radius, contact.position_error) == (radius, 0.5)
        assert np.array_equal(contact.start, start) and np.allclose(contact.approach, direction)
        # The true line is off by up to the path error: the true centre is one of those of all such lines.
        left = np.array([-direction[1], direction[0]])
        found = [placed.first(start + s * left, direction) for s in np.linspace(-0.3, 0.3, 31)]
        true = [
            start + s * left + f[0] * direction
            for s, f in zip(np.linspace(-0.3, 0.3, 31), found, strict=True)
            if f
        ]
        errors.append(min(math.dist(contact.center, place) for place in true))
        turns.append(min(math.acos(min(1.0, float(contact.normal @ f[2]))) for f in found if f))
    assert kinds >= {"Hit", "Miss", "Skid"}
    assert max(errors) <= 0.5 + 0.02 and max(turns) <= math.radians(4) + 1e-2
    if noise == "none":
        assert max(errors) < 0.02 and max(turns) < 1e-2
    else:
        assert max(turns) > math.radians(3.8)


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_position_errors_fill_the_disc(noise):
    """Against a long straight face, where the true place is known exactly."""
    model = palpate.Model.polygon([[0, -500], [100, -500], [100, 500], [0, 500]])
    probe = palpate.SimulatedProbe(model, np.eye(3), usual_sensor(), noise=noise)
    offsets, turns = [], []
    for y in np.linspace(-400, 400, 1000):
        contact = probe.touch((-50, y), (50, y)).contact
        offsets.append(contact.center - (0.0, y))
        turns.append(math.atan2(-contact.normal[1], -contact.normal[0]))
    radii = np.hypot(*np.array(offsets).T)
    assert radii.max() <= 0.5 + 1e-12 and np.abs(turns).max() <= math.radians(4) + 1e-12
    assert np.ptp(np.array(offsets), axis=0).min() > 0.9  # in all directions
    assert min(turns) < -math.radians(3.9) and max(turns) > math.radians(3.9)
    # Uniform in the disc: half of them within 1/√2 of its radius. At the bounds: all on its rim.
    assert np.mean(radii < 0.5 / math.sqrt(2)) == pytest.approx(0.5 if noise == "uniform" else 0.0, abs=0.05)


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
def test_overtravel_is_one_sided_and_within_the_position_error(noise):
    model = palpate.Model.polygon([[0, -500], [100, -500], [100, 500], [0, 500]])
    probe = palpate.SimulatedProbe(model, np.eye(3), usual_sensor(), noise=noise, overtravel=0.4)
    offsets = np.array([probe.touch((-50, y), (50, y)).contact.center - (0, y) for y in range(400)])
    assert np.hypot(*offsets.T).max() <= 0.5 + 1e-12
    assert offsets[:, 0].min() >= -0.1 - 1e-12 and np.abs(offsets[:, 1]).max() <= 0.1 + 1e-12
    assert offsets[:, 0].mean() > 0.15
    with pytest.raises(ValueError, match="overtravel"):
        palpate.SimulatedProbe(model, np.eye(3), usual_sensor(), overtravel=0.6)


def test_the_tip_stays_parallel_to_its_line():
    """A thin pin, passed at less than the path error: it is met on some of the lines that lead past it."""
    pin = palpate.Model.polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    sensor = usual_sensor(path_error=1.0)
    probe = palpate.SimulatedProbe(pin, np.eye(3), sensor)
    replies = [probe.touch((-20 - k * 1e-3, 1.5), (20, 1.5)) for k in range(200)]
    kinds = [type(reply).__name__ for reply in replies]
    # Met if the tip is off by -0.5 or more: a quarter of all.
    assert kinds.count("Hit") == pytest.approx(50, abs=20) and kinds.count("Miss") == 200 - kinds.count("Hit")
    # With more path error than position error, the contact says of no way that it was free.
    assert all(r.contact.start is None for r in replies if isinstance(r, palpate.Hit))


@pytest.mark.parametrize("noise", ["uniform", "bounds"])
@pytest.mark.parametrize("radius", RADII)
def test_whatever_is_answered_leaves_the_truth(noise, radius):
    """The exact predicate of the core, not the probe's own, says that each reply fits the true pose."""
    sensor = palpate.Sensor(0.5, math.radians(4), math.radians(60), radius, 0.4)
    model, world_from_model = PARTS[0], pose(-0.4, -20.0, 7.0)
    probe = palpate.SimulatedProbe(model, world_from_model, sensor, seed=8, noise=noise, overtravel=0.2)
    contacts, misses = [], []
    for start, direction in lines(model, world_from_model, 40, seed=9):
        reply = probe.touch(start, start + 2.5 * model.size * direction)
        if isinstance(reply, palpate.Hit):
            contacts.append(reply.contact)
        elif isinstance(reply, palpate.Skid):
            misses.append(reply.free)
        else:
            misses.append(reply)
    found = palpate.recognize([model], contacts, misses=misses)
    assert any(one.poses.contains(world_from_model) for one in found.hypotheses)
    assert len(misses) > 2 and len(contacts) > 10


def square():
    return palpate.Model.polygon([[0, 0], [100, 0], [100, 100], [0, 100]], name="square")


def test_skids_end_short_of_the_sensed_place():
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(), noise="bounds")
    steep = np.array(
        [math.cos(math.radians(25)), math.sin(math.radians(25))]
    )  # 65° from the normal of the lower face
    for k in range(50):
        start = np.array([-20.0 + k, -30.0])
        reply = probe.touch(start, start + 200 * steep)
        assert isinstance(reply, palpate.Skid)
        true = 30.0 / steep[1]
        swept = math.dist(reply.free.start, reply.free.end)
        assert true - 1.0 - 1e-9 <= swept <= true + 1e-9
    gentle = np.array([math.cos(math.radians(35)), math.sin(math.radians(35))])
    assert isinstance(probe.touch((0.0, -30.0), (0.0, -30.0) + 200 * gentle), palpate.Hit)


def test_a_skid_at_once_has_a_way_of_no_length():
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(), noise="none")
    reply = probe.touch((50, -0.1), (80, 9.9))
    assert isinstance(reply, palpate.Skid)
    assert np.array_equal(reply.free.start, reply.free.end)


def test_what_cant_be_touched_skids():
    part = palpate.Model.polygon([[0, 0], [100, 0], [100, 100], [0, 100]], untouchable=[0])
    probe = palpate.SimulatedProbe(part, np.eye(3), usual_sensor())
    assert isinstance(probe.touch((50, -50), (50, 50)), palpate.Skid)
    assert isinstance(probe.touch((-50, 50), (50, 50)), palpate.Hit)
    loose = palpate.Model.segments([[[0, 0], [100, 0]]])  # outward is down
    probe = palpate.SimulatedProbe(loose, np.eye(3), usual_sensor())
    assert isinstance(probe.touch((50, 50), (50, -50)), palpate.Skid)
    assert isinstance(probe.touch((50, -50), (50, 50)), palpate.Hit)


def test_corners_and_grazing():
    """A point at a corner meets a face there; past a corner, however near, it meets nothing."""
    corner = palpate.Model.polygon([[0, 0], [10, -10], [20, 0], [10, 10]])
    met = corner.first_contact(np.eye(3), (-10, 0), (1, 0))
    assert met.depth == pytest.approx(10) and met.feature[0] == "face"
    assert corner.first_contact(np.eye(3), (-10, 10 + 1e-9), (1, 0)) is None
    assert corner.first_contact(np.eye(3), (-10, 10 - 1e-9), (1, 0)).feature == ("face", 3)
    assert square().first_contact(np.eye(3), (-10, 100.0001), (1, 0)) is None
    met = corner.first_contact(np.eye(3), (-10, 0), (1, 0), 2.0)
    assert met.depth == pytest.approx(8) and met.feature == ("vertex", 0)
    assert np.allclose(met.normal, (-1, 0))


def test_already_touching_and_unexpected_touches():
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(tip_radius=5.0))
    assert isinstance(probe.touch((-3, 50), (50, 50)), palpate.AlreadyTouching)
    assert isinstance(probe.touch((50, 50), (200, 50)), palpate.AlreadyTouching)
    assert isinstance(probe.touch((-30, 50), (50, 50)), palpate.Hit)
    assert probe.move([(-30, 50), (-30, -30), (130, -30)]) is None
    assert np.array_equal(probe.position, (130, -30))
    unexpected = probe.move([(130, 50), (-30, 50)])
    assert unexpected == palpate.UnexpectedTouch(np.array([105.0, 50.0]))
    assert np.allclose(probe.position, (105, 50))


def test_no_normals():
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(normal_error=None))
    contact = probe.touch((-30, 50), (50, 50)).contact
    assert contact.normal is None and contact.normal_error is None and np.allclose(contact.approach, (1, 0))


def test_what_replies_claim_may_differ_from_what_is_done():
    believed = usual_sensor(position_error=0.1)
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(position_error=5.0), believed=believed)
    contacts = [probe.touch((-30, y), (50, y)).contact for y in range(20, 80)]
    assert all(contact.position_error == 0.1 for contact in contacts)
    assert max(math.dist(c.center, (0, y)) for y, c in zip(range(20, 80), contacts, strict=True)) > 3.0


def test_same_seed_and_move_same_reply_whatever_came_before():
    def probe(seed):
        return palpate.SimulatedProbe(square(), np.eye(3), usual_sensor(), seed=seed)

    moves = [((-30, y), (50, y)) for y in (20, 40, 60)]
    a, b = probe(1), probe(1)
    replies = [a.touch(*move) for move in moves]
    assert [b.touch(*move) for move in reversed(moves)] == replies[::-1]
    assert a.touch(*moves[0]) != replies[0]
    assert probe(2).touch(*moves[0]) != replies[0]


def test_the_protocol():
    assert isinstance(palpate.SimulatedProbe(square(), np.eye(3), usual_sensor()), palpate.Probe)
    assert not isinstance(square(), palpate.Probe)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"model": "boot"}, "model"),
        ({"world_from_model": np.eye(4)}, "world_from_model"),
        ({"sensor": 3}, "sensor"),
        ({"believed": 3}, "believed"),
        ({"seed": -1}, "seed"),
        ({"noise": "loud"}, "noise.*'loud'"),
        ({"overtravel": math.nan}, "overtravel"),
        ({"position": (1, 2, 3)}, "position"),
    ],
)
def test_bad_input(change, message):
    given = {"model": square(), "world_from_model": np.eye(3), "sensor": usual_sensor(), **change}
    with pytest.raises(ValueError, match=message):
        palpate.SimulatedProbe(**given)


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        ((0, 0, 0), (1, 1), "start"),
        ((0, 0), (math.inf, 1), "end"),
        ((0, 0), (0, 0), "end"),
        ("a", (0, 0), "start"),
    ],
)
def test_bad_moves(start, end, message):
    probe = palpate.SimulatedProbe(square(), np.eye(3), usual_sensor())
    with pytest.raises(ValueError, match=message):
        probe.touch(start, end)
    with pytest.raises(ValueError, match="points"):
        probe.move([(0, 0, 0)])


def test_random_poses_lie_in_the_workspace_and_leave_room():
    (model,) = palpate.load_models(["drill-left"])
    random, corners = np.random.default_rng(0), np.array([[-100.0, -20.0], [60.0, 180.0]])
    for _ in range(200):
        pose = random_pose(model, corners, room=3.0, random=random)
        placed = model.vertices @ pose[:2, :2].T + pose[:2, 2]
        assert (placed >= corners[0] + 3.0 - 1e-9).all() and (placed <= corners[1] - 3.0 + 1e-9).all()
    with pytest.raises(ValueError, match="workspace: 'drill-left' has no room in it"):
        random_pose(model, np.array([[0.0, 0.0], [50.0, 50.0]]), room=0.0, random=random)
