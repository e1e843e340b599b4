"""The closed loop in space: nothing true is lost, no way goes through the workspace, a killed run goes on."""

import itertools
import json
import math

import numpy as np
import pytest
from brackets import touches, turned
from conftest import usual_sensor
from test_cli import validate

import palpate
from palpate.experiments import campaign_loop_space
from palpate.loop.entries import settings_in, start_event
from palpate.loop.explore import Explorations, independent, region_of, smallest_width
from palpate.loop.refuted import without_way
from palpate.loop.route import length_of
from palpate.loop.settings import settings_of
from palpate.loop.surface import open_sides, sides_of, surface_route
from palpate.probe import random_pose
from palpate.truth import number_of_truth

SOLIDS = palpate.load_models(list(palpate.solid_part_names()))
SIZE = max(model.size for model in SOLIDS)
BOX = SIZE * np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
DOWN = ((0.0, 0.0, -1.0), 1.0)
CHOSEN = {
    "prior": None, "contacts": (), "misses": (), "blind": None, "planner": "auto", "stop": "perfect",
    "directions": None, "margin": 1e-3, "effort": 1000, "time_limit": None, "features": None,
    "max_touches": 50, "max_hypotheses": 100, "until": None, "seed": 0, "unit": "mm",
}  # fmt: skip


class Watched:
    """A probe that is watched: guarded moves begin on the box, where the tip is; free moves go over it."""

    def __init__(self, probe, box, directions=None):
        self.probe, self.box, self.directions = probe, np.array(box, dtype=float), directions
        self.at = self.came_from = None
        self.num_touches = 0

    @property
    def position(self):
        return self.probe.position

    @property
    def simulation(self):
        return self.probe.simulation

    def made(self, start, end):
        self.probe.made(start, end)

    def touch(self, start, end):
        assert self.at is None or np.array_equal(self.at, start)
        assert self.is_open(start) and (end >= self.box[0] - 1e-6).all() and (end <= self.box[1] + 1e-6).all()
        if self.directions is not None:
            axis, half = self.directions
            way = (end - start) / np.linalg.norm(end - start)
            assert math.acos(min(1.0, way @ np.array(axis))) <= half + 1e-9
        self.num_touches += 1
        reply = self.probe.touch(start, end)
        self.at, self.came_from = self.probe.position, np.array(start)
        return reply

    def move(self, points):
        for k, point in enumerate(points):
            back = k == 0 and np.array_equal(point, self.came_from)
            over = set(sides_of(self.box, self.at)) & set(sides_of(self.box, point))
            assert back or over & set(open_sides(self.directions))
            self.at = np.array(point)
        return self.probe.move(points)

    def is_open(self, point):
        return bool(set(sides_of(self.box, point)) & set(open_sides(self.directions)))


def hidden(number, *, radius=0.0):
    """A bundled solid somewhere in the box, and a watched probe that touches it."""
    model, sensor = SOLIDS[number % len(SOLIDS)], usual_sensor(tip_radius=radius)
    world_from_model = random_pose(model, BOX, room=8.0, random=np.random.default_rng(number))
    simulated = palpate.SimulatedProbe(model, world_from_model, sensor, seed=number, noise="bounds")
    return model, world_from_model, sensor, Watched(simulated, BOX)


@pytest.mark.parametrize(("number", "radius"), [(1, 0.0), (2, 0.0), (4, 0.0), (13, 2.0)])
def test_the_truth_is_found(number, radius):
    model, world_from_model, sensor, probe = hidden(number, radius=radius)
    result = palpate.identify(SOLIDS, probe, sensor, BOX)
    assert number_of_truth(result.hypotheses, model, world_from_model) is not None
    assert result.status == "solved" and len(result.hypotheses) == 1
    assert result.touches == probe.num_touches == len(result.steps)
    assert np.array_equal(result.workspace, BOX)
    assert all(step.path is not None for step in result.steps if step.purpose == "path")


def test_no_path_comes_up_through_the_table():
    model, sensor = SOLIDS[0], usual_sensor()
    lying = turned(0.0, 0.0, 0.4, (12.0, -20.0, 0.0))
    lying[2, 3] = -(model.vertices @ lying[:3, :3].T)[:, 2].min()
    box = np.array([[-200.0, -200.0, 1.0], [200.0, 200.0, 250.0]])
    prior = palpate.Prior.on_plane(lying, translation=60.0, rotation=math.pi, height=0.5, tilt=0.01)
    simulated = palpate.SimulatedProbe(model, lying, sensor, seed=3)
    probe = Watched(simulated, box, DOWN)
    result = palpate.identify(SOLIDS, probe, sensor, box, prior=prior, directions=DOWN)
    assert number_of_truth(result.hypotheses, model, lying) is not None
    assert result.status == "solved" and (2, 0) not in open_sides(DOWN)


def test_poses_are_tightened():
    model, world_from_model, sensor, probe = hidden(2)
    loose = palpate.identify(SOLIDS, hidden(2)[3], sensor, BOX)
    result = palpate.identify(SOLIDS, probe, sensor, BOX, until=(8.0, math.radians(4)), max_touches=60)
    (before,), (last,) = loose.hypotheses, result.hypotheses
    assert last.poses.contains(world_from_model) and any(step.purpose == "verify" for step in result.steps)
    assert last.poses.rotation_bound < before.poses.rotation_bound
    assert result.until_met == (result.status == "solved")
    if result.until_met:
        assert max(last.poses.excursion(vertex) for vertex in model.vertices) <= 8.0


def test_a_log_is_resumed_and_replayed(tmp_path):
    def told(result):
        return [
            (step.purpose, step.start.tolist(), step.end.tolist()) for step in result.steps
        ], result.status

    _, _, sensor, probe = hidden(1)
    whole = tmp_path / "run.jsonl"
    result = palpate.identify(SOLIDS, probe, sensor, BOX, log=whole)
    lines = whole.read_bytes().splitlines(keepends=True)
    for line in lines:
        validate(json.loads(line), "run-1")
    assert told(palpate.replay(whole)) == told(result)
    for count in range(1, len(lines), 4):
        part = tmp_path / f"part-{count}.jsonl"
        part.write_bytes(b"".join(lines[:count]) + lines[count][:9])
        again = palpate.identify(SOLIDS, hidden(1)[3].probe, sensor, BOX, log=part, resume=True)
        assert told(again) == told(result) and part.read_bytes() == whole.read_bytes()


def test_a_start_is_read_as_it_was_written():
    table = {"height": 0.5, "tilt": 0.1, "normal": (0, 1, 2)}
    prior = palpate.Prior.on_plane(np.eye(4), translation=3.0, rotation=1.0, **table)
    sensor = usual_sensor(stem=((0, 0, 1), 1.0, 50.0))
    given = {**CHOSEN, "prior": prior, "directions": DOWN, "contacts": touches()[:2], "features": ["edge"]}
    settings = settings_of(SOLIDS[:1], sensor, BOX, **given)
    event = json.loads(json.dumps(start_event(settings, np.zeros(3), simulation=None)))
    validate(event, "run-1")
    again = settings_in(event)
    assert again.sensor == sensor == settings.sensor and again.prior == prior
    assert again.moved.stem is not None and again.moved.path_error == sensor.position_error
    assert again.contacts == settings.contacts and again.directions == settings.directions
    without = start_event(settings_of(SOLIDS[:1], usual_sensor(), BOX, **CHOSEN), None, simulation=None)
    assert "stem" not in without["sensor"]


@pytest.mark.parametrize("change", ["center", "start"])
def test_a_log_of_mixed_dimensions_is_refused(tmp_path, change):
    _, _, sensor, probe = hidden(1)
    log = tmp_path / "run.jsonl"
    palpate.identify(SOLIDS, probe, sensor, BOX, log=log)
    lines = [json.loads(line) for line in log.read_text("utf-8").splitlines()]
    hit = next(line for line in lines if line.get("kind") == "hit")
    hit["contact"][change] = hit["contact"][change][:2]
    log.write_text("".join(json.dumps(line) + "\n" for line in lines), "utf-8")
    with pytest.raises(ValueError, match=r"^log: .* has a point of 2 coordinates in a run of 3"):
        palpate.replay(log)


def test_ways_go_over_the_open_sides():
    random = np.random.default_rng(5)
    box = np.array([[0.0, 0.0, 0.0], [30.0, 20.0, 10.0]])
    closed = open_sides(DOWN)
    assert len(closed) == 5 and open_sides(((0, 0, -2), 0.0)) == [(2, 1)]

    def place(sides):
        point, (axis, upper) = random.uniform(*box), sides[random.integers(len(sides))]
        point[axis] = box[upper, axis]
        # Some are on an edge, of which one side may be closed.
        other = random.integers(3)
        if random.random() < 0.3:
            point[other] = box[0, other] if other != axis else point[other]
        return point

    below = np.array([10.0, 10.0, 0.0])
    with pytest.raises(ValueError, match=r"^end: is on no side .* that allowed directions enter"):
        surface_route(box, place(closed), below, sides=closed)
    tilted = open_sides(((1, 0, -0.2), 0.1))
    assert len(tilted) == 4 and (2, 0) not in tilted
    crossed = set()
    for sides in (None, closed, tilted):
        for _ in range(300):
            start, end = place(sides or open_sides(None)), place(sides or open_sides(None))
            way = [start, *surface_route(box, start, end, sides=sides)]
            assert np.array_equal(way[-1], end)
            for a, b in itertools.pairwise(way):
                assert set(sides_of(box, a)) & set(sides_of(box, b)) & set(sides or open_sides(None))
            back = surface_route(box, end, start, sides=sides)
            assert length_of(way) == pytest.approx(length_of([end, *back]))
            assert length_of(way) <= np.abs(end - start).sum() + 2.0 * 30.0
            crossed.add(len(way))
    assert crossed == {2, 3, 4} and surface_route(box, box[0], box[0]) == []


def test_explorations_go_through_the_region_then_to_what_was_touched():
    contacts = []
    region = np.array([[0.0, 0.0, 0.0], [40.0, 40.0, 40.0]])
    ahead = Explorations(BOX, 10.0, None, region=region, contacts=contacts, width=20.0, size=80.0)
    lines = []
    while (scan := ahead.next(10.0)) is not None:
        lines.append(scan)
        ahead.made(missed=True)
    # The middle along three axes, then four places of each: nothing backwards of what was passed.
    assert len(lines) == 3 + 12
    for scan in lines:
        assert sides_of(BOX, scan.start) and sides_of(BOX, scan.end)
        across = np.isclose(scan.start, scan.end)
        assert across.sum() == 2
        assert ((scan.start >= region[0]) & (scan.start <= region[1]))[across].all()
    contacts.append(palpate.Contact((20, 20, 40), (0, 0, 1), position_error=0.5, normal_error=0.07))
    aimed = []
    while (scan := ahead.next(10.0)) is not None:
        aimed.append((scan.end - scan.start) / np.linalg.norm(scan.end - scan.start))
        under = np.array([20.0, 20.0, 38.5])
        is_under = np.linalg.norm(np.cross(under - scan.start, aimed[-1])) < 1e-9
        assert is_under or len(aimed) > 5
        ahead.made(missed=False)
    assert 10 < len(aimed) <= 60 and max(abs(way[2]) for way in aimed[:4]) < 0.2
    assert min(a @ b for a, b in itertools.combinations(aimed[:4], 2)) < -0.7


def test_nothing_goes_aside_of_a_stem_before_it_is_known_where_it_may():
    """Straight down the stem follows the tip; elsewhere it could be the first to touch."""
    stem = np.array([0.2, -0.1, 1.0])
    along = -stem / np.linalg.norm(stem)
    contacts = []
    given = {"region": BOX, "contacts": contacts, "width": 20.0, "size": 80.0}
    ahead = Explorations(BOX, 60.0, DOWN, **given, stem=stem)
    places = []
    while (scan := ahead.next(60.0)) is not None:
        way = (scan.end - scan.start) / np.linalg.norm(scan.end - scan.start)
        assert way == pytest.approx(along) and sides_of(BOX, scan.start) and sides_of(BOX, scan.end)
        places.append(tuple(np.round(scan.start, 6)))
        ahead.made(missed=not contacts)
        if len(places) == 5:
            # At the border: a part of the lines beside it would not be in the workspace.
            contacts.append(
                palpate.Contact((BOX[1, 0], 0, 0), (0, 0, 1), position_error=0.5, normal_error=0.07)
            )
    assert len(places) > 20 and len(set(places)) == len(places)


def test_directions_hold_for_explorations():
    for directions in (DOWN, ((1.0, 1.0, -1.0), 0.05)):
        axis = np.array(directions[0]) / np.linalg.norm(directions[0])
        ahead = Explorations(BOX, 60.0, directions, region=BOX, contacts=[], width=20.0, size=80.0)
        count = 0
        while (scan := ahead.next(60.0)) is not None:
            way = (scan.end - scan.start) / np.linalg.norm(scan.end - scan.start)
            assert math.acos(min(1.0, way @ axis)) <= directions[1] + 1e-9
            ahead.made(missed=True)
            count += 1
        assert count > 10


def test_a_prior_is_where_it_is_looked_for():
    pose = turned(0.3, 0.1, 2.0, (20.0, 30.0, -10.0))
    prior = palpate.Prior(pose, translation=5.0, rotation=0.1)
    region = region_of(SOLIDS[:1], BOX, prior)
    placed = SOLIDS[0].vertices @ pose[:3, :3].T + pose[:3, 3]
    assert (region[0] <= placed.min(axis=0) - 5.0).all() and (region[1] >= placed.max(axis=0) + 5.0).all()
    assert (region[1] - region[0] < BOX[1] - BOX[0]).all()
    far = palpate.Prior(turned(0, 0, 0, (9e3, 0, 0)), translation=1.0, rotation=0.0)
    assert np.array_equal(region_of(SOLIDS, BOX, far), BOX) and np.array_equal(
        region_of(SOLIDS, BOX, None), BOX
    )


def test_three_normals_are_independent():
    def contact(*normal):
        return palpate.Contact((0, 0, 0), normal, position_error=0.5, normal_error=math.radians(4))

    across = [contact(1, 0, 0), contact(0, 1, 0)]
    assert not independent(across) and not independent([*across, contact(1, 1, 0), contact(1, 1, 0.1)])
    assert independent([*across, contact(1, 1, 1)]) and independent([contact(0, 0, 1), *across])
    least = math.radians(15 + 3 * 4)
    for apart in (-0.01, 0.01):
        third = contact(math.cos(least + apart), 0, math.sin(least + apart))
        assert independent([*across, third]) == (apart > 0)
    assert 0 < smallest_width(SOLIDS) <= min(np.ptp(model.vertices, axis=0).min() for model in SOLIDS)


@pytest.mark.parametrize("radius", [0.0, 3.0])
def test_random_contacts_lie_on_the_part(radius):
    sensor = usual_sensor(tip_radius=radius)
    for k, model in enumerate(SOLIDS):
        world_from_model = turned(k, 0.2, 1.0, (3.0, 4.0, 5.0 * k))
        contacts = palpate.random_contacts(model, world_from_model, sensor, count=4, seed=k)
        assert len(contacts) == 4 and independent(contacts)
        assert contacts == palpate.random_contacts(model, world_from_model, sensor, count=4, seed=k)
        found = palpate.recognize(SOLIDS, contacts)
        assert number_of_truth(found.hypotheses, model, world_from_model) is not None


def test_contacts_without_their_ways_are_the_same_places():
    (contact,) = palpate.random_contacts(SOLIDS[0], np.eye(4), usual_sensor(), count=1)
    moved = palpate.Contact.from_tip(
        contact.center, 0.0, position_error=0.5, approach=contact.approach, normal=contact.normal,
        normal_error=contact.normal_error, start=contact.center - 50 * contact.approach,
    )  # fmt: skip
    assert without_way(moved) == contact != moved


def test_undecided_hypotheses_are_judged():
    sensor = usual_sensor(tip_radius=3.0)
    bounds = {"position_error": 0.5, "normal_error": math.radians(4)}
    felt = [
        ((87.74, 87.37, 70.14), (-0.3193, -0.3756, 0.8700)),
        ((64.00, 118.29, 69.68), (-0.3939, 0.8812, 0.2614)),
        ((94.22, 89.12, 69.19), (0.8700, 0.3384, 0.3585)),
    ]
    contacts = [palpate.Contact.from_tip(at, 3.0, normal=normal, **bounds) for at, normal in felt]
    found = palpate.recognize(SOLIDS, contacts, effort=2000)
    undecided = [one for one in found.hypotheses if not one.proved]
    assert not found.complete and undecided
    path = palpate.judge(undecided[:1], sensor, (80, 100, 500), (0, 0, -1))
    assert path.members == [0]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"models": [SOLIDS[0], *palpate.load_models("boot")]},
            r"^models: must be all of the plane or all of",
        ),
        ({"workspace": [[0, 0], [1, 1]]}, r"^workspace: .* a volume, shape \(2, 3\)"),
        ({"workspace": [[0, 0, 0], [1, 1, 0]]}, r"^workspace: .* a volume, shape \(2, 3\)"),
        ({"directions": ((0, -1), 1.0)}, r"^directions: .* \(\(dx, dy, dz\), half_angle\)"),
        ({"features": ["corner"]}, r'^features: unknown kind .*"edge"'),
        ({"planner": "ellis"}, r"^planner: is none of space .*decoupled$"),
        ({"planner": "fastest"}, r"^planner: is none of space"),
        ({"prior": np.eye(4)}, r"^prior: must be a Prior"),
        ({"stop": "foo"}, r"^stop: must say when a path is good enough"),
        ({"stop": ("share", 3)}, r"^stop: must say when a path is good enough"),
        ({"stop": ("unique", True)}, r"^stop: must say when a path is good enough"),
        ({"margin": 5}, r"^margin: must be a share of the part's size"),
        ({"prior": palpate.Prior(np.eye(3), translation=1.0, rotation=1.0)}, r"^prior: "),
        ({"told": 3}, r"^told: must be a function of a Step, or None \(got 3\)"),
    ],
)
def test_bad_input_is_named(changes, said):
    _, _, sensor, probe = hidden(1)
    given = {"models": SOLIDS, "workspace": BOX, **changes}
    with pytest.raises(ValueError, match=said):
        palpate.identify(given.pop("models"), probe.probe, sensor, given.pop("workspace"), **given)


@pytest.mark.parametrize(
    "reply",
    [
        palpate.Hit(palpate.Contact((0, 0), (0, 1), position_error=0.5, normal_error=0.1)),
        palpate.Miss((0, 0), (1, 1)),
        palpate.Skid(palpate.Miss((0, 0), (1, 1))),
        palpate.UnexpectedTouch(np.zeros(2)),
    ],
)
def test_a_reply_of_the_plane_is_refused_in_space(reply):
    class Flat:
        position = None

        def touch(self, start, end):
            return reply

        def move(self, points):
            return None

    with pytest.raises(ValueError, match=r"^probe: answered with a point of shape \(2,\)") as refused:
        palpate.identify(SOLIDS, Flat(), usual_sensor(), BOX)
    assert "\n" not in str(refused.value)


def test_a_tip_inside_of_the_box_is_refused():
    model, world_from_model, sensor, _ = hidden(1)
    probe = palpate.SimulatedProbe(model, world_from_model, sensor, position=(0, 0, 0))
    with pytest.raises(ValueError, match="bring it to the border first"):
        palpate.identify(SOLIDS, probe, sensor, BOX)


def test_a_slice_of_the_campaign(tmp_path, capsys):
    out = tmp_path / "rows.jsonl"
    assert campaign_loop_space.main(["--problems", "6", "--out", str(out)]) == 0
    rows = [json.loads(line) for line in out.read_text("utf-8").splitlines()][1:]
    assert [row["number"] for row in rows] == list(range(6)) and not any(row["lost"] for row in rows)
    assert {row["part"] for row in rows} == {"bundled", "random_solids", "solid_shapes"}
    assert "nominal poses told apart best" in capsys.readouterr().out
    rows[2]["lost"] = rows[3]["contradicted"] = True
    assert len(campaign_loop_space.faults(rows)) == 2
    with pytest.raises(SystemExit):
        campaign_loop_space.main(["--problems", "0"])
