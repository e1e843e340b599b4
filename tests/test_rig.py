"""The rig: its beam, errors of its sensor against the derived bounds, its control, the loop through it."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import palpate
from palpate.experiments import rig_control, rig_drill, rig_sensor
from palpate.experiments.rig_control import MODES, SPEEDS, STEPS, predicted
from palpate.rig import SIZE, RigProbe, RigSpec, bounds_of, without_errors
from palpate.rig import rig_sensor as sensor_of
from palpate.rig.beam import Beam
from palpate.rig.calibration import calibrated
from palpate.rig.film import save_film
from palpate.rig.gauges import Gauges, count_force
from palpate.rig.pieces import planar_pieces, solid_pieces
from palpate.rig.specification import BURSTS

BLOCK = palpate.Model.polygon([[100, 60], [180, 60], [180, 260], [100, 260]], name="block")
AT = np.eye(3)
TOWARD = ([70.0, 160.0], [110.0, 160.0])


def bounds(spec=None, dimension=2):
    return bounds_of(spec or RigSpec(), dimension=dimension, size=SIZE[dimension])


# The sensor (A.1)


def test_the_beam_is_that_of_elementary_mechanics():
    """Against the bending line, integrated twice from the moment."""
    beam = Beam()
    at = np.linspace(0.0, beam.length, 200_001)
    curvature = 9.0 * (beam.length - at) / (beam.modulus * beam.inertia)
    step = at[1] - at[0]
    slope = np.concatenate([[0.0], np.cumsum((curvature[1:] + curvature[:-1]) / 2.0) * step])
    bent = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2.0) * step])
    assert beam.deflection(9.0) == pytest.approx(bent[-1], rel=1e-6)
    assert beam.slope(9.0) == pytest.approx(slope[-1], rel=1e-6)
    assert beam.strain_per_force * 9.0 == pytest.approx(
        float(np.interp(beam.gauge_at, at, curvature)) * beam.side / 2.0, rel=1e-6
    )


def test_the_thesis_s_numbers_come_out_as_math_corrects_them():
    """Row 96: I = 52.08 mm⁴; 106.9 mm for 22 N and .15 %; of 110 mm, 9 N bend it by 1.08 mm."""
    beam = Beam()
    assert beam.inertia == pytest.approx(52.08, abs=0.01)
    assert beam.length_for(22.0, 0.0015) == pytest.approx(106.9, abs=0.1)
    assert replace(beam, length=110.0).deflection(9.0) == pytest.approx(1.08, abs=0.005)
    assert replace(beam, length=110.0).slope(22.0) == pytest.approx(math.radians(2.06), rel=0.01)


def test_drift_and_creep_are_no_faster_than_the_specification_says():
    electronics = RigSpec().electronics
    for seed in range(20):
        gauges = Gauges(Beam(), electronics, dimension=3, random=np.random.default_rng(seed))
        times = np.arange(0.0, 1200.0, 0.5)
        drifted = np.array([gauges.drifted(time) for time in times])
        assert np.abs(np.diff(drifted, axis=0)).max() <= electronics.drift * 0.5 * (1.0 + 1e-9)
        # Of a force that stays what crept in the end is the share that is said.
        still = replace(electronics, noise=0.0, drift=0.0, bits=24)
        gauges = Gauges(Beam(), still, dimension=2, random=np.random.default_rng(seed))
        load = np.repeat([[9.0, 0.0]], BURSTS, axis=0)
        first, *_, last = [gauges.read(load, 0.1) for _ in range(1500)]
        lost = np.linalg.solve(gauges.sensitivity, first - last)
        assert 0.98 * electronics.creep < lost[0] / 9.0 <= electronics.creep


@pytest.mark.parametrize("dimension", [2, 3])
def test_calibrated_gains_are_within_their_bound(dimension):
    spec, most, worst = RigSpec(), bounds(dimension=dimension).gain, 0.0
    for seed in range(150):
        random = [np.random.default_rng([seed, k]) for k in range(2)]
        gauges = Gauges(spec.beam, spec.electronics, dimension=dimension, random=random[0])
        inverse, _ = calibrated(gauges, spec, random=random[1])
        worst = max(worst, float(np.linalg.norm(inverse @ gauges.sensitivity - np.eye(dimension), 2)))
    assert 0.05 * most < worst <= most


def test_averages_of_noise_and_rounding_are_within_their_bound():
    """A reading of a constant force, against the force that its channels feel."""
    spec = without_errors(RigSpec(), "drift", "creep")
    most, ticks = bounds(spec).forces["noise and rounding of the reading"], round(0.25 * 60)
    worst = 0.0
    for seed in range(300):
        random = np.random.default_rng(seed)
        gauges = Gauges(spec.beam, spec.electronics, dimension=2, random=random)
        load = random.uniform(-12.0, 12.0, 2)
        felt = [gauges.read(np.repeat(load[None], BURSTS, axis=0), 1 / 60) for _ in range(ticks)]
        expected = gauges.sensitivity @ load + gauges._offset
        off = np.linalg.solve(gauges.sensitivity, np.mean(felt, axis=0) - expected)
        worst = max(worst, float(np.hypot(*off)))
    assert 0.05 * most < worst <= most


@pytest.mark.parametrize("missing", [(), ("drift",), ("creep",), ("drift", "creep")])
def test_a_better_sensor_has_smaller_bounds(missing):
    every, fewer = bounds(), bounds(without_errors(RigSpec(), *missing))
    assert fewer.normal_error <= every.normal_error and fewer.position_error <= every.position_error
    assert (fewer.normal_error < every.normal_error) == bool(missing)


@pytest.mark.parametrize("number", range(54))
def test_readings_are_within_the_derived_bounds(number):
    """A slice of `rig-sensor`: all kinds of errors, in the plane and in space, against the physics."""
    row = rig_sensor.task(number)
    assert row["reply"] in ("Hit", "Skid") or (row["reply"] == "Fault" and row["reason"])
    if row["reply"] == "Hit":
        assert max(row["rest"], row["first"]) <= row["bounds"]["position"]
        assert row["corner"] or row["normal_deg"] <= row["bounds"]["normal_deg"]


# Control (A.2)


@pytest.mark.parametrize("kind", range(1, len(SPEEDS)))
def test_a_guarded_move_presses_on_no_farther_than_is_said(kind):
    row = rig_control.task(kind)
    assert row["pressed"] <= predicted(row["speed"])
    assert row["reply"] == "Hit" or row["reason"]


def test_every_mode_of_control_settles_at_the_rig_s_gains():
    for mode in MODES:
        row = rig_control.task(len(SPEEDS) + STEPS.index((mode, 1.0)))
        shares = np.array(row["shares"])
        assert np.abs(shares[-20:] - 1.0).max() <= rig_control.SETTLED, mode
        assert shares.max() <= 1.3, mode


# The probe


def test_the_same_moves_with_the_same_seed_have_the_same_replies():
    one, again, other = (RigProbe(BLOCK, AT, seed=seed) for seed in (3, 3, 4))
    replies = [probe.touch(*TOWARD) for probe in (one, again, other)]
    centers = [reply.contact.center for reply in replies]
    assert np.array_equal(centers[0], centers[1]) and not np.array_equal(centers[0], centers[2])
    assert np.array_equal(one.recording.column("force"), again.recording.column("force"))


def test_replies_are_those_of_a_probe():
    probe = RigProbe(BLOCK, AT, seed=1)
    hit = probe.touch(*TOWARD)
    assert isinstance(hit, palpate.Hit)
    assert abs(hit.contact.center[0] - (100 - 5)) <= probe.bounds.position_error
    assert probe.move([[60.0, 160.0], [60.0, 30.0]]) is None
    miss = probe.touch([60.0, 30.0], [200.0, 30.0])
    assert isinstance(miss, palpate.Miss)
    through = probe.move([[140.0, 200.0]])
    assert isinstance(through, palpate.UnexpectedTouch)
    inside = RigProbe(BLOCK, AT, seed=1).touch([140.0, 160.0], [200.0, 160.0])
    assert isinstance(inside, palpate.AlreadyTouching)


def test_a_flat_touch_is_a_skid():
    probe = RigProbe(BLOCK, AT, seed=1)
    along = math.radians(80)
    way = np.array([math.cos(along), math.sin(along)])
    start = np.array([95.0, 200.0]) - 60.0 * way
    reply = probe.touch(start, start + 70.0 * way)
    assert isinstance(reply, palpate.Skid)


def test_the_stem_that_touches_first_is_a_fault():
    """Under a roof the beam, which stands up from the tip, meets its edge."""
    at = np.eye(4)
    outline = np.array([[140, 60], [200, 60], [200, 0], [240, 0], [240, 90], [140, 90]], dtype=float)
    corners = [[x, y, z] for y in (60.0, 260.0) for x, z in outline]
    model = palpate.Model.mesh(*prism(np.array(corners), len(outline)), name="roof")
    probe = RigProbe(model, at, seed=1)
    reply = probe.touch([100.0, 160.0, 30.0], [199.0, 160.0, 30.0])
    assert isinstance(reply, palpate.Fault) and "stem" in reply.reason
    assert isinstance(probe.touch([100.0, 160.0, 30.0], [120.0, 160.0, 30.0]), palpate.Fault)


def prism(corners, count):
    """Corners `(2·count, 3)` and triangles of a prism over a polygon that is not convex."""
    import manifold3d

    section = manifold3d.triangulate([corners[:count][:, [0, 2]]])
    sides = [[k, (k + 1) % count, count + k] for k in range(count)]
    sides += [[(k + 1) % count, count + (k + 1) % count, count + k] for k in range(count)]
    ends = [[a, b, c] for a, b, c in section] + [[c + count, b + count, a + count] for a, b, c in section]
    triangles = np.array(ends + [side[::-1] for side in sides])
    return corners, triangles


def test_a_contact_that_never_settles_is_a_fault():
    spec = RigSpec()
    spec = replace(spec, control=replace(spec.control, settle=0.2))
    reply = RigProbe(BLOCK, AT, spec=spec, seed=1).touch(*TOWARD)
    assert isinstance(reply, palpate.Fault) and "settle" in reply.reason


def test_no_move_is_unbounded():
    """Every guarded move ends in the time that its length, its speed and a contact may take."""
    probe = RigProbe(BLOCK, AT, seed=5)
    probe.touch(*TOWARD)
    control = probe.spec.control
    length = math.dist(*TOWARD)
    assert probe.clock <= 2.0 * length / control.guard_speed + 2.0 * control.settle + 10.0
    reached = probe.recording.column("tip")
    assert (reached[:, 0] <= 100.0).all()


@pytest.mark.parametrize("number", range(6))
def test_the_loop_through_the_rig_loses_nothing(number):
    """A slice of `rig-drill`: each set of parts, at both bounds."""
    row = rig_drill.task(number)
    assert not row["lost"]
    assert row["status"] in ("solved", "inseparable", "no_usable_path") or row["reason"]
    assert row["initial_data"] > 0.0


@pytest.mark.parametrize("number", range(len(palpate.solid_part_names())))
def test_solids_are_touched_through_three_axes(number):
    """From above, in the middle of the highest triangle that looks up."""
    model = palpate.bundled_solids()[number]
    pose = np.eye(4)
    pose[:3, 3] = [145.0, 160.0, 40.0] - (model.vertices.min(axis=0) + model.vertices.max(axis=0)) / 2.0
    middles = model.vertices[model.triangles].mean(axis=1) + pose[:3, 3]
    level = np.asarray(model.face_normals)[model.triangle_faces][:, 2] > 0.999
    x, y, z = max(middles[level], key=lambda middle: middle[2])
    probe = RigProbe(model, pose, seed=2)
    reply = probe.touch([x, y, z + 40.0], [x, y, z - 10.0])
    assert isinstance(reply, palpate.Hit)
    met = model.first_contact(pose, [x, y, z + 40.0], [0.0, 0.0, -1.0], 5.0)
    assert math.dist(reply.contact.center, met.center) <= probe.bounds.position_error
    assert math.acos(min(1.0, float(reply.contact.normal @ met.normal))) <= probe.bounds.normal_error


def test_pieces_are_convex_and_fill_the_part():
    for model in palpate.bundled_solids():
        pieces = solid_pieces(model)
        volume = sum(hull_volume(piece) for piece in pieces)
        a, b, c = (model.vertices[model.triangles[:, k]] for k in range(3))
        assert volume == pytest.approx(float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0, rel=1e-5)
    camera = next(model for model in palpate.bundled_parts() if model.name == "camera")
    area = sum(hull_volume(piece) for piece in planar_pieces(camera, low=-0.5, high=0.5))
    x, y = camera.vertices.T
    assert area == pytest.approx(0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))), rel=1e-9)


def hull_volume(points):
    from scipy.spatial import ConvexHull

    return float(ConvexHull(points).volume)


def test_a_film_is_one_page_that_asks_no_host_for_anything(tmp_path):
    probe = RigProbe(BLOCK, AT, seed=1)
    result = palpate.identify([BLOCK], probe, probe.sensor, [[0, 0], SIZE[2]])
    assert result.status == "solved" and result.hypotheses[0].poses.contains(AT)
    page = tmp_path / "run.html"
    save_film(page, probe.recording, result, model=BLOCK, world_from_model=AT, tip_radius=5.0)
    text = page.read_text(encoding="utf-8")
    assert "<html" in text and not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", text)
    assert [one.name for one in tmp_path.iterdir()] == ["run.html"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"model": 3}, "model: must be a Model"),
        ({"seed": -1}, "seed: must be a whole number"),
        ({"unit": "ell"}, "unit: "),
        ({"spec": 5}, "spec: must be a RigSpec"),
        ({"sensor": palpate.Sensor(0.01, 0.05, 1.0, 5.0, 0.5)}, "sensor: its position_error must hold"),
        ({"sensor": palpate.Sensor(0.9, 0.001, 1.0, 5.0, 0.9)}, "sensor: its normal_error must hold"),
        ({"sensor": palpate.Sensor(0.9, 0.05, 1.0, 1.0, 0.9)}, "sensor: its tip_radius must be that"),
        ({"spec": replace(RigSpec(), stem_radius=-1.0)}, "spec.stem_radius: must be a number, above zero"),
        ({"model": palpate.Model.segments([[[0, 0], [10, 0]]], name="loose")}, "model: "),
    ],
)
def test_bad_input_is_named(given, said):
    given = {"model": BLOCK, "world_from_model": AT, **given}
    with pytest.raises(ValueError, match="^" + re.escape(said)) as refused:
        RigProbe(given.pop("model"), given.pop("world_from_model"), **given)
    assert "\n" not in str(refused.value)


def test_places_out_of_reach_are_refused():
    probe = RigProbe(BLOCK, AT)
    with pytest.raises(ValueError, match=r"^end: is out of reach"):
        probe.touch([10, 10], [1000, 10])
    with pytest.raises(ValueError, match=r"^end: must differ from start"):
        probe.touch([10, 10], [10, 10])


def test_the_derived_sensor_is_in_the_unit_that_is_asked_for():
    mm, inch = sensor_of(), sensor_of(unit="in")
    assert mm.position_error == pytest.approx(25.4 * inch.position_error)
    assert mm.tip_radius == pytest.approx(25.4 * inch.tip_radius) and mm.normal_error == inch.normal_error
    assert count_force(RigSpec().electronics) == pytest.approx(32.0 / 2048)
